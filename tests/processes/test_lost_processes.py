# SPDX-License-Identifier: Apache-2.0
"""Lost stations and worlds, strangers, keys, clocks and disks: faults of real processes that a
carry does not survive, at given instants of a time that the test grants.

Required each time: no drop; ten seconds later every process is ready again or has ended with a
reason; and a line at the station says what has happened.
"""

import os
import re
import resource
import shutil
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from palmbots.links.local_connection import connect
from palmbots.pair.launcher import free_addresses
from palmbots.pair.stored_state import StoredState, read_state, write_state
from set_wall_clock import WallClock
from stepped_processes import ORDER, SteppedProcesses

WITHIN_S = 10.0
SIDES: tuple[Any, ...] = ("left", "right")


@pytest.fixture
def pair(tmp_path: Path) -> Iterator[SteppedProcesses]:
    with SteppedProcesses(tmp_path) as made:
        yield made


def ends_with(pair: SteppedProcesses, fault: str) -> None:
    """Both robots end the carry, at least one with this fault, and so does the station."""
    pair.run_until(
        lambda: all(mode in ("fault", "stopped") for mode in pair.modes().values()), WITHIN_S
    )
    assert fault in pair.faults().values(), pair.report()
    world = pair.finish()
    assert world["outcome"] == "stopped", pair.report()
    assert "Traceback" not in pair.report()


def test_a_killed_station_starts_again_and_sees_the_end(pair: SteppedProcesses) -> None:
    pair.carry()
    pair.kill("station")
    pair.run(0.5)
    pair.restart("station")
    assert pair.finish()["outcome"] == "delivered", pair.report()
    assert pair.says("left: done")
    assert pair.lines().count("script: start") == 1, pair.lines()  # it is not carried again


def test_a_killed_world_voids_the_carry_and_another_one_can_begin(pair: SteppedProcesses) -> None:
    pair.carry()
    pair.kill("world")
    pair.run_until(lambda: pair.has_ended("left", "right"), WITHIN_S)
    pair.run(0.2)
    for side in SIDES:
        program = pair.programs[side]
        assert program.process.returncode == 2
        line = r"palmbots: world: (has closed the connection|Connection reset by peer)\n"
        assert re.fullmatch(line, program.said())
        assert pair.says(rf"{side}: fault \(driver\)"), pair.report()
    pair.run_until(lambda: pair.has_ended("station"), WITHIN_S)
    for name in ORDER:
        pair.spawn(name)
    pair.let_in(*ORDER)
    assert pair.finish()["outcome"] == "delivered", pair.report()


def test_after_a_reboot_of_both_robots_the_carry_is_no_longer(pair: SteppedProcesses) -> None:
    pair.carry()
    pair.run(2.0)
    for side in SIDES:
        pair.kill(side)
    pair.run(0.3)
    for side in SIDES:
        pair.restart(side)
    world = pair.finish()
    assert world["outcome"] == "delivered", pair.report()
    # What was covered before is stored in steps of 2 cm, and the wheels run on for the watchdog.
    assert 0.39 < world["distance_m"] < 0.4 + 0.02 + 0.02 + 0.02


@pytest.mark.parametrize("boots", [0, 5])
def test_two_programs_of_one_side_are_named_and_not_armed(
    boots: int, pair: SteppedProcesses
) -> None:
    """The second one runs on another computer with a copy of everything. It has booted as often as
    the first one, or more often."""
    folder, world = pair.folder, f"unix:{pair.folder / 'world2'}"
    shutil.copytree(folder / "pair-state", folder / "copied-state")
    file = replace(pair.pair.state_file("left"), path=folder / "copied-state" / "left.json")
    write_state(file, StoredState(boots))
    with free_addresses(1) as (address,):
        text = pair.files["left"].read_text().replace(pair.own["left"], address)
    copy = folder / "copy.toml"
    copy.write_text(text.replace('"pair-state"', '"copied-state"').replace(pair.address, world))
    scene = str(folder / "scene.toml")
    pair.spawn("world2", ["world", scene, "--serve", world], "world", "world2")
    with connect(world, "world", 60) as right:
        right.send(["right", 1, 0])
        pair.spawn("intruder", ["robot", str(copy), "--side", "left"], "left", "world2")
        pair.let_in("world2", "intruder")
        pair.start()
        pair.run_until(lambda: pair.has_ended("station"), WITHIN_S)
        assert pair.says("left: two programs claim to be this robot: boot "), pair.report()
        assert not pair.says("(left|right): armed"), pair.lines()
        assert not pair.has_ended("left") and not pair.has_ended("intruder")


def test_an_old_key_is_named(pair: SteppedProcesses) -> None:
    (pair.folder / "old.key").write_text("00" * 16 + "\n")
    (pair.folder / "old.key").chmod(0o600)
    file = pair.files["left"]
    file.write_text(file.read_text().replace('"pair.key"', '"old.key"'))
    pair.start()
    line = "packets arrive that are signed with another key; not heard: left, which may have an old"
    pair.run_until(lambda: pair.says(line), WITHIN_S)
    assert pair.modes() == {"right": "disarmed"}
    assert not pair.has_ended("left") and not pair.has_ended("right")


def test_the_wall_clock_may_be_set_back(tmp_path: Path) -> None:
    clock = WallClock(tmp_path / "clock")
    with SteppedProcesses(tmp_path, environment=clock.environment) as pair:
        pair.carry()
        clock.set("-1h")
        assert pair.finish()["outcome"] == "delivered", pair.report()
        assert pair.says(r"station: the clock of this computer was set back by 3600 s; "), (
            pair.report()
        )


@pytest.fixture(params=["pair-state"])
def full_disk(
    tmp_path: Path, request: pytest.FixtureRequest
) -> Iterator[Callable[[SteppedProcesses], None]]:
    """Fills the disk under a folder; without root the left robot may write no more bytes."""
    folder = tmp_path / request.param
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(folder)]
    is_mounted = os.geteuid() == 0 and subprocess.run(mount, capture_output=True).returncode == 0

    def fill(pair: SteppedProcesses) -> None:
        if not is_mounted:
            number = pair.programs["left"].process.pid
            resource.prlimit(number, resource.RLIMIT_FSIZE, (0, resource.RLIM_INFINITY))
            return
        with pytest.raises(OSError), (folder / "filler").open("wb", buffering=0) as file:
            while True:
                file.write(bytes(1024))

    yield fill
    if is_mounted:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_full_disk_ends_the_carry_with_a_reason(
    tmp_path: Path, full_disk: Callable[[SteppedProcesses], None]
) -> None:
    with SteppedProcesses(tmp_path) as pair:
        pair.carry()
        before = read_state(pair.pair.state_file("left"))
        full_disk(pair)
        ends_with(pair, "storage")
        assert pair.says(r"(left|right): fault \(storage\)"), pair.report()
        after = read_state(pair.pair.state_file("left"))  # it is whole
        assert after.epoch == before.epoch


@pytest.mark.parametrize("full_disk", ["pair-logs"], indirect=True)
def test_a_full_disk_under_the_logs_costs_only_the_rest_of_the_logs(
    tmp_path: Path, full_disk: Callable[[SteppedProcesses], None]
) -> None:
    with SteppedProcesses(tmp_path) as pair:
        pair.carry()
        full_disk(pair)
        assert pair.finish()["outcome"] == "delivered", pair.report()
        warnings = [line for line in pair.report().splitlines() if "No space left" in line]
        warnings += [line for line in pair.report().splitlines() if "File too large" in line]
        assert warnings, pair.report()
        assert len(warnings) <= 3, warnings  # one of each program
        assert "Traceback" not in pair.report()

# SPDX-License-Identifier: Apache-2.0
"""Faults of real processes and sockets, each at a given instant of a time that the test grants.

Required each time: no avoidable drop; ten seconds after the fault every process is ready again, or
has ended with a reason; and a line at the station says what has happened.
"""

from pathlib import Path
from typing import Any

import pytest

from json_output import read_json
from live_faults import FAULTS, JOB, SHORT_WAY, Fault
from palmbots._types import SIDES
from palmbots.links.impairment import Impairment
from stepped_processes import UNDER_WAY, SteppedProcesses

GOOD = Impairment(delay_ms=2.0)
READY = (*UNDER_WAY, "done", "disarmed", "armed")
ENDED = ("fault", "stopped")
AFTER_S = 10.0


NAMES = [name for name, fault in FAULTS.items() if "void" not in fault.ends]
"""Without a world the test has no result: test_lost_processes.py has a fault of it."""


@pytest.mark.parametrize("name", NAMES)
def test_a_fault_in_a_carry(name: str, tmp_path: Path) -> None:
    fault = FAULTS[name]
    with SteppedProcesses(
        tmp_path, "resilient", fault.impairment,
        clock_rate=fault.clock_rate,
        # The error of a clock shows after a while.
        overrides={"task.distance_m": 0.8 if fault.clock_rate else 0.3},
    ) as pair:  # fmt: skip
        pair.carry()
        suffer(fault, pair)


PHASES = ("dock", "under", "raise", "carry", "lower", "leave", "retreat")
"""Those that last so long that the station hears of them, by the beginnings of their names."""
QUICK = {
    ("left robot off for 0.5 s", "under"), ("right robot off for 0.5 s", "carry"),
    ("left program held up for 5 s", "lower"), ("station off for 3 s", "raise"),
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "phase"),
    [
        pytest.param(name, phase, marks=[] if (name, phase) in QUICK else pytest.mark.soak)
        for name in NAMES
        if FAULTS[name].lasts_s > 0
        for phase in PHASES
        # After the object has been put down, a lost station or world changes nothing.
        if phase != "retreat" or FAULTS[name].whom in SIDES
    ],
)
def test_a_fault_in_a_phase_of_a_job(name: str, phase: str, tmp_path: Path) -> None:
    """It begins when a robot reports the phase; both robots end with a reason, or go on."""
    fault = FAULTS[name]
    with SteppedProcesses(tmp_path, "resilient", fault.impairment, overrides=JOB) as pair:
        pair.carry()
        pair.run_until(lambda: any(one.startswith(phase) for one in pair.phases.values()), 60.0)
        suffer(fault, pair)


@pytest.mark.parametrize(
    ("scene", "phase", "ends"),
    [
        ("stand", "raise", "delivered"),
        ("stand", "lower", "delivered"),
        ("lone", "seat", "delivered"),
        # It does not know how far it has carried the object.
        ("lone", "haul", "stopped"),
        ("handover", "seat", "delivered"),
        ("handover", "ahead", "stopped"),
    ],
)
def test_a_robot_is_killed_in_another_job(
    scene: str, phase: str, ends: str, tmp_path: Path
) -> None:
    fault = FAULTS["right robot off for 0.5 s"]
    with SteppedProcesses(
        tmp_path, "shared-sign", fault.impairment, scene=scene, overrides=SHORT_WAY[scene]
    ) as pair:
        pair.start()
        pair.run_until(lambda: pair.phases.get("right", "").startswith(phase), 60.0)
        fault.begin(pair)
        pair.run(fault.lasts_s)
        fault.end(pair)
        world = pair.finish()
        assert pair.says(fault.line), pair.report()
        assert world["outcome"] == ends, pair.report()
        assert world["reason"] is None
        assert "Traceback" not in pair.report()


@pytest.mark.parametrize(("held_up_s", "boots"), [(0.08, 1), (0.15, 2)])
def test_robots_that_were_held_up_longer_than_the_watchdog_start_again_and_go_on(
    held_up_s: float, boots: int, tmp_path: Path
) -> None:
    with SteppedProcesses(tmp_path) as pair:
        pair.carry()
        for side in ("left", "right"):
            pair.suspend(side)
        pair.run(held_up_s)
        for side in ("left", "right"):
            pair.resume(side)
        world = pair.finish()
        assert world["outcome"] == "delivered", pair.report()
        # What was covered before is stored in steps of 2 cm, and the wheels run on meanwhile.
        assert 0.39 < world["distance_m"] < 0.4 + 0.02 + 0.02 + 0.02
        for side in ("left", "right"):
            assert read_json("robot", pair.programs[side].printed())["boots"] == boots


def suffer(fault: Fault, pair: SteppedProcesses) -> None:
    """The fault comes and goes, and the carry ends as it has to."""
    fault.begin(pair)
    pair.run(fault.lasts_s)
    fault.end(pair)
    pair.run_until(lambda: is_well(pair), AFTER_S)
    world = pair.finish()
    assert pair.says(fault.line), pair.report()
    assert world["outcome"] in fault.ends, pair.report()
    assert "Traceback" not in pair.report()


def is_well(pair: SteppedProcesses) -> bool:
    """Both robots are ready again, or have ended with a reason."""
    faults = pair.faults()
    return all(
        (mode in READY and faults[side] == "none") or (mode in ENDED and faults[side] != "none")
        for side, mode in pair.modes().items()
    )


def run_once(folder: Path, **options: Any) -> tuple[str, str]:
    """A carry over a bad radio with a reboot; returns the trace and what the station printed."""
    folder.mkdir()
    with SteppedProcesses(folder, radio=Impairment(0.2, 50.0, 30.0, 0.1), **options) as pair:
        pair.start()
        pair.run_until(pair.carries, 20)
        pair.run(1.0)
        pair.kill("left")
        pair.run(0.5)
        pair.restart("left")
        pair.run(1.0)
        return pair.trace.hexdigest(), pair.lines()


def test_every_run_is_the_same_to_the_last_packet(tmp_path: Path) -> None:
    first, second = (run_once(tmp_path / name, seed=3) for name in ("a", "b"))
    assert first == second
    assert "left: has started again (boot 2)" in first[1]


def test_the_algorithm_of_the_paper_hangs_and_the_station_says_so(tmp_path: Path) -> None:
    """A robot that waits for a message which was lost waits until the carry ends."""
    overrides = {
        "robot.left.bias_m_s": 0.004, "robot.noise_m_s": 0.012, "task.distance_m": 1.2,
    }  # fmt: skip
    radio = Impairment(0.3, 2.0)
    with SteppedProcesses(tmp_path, "distributed", radio, seed=2, overrides=overrides) as pair:
        pair.start()
        pair.run_until(lambda: "it hangs" in pair.lines(), 20)
        assert pair.says(r"(left|right) assists for more than 5\.4 s: it hangs"), pair.report()


def test_an_avoidable_drop_is_named(tmp_path: Path) -> None:
    """Both robots keep still under a drift that any controller corrects: the wheels of the left one
    run too fast, and `distributed` waits for an answer that never comes."""
    overrides = {"robot.left.bias_m_s": 0.02, "robot.noise_m_s": 0.0, "task.distance_m": 1.5}
    with SteppedProcesses(tmp_path, "distributed", GOOD, overrides=overrides) as pair:
        pair.start()
        pair.run_until(pair.carries, 20)
        pair.packets.cut(("left", "right"), ("right", "left"))
        pair.run_until(lambda: pair.has_ended("world"), 60)
        world = read_json("world", pair.programs["world"].printed())
        assert (world["outcome"], world["avoidable"]) == ("dropped", True), pair.report()
        assert world["reason"].startswith("off-palm: a contact left"), world

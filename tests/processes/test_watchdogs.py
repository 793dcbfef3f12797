# SPDX-License-Identifier: Apache-2.0
"""The wheels stop soon after the program of a robot is stopped or killed, before it goes on.

One robot with the controller `silent`, whose operator alone starts it, with each kind of driver.
The exact time within which they stop is tested on the clocks of the boards (tests/drivers,
tests/simulation).
"""

import signal
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from distributions import installed
from json_output import read_json
from motor_board import board
from pair_programs import ended, new_pair, operator, running, started
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.links.local_connection import listen
from palmbots.simulation import live_world
from waiting import wait_until

ROBOT = ["robot", "pair.toml", "--side", "left", "--json"]
W_S = 0.4
# A slow control loop, so that a busy machine seldom ends a carry by the fault `overrun`.
SCENE = f"[task]\ndistance_m = {{}}\n[control]\nperiod_s = 0.04\nwatchdog_s = {W_S}\n"
SLACK_S = 3.0  # a busy machine wakes the board late
BOTH = pytest.mark.parametrize("by", [signal.SIGSTOP, signal.SIGKILL])


def silent_pair(folder: Path, distance_m: float = 1.5, **values: object) -> Path:
    (folder / "scene.toml").write_text(SCENE.format(distance_m))
    chosen: dict[str, object] = {
        "pair__controller": "silent",
        "pair__scene": "scene.toml",
        "limits__station_lost": "carry-on",
    }
    named = {name.replace("__", "."): value for name, value in (chosen | values).items()}
    return new_pair(folder, named)


def go_on(process: "subprocess.Popen[str]", by: signal.Signals) -> None:
    if by == signal.SIGSTOP:
        process.send_signal(signal.SIGCONT)


@BOTH
def test_serial_board(by: signal.Signals, tmp_path: Path) -> None:
    device = tmp_path / "tty"
    file = silent_pair(tmp_path, driver__kind="serial", driver__address=str(device))
    with board(device) as made, running(ROBOT, folder=tmp_path) as (robot,), operator(file) as user:
        made.order("press 1")  # the middle of the palm
        user.start("left", made.turns)
        held_s = time.monotonic()
        robot.send_signal(by)
        rest = made.wait_resting()
        assert rest.by_watchdog
        assert rest.time_s - held_s < W_S + SLACK_S
        go_on(robot, by)


@BOTH
def test_guard(by: signal.Signals, tmp_path: Path) -> None:
    note = tmp_path / "note"
    file = silent_pair(tmp_path, driver__kind="noted", driver__address=str(note))
    found = installed(tmp_path / "site", "palmbots.drivers", noted="scripted_drivers:Noted")
    environment = {"folder": tmp_path, "environment": found}

    def newest() -> list[str]:
        return note.read_text().splitlines()[-1].split() if note.exists() else [""] * 3

    with running(ROBOT, **environment) as (robot,), operator(file) as user:
        user.start("left", lambda: newest()[1] == "write" and float(newest()[2]) > 0)
        held_s = time.monotonic()
        robot.send_signal(by)
        wait_until(lambda: newest()[1] in ("stop", "close"))
        stops = [line.split() for line in note.read_text().splitlines() if " stop" in line]
        assert float(stops[-1][0]) - held_s < W_S + SLACK_S
        go_on(robot, by)


@pytest.fixture
def boards(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[live_world.Board]]:
    """The motor boards of a world in a thread."""
    made: list[live_world.Board] = []

    class Kept(live_world.Board):
        def __init__(self, *arguments: Any, **others: Any) -> None:
            super().__init__(*arguments, **others)
            made.append(self)

    monkeypatch.setattr(live_world, "Board", Kept)
    door = listen(f"unix:{tmp_path / 'world'}")
    (tmp_path / "scene.toml").write_text(SCENE.format(1.5))
    scene = pb.load_scene(tmp_path / "scene.toml")
    thread = threading.Thread(target=live_world.run_live_world, args=(scene, door))
    thread.start()
    yield made
    thread.join(60)
    door.close()


@BOTH
def test_simulated(by: signal.Signals, tmp_path: Path, boards: list[live_world.Board]) -> None:
    file = silent_pair(tmp_path)
    right = SimulatedDriver(f"unix:{tmp_path / 'world'}", "right", 1)

    def left_turns() -> bool:
        right.stop()
        return len(boards) == 2 and not boards[0].command[2]

    with running(ROBOT, folder=tmp_path) as (robot,), operator(file) as user:
        user.start("left", left_turns)
        held_s = time.monotonic()
        robot.send_signal(by)
        wait_until(lambda: not left_turns())
        assert time.monotonic() - held_s < W_S + SLACK_S
        go_on(robot, by)
        right.close()


def test_an_unplugged_board_is_a_fault_and_comes_back(tmp_path: Path) -> None:
    device = tmp_path / "tty"
    file = silent_pair(tmp_path, driver__kind="serial", driver__address=str(device))
    with board(device) as made, running(ROBOT, folder=tmp_path) as (robot,), operator(file) as user:
        made.order("press 1")
        user.start("left", made.turns)
        made.end()
        user.until(lambda: user.mode("left") == "fault")
        assert user.station.status["left"].fault == "driver"
        user.station.wish("disarm")
        made.start()
        made.order("press 1")
        user.wish("disarm", "left", "disarmed")
        user.start("left", made.turns)
        found, errors = ended(robot)
        rest = made.wait_resting()
        assert not rest.by_watchdog  # an orderly end stops the wheels itself
    modes = [line for line in errors.splitlines() if line.startswith("palmbots: left: ")]
    assert modes[0] == "palmbots: left: disarmed"
    assert any(line.startswith("palmbots: left: fault: its motor board") for line in modes)
    lost, back = (line for line in errors.splitlines() if line not in modes)
    assert lost.startswith(f"palmbots: driver.address: {device} is lost: ")
    assert back == f"palmbots: driver.address: {device} is back"
    link = found["link"]["station"]
    assert link["sent"] > 5 and link["received"] > 5
    assert link["lost"] == 0
    assert 0 < link["round_trip_median_s"] < 1
    assert found["verdicts"]["accepted"] > 5
    assert found["verdicts"]["bad_tag"] == 0


def test_arming_needs_a_contact_and_a_battery(tmp_path: Path) -> None:
    device = tmp_path / "tty"
    file = silent_pair(
        tmp_path, driver__kind="serial", driver__left_address=str(device),
        hardware__battery_low_v=6.5,
    )  # fmt: skip
    with board(device) as made, running(ROBOT, folder=tmp_path), operator(file) as user:
        user.until(lambda: user.mode("left") == "disarmed")
        user.station.wish("arm")
        user.until(lambda: user.station.status["left"].fault == "contact")
        made.order("battery 6.4")
        made.order("press 1")
        user.until(lambda: user.station.status["left"].fault == "battery")
        made.order("battery 6.6")
        user.until(lambda: user.mode("left") == "armed")


def test_ctrl_c_is_an_orderly_end(tmp_path: Path) -> None:
    file = silent_pair(tmp_path, driver__kind="dry-run")
    with operator(file) as user:
        robot = started(ROBOT, tmp_path)
        user.start("left")
        robot.send_signal(signal.SIGINT)
        printed, errors = robot.communicate(timeout=60)
    assert robot.returncode == 0
    assert read_json("robot", printed)["boots"] == 1
    assert errors.splitlines()[-1] == "palmbots: left robot, dry run: wheels at rest"


def test_dry_run_carries_for_the_time_of_the_distance(tmp_path: Path) -> None:
    file = silent_pair(tmp_path, 0.12, driver__kind="dry-run")
    with running(ROBOT, folder=tmp_path) as (robot,), operator(file) as user:
        begin_s = time.monotonic()
        user.start("left")
        progress: list[int] = []

        def is_done() -> bool:
            status = user.station.status["left"]
            progress.extend([status.value] if status.item == "progress" else [])
            return status.mode == "done" and len(progress) > 0 and progress[-1] > 60_000

        user.until(is_done)
        assert progress == sorted(progress)
        assert any(2000 < value < 65535 for value in progress)
        assert time.monotonic() - begin_s > 2.0  # 0.12 m at 0.06 m/s
        _, errors = ended(robot)
    modes = [line for line in errors.splitlines() if line.startswith("palmbots: left: ")]
    assert modes[-2:] == ["palmbots: left: carrying", "palmbots: left: done"]
    lines = [line for line in errors.splitlines() if line not in modes]
    assert all(line.startswith("palmbots: left robot, dry run: palm at ") for line in lines[:-1])
    assert any(line.endswith(" 0.060 m/s") for line in lines)
    assert lines[-1].endswith("wheels at rest")


def test_bad_input_is_one_line(tmp_path: Path) -> None:
    new_pair(tmp_path, driver__kind="nosuch")
    robot = started(ROBOT, tmp_path)
    printed, errors = robot.communicate(timeout=60)
    assert (robot.returncode, printed) == (2, "")
    assert errors.startswith(
        'palmbots: pair.toml: driver.kind: value is "nosuch"; allowed: simulated, '
    )
    assert errors.count("\n") == 1

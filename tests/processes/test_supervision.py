# SPDX-License-Identifier: Apache-2.0
"""What becomes of the processes of `palmbots up` when one of them, or `up` itself, is lost."""

import os
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from pair_programs import NAMES, programs_of, started
from waiting import wait_until

Up = subprocess.Popen[str]


@pytest.fixture
def up(tmp_path: Path) -> Iterator[Up]:
    command = ["up", "--set", "task.distance_m=20", "--json"]
    with started(command, environment={"TMPDIR": str(tmp_path)}) as process:
        yield process
        if process.poll() is None:
            process.kill()


def all_of(up: Up) -> dict[str, int]:
    wait_until(lambda: len(programs_of(up)) == len(NAMES))
    return programs_of(up)


def is_there(number: int) -> bool:
    try:
        return "State:\tZ" not in Path(f"/proc/{number}/status").read_text()
    except OSError:
        return False


def test_everything_ends_when_up_is_killed_and_no_key_is_left(up: Up, tmp_path: Path) -> None:
    started = all_of(up)
    up.kill()
    wait_until(lambda: not any(map(is_there, started.values())))
    left = [file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()]
    assert left  # the folder of the pair
    assert not any(re.search(rb"\b[0-9a-f]{32}\b", content) for content in left)


def test_a_killed_robot_starts_again_and_a_killed_world_ends_everything(up: Up) -> None:
    started = all_of(up)
    os.kill(started["left"], signal.SIGKILL)
    wait_until(lambda: programs_of(up).get("left") not in (None, started["left"]))
    os.kill(programs_of(up)["world"], signal.SIGKILL)
    printed, errors = up.communicate(timeout=60)
    assert up.returncode == 2 and printed == ""
    assert "palmbots: left: was killed (signal 9), and starts again\n" in errors
    assert "palmbots: world: was killed; the carry is void\n" in errors
    assert "Traceback" not in errors
    assert not any(map(is_there, started.values()))


def test_ctrl_c_in_a_terminal_prints_one_line(tmp_path: Path) -> None:
    """It reaches all processes of the terminal, and only `up` speaks."""
    command = ["up", "--set", "task.distance_m=20", "--log", str(tmp_path / "logs")]
    with started(command, start_new_session=True) as process:
        all_of(process)
        time.sleep(1.0)  # so that they hear it, and no import does
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    logs = tmp_path / "logs"
    line = f"palmbots: interrupted; world, robots and station have ended, their logs are in {logs}"
    assert errors.splitlines() == [line]


def test_a_killed_world_ends_a_carry_in_lockstep() -> None:
    command = ["up", "--lockstep", "--set", "task.distance_m=500", "--set", "task.timeout_s=9999"]
    with started(command) as up:
        names = {"world", "left", "right"}
        wait_until(lambda: programs_of(up).keys() >= names)
        os.kill(programs_of(up)["world"], signal.SIGKILL)
        _, errors = up.communicate(timeout=60)
    assert up.returncode == 2
    assert "palmbots: world: was killed; the carry is void\n" in errors
    assert "Traceback" not in errors


def test_a_robot_that_stays_suspended_does_not_hold_up_the_end(up: Up) -> None:
    started = all_of(up)
    os.kill(started["right"], signal.SIGSTOP)
    os.kill(up.pid, signal.SIGTERM)
    up.communicate(timeout=60)
    assert not any(map(is_there, started.values()))


def test_an_unknown_host_of_the_world_is_refused_at_once(tmp_path: Path) -> None:
    from palmbots.pair.pair_file import init_pair

    file = init_pair(tmp_path / "pair.toml", address="no-such-host.invalid:7400")[0]
    begin_s = time.monotonic()
    robot = started(["robot", str(file), "--side", "left"])
    _, errors = robot.communicate(timeout=60)
    assert robot.returncode == 2
    assert re.fullmatch(r"palmbots: world: cannot find no-such-host\.invalid:7400: .*\n", errors)
    assert time.monotonic() - begin_s < 15

# SPDX-License-Identifier: Apache-2.0
"""Two robots whose bases and palms are ROS 2 nodes: a carry, and the timeout of the bases."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from dds_loopback import dds_environment
from pair_programs import new_pair
from palmbots.ros2.ros2_node import Ros2Node
from waiting import wait_until

BASE = Path(__file__).parents[1] / "support" / "ros2_base.py"
SIDES = ("left", "right")
W = 0.25
# Slow robots with long ticks and patient limits: the test has eight processes, and a busy machine
# with two cores may hold each of them up for a while.
SCENE = {
    "task.distance_m": 0.1,
    "robot.speed_m_s": 0.03,
    "robot.noise_m_s": 0.004,
    "control.period_s": 0.05,
    "control.watchdog_s": W,
}
PATIENT: dict[str, Any] = {
    "ros2__silence_s": 5.0,
    "limits__station_limit_s": 5.0,
    "limits__partner_lost": "controller",
    "hardware__stopping_s": 0.06,  # as the scene's robots brake
}


class Programs:
    """A world, its bases, and the programs of both robots."""

    def __init__(self, folder: Path, stack: contextlib.ExitStack) -> None:
        self.folder, self.stack = folder, stack
        (folder / "log").touch()
        (folder / "scene.toml").write_text(pb.load_scene("paper", SCENE).to_toml())
        new_pair(folder, pair__scene="scene.toml", driver__kind="ros2", **PATIENT)
        self.world = self.start("world", "scene.toml", "--serve", "unix:world", "--json")
        self.base = self.run([str(BASE), "pair.toml", "unix:world", "log"])
        self.robots = {side: self.start("robot", "pair.toml", "--side", side) for side in SIDES}

    def start(self, *command: str) -> "subprocess.Popen[str]":
        return self.run(["-m", "palmbots", *command])

    def run(self, command: Sequence[str]) -> "subprocess.Popen[str]":
        process = subprocess.Popen(
            [sys.executable, *command],
            cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        self.stack.callback(self.end, process)
        return process

    @staticmethod
    def end(process: "subprocess.Popen[str]") -> str:
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGCONT)
        process.terminate()
        return process.communicate(timeout=60)[0]

    def log(self, event: str, side: str = "") -> list[dict[str, Any]]:
        text = (self.folder / "log").read_text()
        noted = [json.loads(line) for line in text.splitlines(keepends=True) if "\n" in line]
        return [one for one in noted if one["event"] == event and one["side"] in (side or SIDES)]


def skip_if_held_up(printed: str) -> None:
    """A machine that is too busy for real time stops the robots by itself, and shows nothing."""
    if "(overrun)" in printed:
        pytest.skip("the machine held up a robot's program for seconds: fault overrun")


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Programs]:
    for name, value in dds_environment().items():
        monkeypatch.setenv(name, value)
    with contextlib.ExitStack() as stack:
        yield Programs(tmp_path, stack)


def test_two_robots_with_ros_2_bases_deliver(programs: Programs) -> None:
    node = Ros2Node(int(os.environ["ROS_DOMAIN_ID"]))
    modes = node.subscriber("/left/mode", "std_msgs/msg/String", "latched")
    bridge = programs.start("ros2", "pair.toml", "--side", "left")
    station = programs.start("station", "pair.toml", "--auto")
    heard: list[str] = []

    def has_ended() -> bool:
        heard.extend(message.data for message in modes.take())
        return station.poll() is not None

    wait_until(has_ended, 120)  # the station gives up earlier, and says why
    printed = station.communicate()[0]
    skip_if_held_up(printed)
    assert station.returncode == 0, printed
    assert "left: done\n" in printed
    for robot in programs.robots.values():
        programs.end(robot)
    programs.end(programs.base)
    result = json.loads(programs.world.communicate(timeout=60)[0])
    assert result["outcome"] == "delivered"
    assert "left robot: its program is heard\n" in programs.end(bridge)
    heard += [message.data for message in modes.take()]
    assert {"carrying", "done"} <= set(heard)
    # A service that is ended leaves the domain: subscribers hear the last mode.
    wait_until(lambda: heard[-1] == "off" or heard.extend(m.data for m in modes.take()))
    for side in SIDES:
        assert programs.log("moves", side)
        speeds = [line["speed"] for line in programs.log("command", side)]
        assert max(map(abs, speeds)) <= 0.2
        assert speeds[-1] == 0.0  # when the carry was done
    node.close()


def test_bases_stop_within_w_when_programs_are_frozen_or_killed(programs: Programs) -> None:
    station = programs.start("station", "pair.toml", "--auto")
    wait_until(
        lambda: station.poll() is not None or all(programs.log("moves", side) for side in SIDES)
    )
    if station.poll() is not None:
        printed = station.communicate()[0]
        skip_if_held_up(printed)
        pytest.fail(printed)
    os.kill(programs.robots["left"].pid, signal.SIGSTOP)
    os.kill(programs.robots["right"].pid, signal.SIGKILL)
    signalled_s = time.monotonic()
    wait_until(lambda: all(programs.log("rests", side) for side in SIDES))
    for side in SIDES:
        # Nothing repeats old commands: neither DDS in the frozen program, nor what is left of the
        # killed one.
        commands = programs.log("command", side)
        assert commands[-1]["time_s"] < signalled_s + 0.5
        if timeouts := programs.log("timeout", side):
            assert timeouts[-1]["after_s"] <= W
        else:  # the wheels rested by a command at this moment
            assert commands[-1]["speed"] == 0.0
    assert programs.log("timeout")
    assert programs.end(station)

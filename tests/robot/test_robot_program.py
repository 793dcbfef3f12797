# SPDX-License-Identifier: Apache-2.0
"""The program of a robot: what it loads, what it reports, and how fast it obeys a stop."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from json_output import records
from palmbots.clocks.control_clock import ControlClock
from palmbots.drivers.driver import Drive, Reading
from palmbots.links.local_connection import Connection, listen
from palmbots.links.reading_frame import ReadingFrame
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.robot import live_robot
from palmbots.wire import Endpoint, Hello, Operate

HEAVY = {
    "matplotlib", "pandas", "xarray", "polars", "pyarrow", "scipy", "mujoco", "rich", "dask",
    "zarr", "mcap", "gymnasium", "pettingzoo", "textual", "foxglove", "PIL", "numpy",
}  # fmt: skip


def test_the_program_of_a_robot_loads_no_heavy_package(tmp_path: Path) -> None:
    """In the process that runs it, after the first tick that would need one."""
    init_pair(tmp_path / "pair.toml", address=f"unix:{tmp_path / 'none'}")
    code = f"""
import json, sys
from palmbots.pair.live_ends import open_pair_driver
open_pair_driver.__kwdefaults__["within_s"] = 0.0
from palmbots.cli.main import run
status = run(["robot", {str(tmp_path / "pair.toml")!r}, "--side", "left"])
print(json.dumps([status, sorted(sys.modules)]))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    status, modules = json.loads(done.stdout)
    assert status == 2 and "nobody listens" in done.stderr, done.stderr
    assert "palmbots.robot.live_robot" in modules
    assert {name.partition(".")[0] for name in modules} & HEAVY == set()


class Robot:
    """A driver and a link in one, which count the ticks."""

    works = True

    def __init__(self, packets: dict[int, list[bytes]], ticks: int) -> None:
        self.packets, self.left, self.tick = packets, ticks, 0
        self.drives: list[Drive] = []
        self.sent: list[tuple[int, str]] = []

    def read(self) -> Reading | None:
        self.tick += 1
        return Reading(0, True, 0.001 * self.tick) if self.tick < self.left else None

    def write(self, drive: Drive) -> None:
        self.drives.append(drive)

    def receive(self) -> list[bytes]:
        return self.packets.get(self.tick, [])

    def send(self, receiver: str, _: bytes) -> None:
        self.sent.append((self.tick, receiver))

    def stop(self) -> None:
        pass

    def summary(self) -> dict[str, Any]:
        return {}

    def close(self) -> None:
        pass


class Clock(ControlClock):
    """Every tick comes at once, and waits until what was stored is on the disk."""

    is_stepped = True

    def wait(self) -> int:
        return 1


@pytest.mark.parametrize("stop", ["stop", "e_stop"])
def test_a_stop_reaches_the_driver_within_two_control_periods(
    stop: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A silent robot needs no partner to be armed and started. A real one says what it does."""
    values = {"driver.kind": "dry-run"}
    pair = load_pair(init_pair(tmp_path / "pair.toml", controller="silent", values=values)[0])
    station = Endpoint(pair.key, pair.settings.pair.number, "station", 1)
    packets = {tick: [station.send("left", Hello())] for tick in range(1, 40)}
    robot = Robot(packets, 100)

    def receive() -> list[bytes]:
        # The station hears the robot in every tick, so that its packets count.
        body: Any = {30: Operate("arm"), 40: Operate("start"), 60: Operate(stop, stop=True)}.get(
            robot.tick, Hello(stop=robot.tick > 60)
        )
        return [station.send("left", body)]

    def send(receiver: str, data: bytes) -> None:
        if receiver == "station":
            station.receive(data)

    monkeypatch.setattr(robot, "receive", receive)
    monkeypatch.setattr(robot, "send", send)
    monkeypatch.setattr(live_robot, "open_pair_driver", lambda *_, **__: robot)
    monkeypatch.setattr(live_robot, "open_pair_link", lambda *_: robot)
    monkeypatch.setattr(
        live_robot, "control_clock", lambda _, period_s, stride: Clock(period_s, stride)
    )
    lines: list[str] = []
    end = live_robot.run_live_robot(pair, "left", on_line=lines.append)
    modes = [line for line in lines if line.startswith("left: ")]
    assert modes == [
        f"left: {mode}" for mode in ("disarmed", "armed", "ready", "carrying", "stopped")
    ]
    wheels = [drive.wheels for drive in robot.drives]
    moving = [tick for tick, turns in enumerate(wheels, 2) if turns]
    assert moving and moving[0] <= 42
    assert moving[-1] <= 60 + 2, (moving[0], moving[-1])
    assert end.mode == "stopped"
    assert end.ticks == len(robot.drives)


def test_a_signal_while_it_ends_does_not_cut_off_its_log(tmp_path: Path) -> None:
    """Its world is gone, so it ends; then SIGTERM comes, before its log is closed."""
    address = f"unix:{tmp_path / 'world'}"
    init_pair(tmp_path / "pair.toml", address=address)
    code = f"""
import os, signal, sys
from palmbots.cli.main import run
from palmbots.robot.logged_steps import RobotLog
close = RobotLog.close
def ended_meanwhile(robot):
    os.kill(os.getpid(), signal.SIGTERM)
    close(robot)
RobotLog.close = ended_meanwhile
sys.exit(run(["robot", {str(tmp_path / "pair.toml")!r}, "--side", "left"]))
"""
    with listen(address) as door:
        command = [sys.executable, "-c", code]
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
            stream, _ = door.accept()
            with Connection(stream, "robot") as world:
                world.receive(60)
                world.send(ReadingFrame(0, True, 0.0, 0))
                world.receive(60)
            _, errors = process.communicate(timeout=60)
    assert process.returncode == 2 and "world" in errors, (process.returncode, errors)
    (log,) = (tmp_path / "pair-logs").glob("*.mcap")
    assert next(records(log))["topic"] == "/left/ticks"

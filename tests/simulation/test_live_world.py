# SPDX-License-Identifier: Apache-2.0
"""The world in real time, over real sockets: any program may connect, and send anything."""

import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.links.greeting import scene_number
from palmbots.links.local_connection import connect, listen
from palmbots.simulation.live_world import EventLines, LiveCarry, run_live_world

RATE = 10.0
SIDES: tuple[Any, ...] = ("left", "right")


class World:
    """A world that runs in a thread."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "w"
        self.address = f"unix:{self.path}"
        self.door = listen(self.address)
        self.result: LiveCarry | None = None
        self.events: list[str] = []
        self.thread = threading.Thread(target=self._run)
        self.thread.start()

    def _run(self) -> None:
        scene = pb.load_scene("paper")
        self.result = run_live_world(scene, self.door, rate=RATE, on_event=self.events.append)

    def robot(self, side: Any) -> SimulatedDriver:
        return SimulatedDriver(self.address, side, 1)


@pytest.fixture
def world(tmp_path: Path) -> Iterator[World]:
    made = World(tmp_path)
    yield made
    made.thread.join(60)
    made.door.close()
    assert made.result is not None
    assert not made.path.exists()


def strangers(path: Path) -> list[socket.socket]:
    """Callers that say nothing, nonsense, or leave at once."""
    callers = []
    for text in (b"", b"GET / HTTP/1.0\r\n\r\n", b"[[[[\n", b'["up",1]\n', b"[" * 100_000 + b"\n"):
        caller = socket.socket(socket.AF_UNIX)
        caller.connect(str(path))
        caller.sendall(text)
        callers.append(caller)
    gone = socket.socket(socket.AF_UNIX)
    gone.connect(str(path))
    gone.close()
    return callers


def test_strangers_do_not_disturb_the_world(world: World) -> None:
    callers = strangers(world.path)
    drivers = [world.robot(side) for side in ("left", "right")]
    callers += strangers(world.path)
    for _ in range(20):
        assert all(driver.read() is not None for driver in drivers)
        time.sleep(0.005)
    assert all(driver.works for driver in drivers)
    for one in (*drivers, *callers):
        one.close()


def test_a_robot_that_starts_again_before_its_partner_is_let_in(world: World) -> None:
    world.robot("left").close()
    time.sleep(0.1)
    drivers = [world.robot(side) for side in ("left", "right")]
    assert all(driver.read() is not None for driver in drivers)
    for driver in drivers:
        driver.close()


def test_a_second_program_of_a_side_is_refused_in_one_line(world: World) -> None:
    drivers = [world.robot(side) for side in ("left", "right")]
    assert drivers[0].read() is not None
    second = world.robot("left")
    with pytest.raises(pb.PalmbotsError, match=r"^world: another program is the left robot$"):
        second.read()
    for driver in (*drivers, second):
        driver.close()


@pytest.mark.parametrize(
    "frame", [5, [1], {"a": 1}, [0, 7, True], [0, 0, 0], ["0", 0, True], "end"]
)
def test_a_program_that_sends_no_commands_is_unplugged(world: World, frame: Any) -> None:
    right, broken = world.robot("right"), connect(world.address, "world", 5)
    broken.send(["left", 1, 0])
    assert right.read() is not None  # the world has started
    broken.send(frame)
    with pytest.raises(pb.PalmbotsError):
        while True:
            broken.receive(10)
    right.close()
    broken.close()


def test_a_frozen_program_does_not_hold_up_the_world(world: World) -> None:
    frozen, right = world.robot("left"), world.robot("right")
    for _ in range(50):
        assert right.read() is not None
        frozen._world.offer([0, 0, True])
        time.sleep(0.002)
    frozen.close()
    right.close()


def test_the_time_is_that_of_the_motion(world: World) -> None:
    """Not from the start of the world, which waits for its robots to be armed."""
    robots = [world.robot(side) for side in SIDES]
    for stands in (True, False, True):
        end = time.monotonic() + 0.4
        while time.monotonic() < end:
            for robot in robots:
                assert robot.read() is not None
                robot._offer([0, 0, stands])
            time.sleep(0.002)
    for robot in robots:
        robot.close()
    world.thread.join(60)
    assert world.result is not None and world.result.distance_m > 0.05
    assert world.result.time_s == pytest.approx(world.result.distance_m / 0.06, rel=0.3)


def test_a_line_when_the_pair_moves_and_rests_and_when_programs_go(world: World) -> None:
    robots = [world.robot(side) for side in SIDES]
    for stands, lines in ((False, 1), (True, 2)):
        give_up = time.monotonic() + 60
        while len(world.events) < lines and time.monotonic() < give_up:
            for robot in robots:
                assert robot.read() is not None
                robot._offer([0, 0, stands])
            time.sleep(0.002)
    for robot in robots:
        robot.close()
    world.thread.join(60)
    assert world.result is not None and world.result.reason is None
    begins, rests, *gone = world.events
    assert begins == "the pair begins to move"
    assert rests == f"the pair has come to rest, at {world.result.distance_m:.2f} m"
    assert sorted(gone) == [f"the program of the {side} robot is gone" for side in SIDES]


def test_a_pair_that_stands_for_a_correction_has_not_come_to_rest() -> None:
    said: list[str] = []
    lines = EventLines(said.append, period_s=0.01)
    places = [*np.linspace(0, 0.3, 500), *[0.3] * 295, *np.linspace(0.3, 0.5, 300)]
    for place in [*places, *[0.5 + 1e-4 * (k % 2) for k in range(400)]]:
        lines.take(place, [])
    lines.take(0.5, ["left"])
    lines.take(0.5, [])
    assert said == [
        "the pair begins to move",
        "the pair has come to rest, at 0.50 m",
        "the program of the left robot is gone",
        "the program of the left robot has come back",
    ]


def test_a_lockstep_world_is_named() -> None:
    near, far = socket.socketpair()
    far.sendall(b'["greet","right"]\n')
    driver = SimulatedDriver.__new__(SimulatedDriver)
    from palmbots.links.local_connection import Connection

    driver._side, driver._newest, driver._world = "left", None, Connection(near, "world")
    with pytest.raises(pb.PalmbotsError, match=r"^world: sends no readings; allowed: one without "):
        driver.read()
    near.close()
    far.close()


def test_a_robot_with_another_scene_is_refused(tmp_path: Path) -> None:
    made = World(tmp_path)
    other = SimulatedDriver(made.address, "left", 1, scene=12345)
    with pytest.raises(
        pb.PalmbotsError,
        match=r"^world: runs another scene than the left robot; start it with the scene of",
    ):
        other.read()
    other.close()
    number = scene_number(pb.load_scene("paper"))
    drivers = [SimulatedDriver(made.address, side, 1, scene=number) for side in SIDES]
    assert all(driver.read() is not None for driver in drivers)
    for driver in drivers:
        driver.close()
    made.thread.join(60)
    made.door.close()
    assert made.result is not None


def test_scenes_have_different_numbers() -> None:
    scenes = [pb.load_scene(name) for name in ("paper", "paper-offset", "figure8")]
    scenes += [pb.load_scene("paper", {"robot.speed_m_s": 0.05})]
    assert len({scene_number(scene) for scene in scenes}) == len(scenes)
    again = pb.load_scene(scenes[0].model_dump())
    assert scene_number(again) == scene_number(scenes[0])

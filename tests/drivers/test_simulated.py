# SPDX-License-Identifier: Apache-2.0
"""The driver of a simulated robot, frame by frame."""

from collections import deque
from typing import Any

import pytest

from palmbots.drivers.arm import HOLDS, RISES
from palmbots.drivers.driver import Drive
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.links.reading_frame import ReadingFrame


class World:
    """The end of the world: what it has sent, and what it has received."""

    def __init__(self) -> None:
        self.sent: deque[Any] = deque()
        self.received: list[Any] = []

    def poll(self) -> Any:
        return self.sent.popleft() if self.sent else None

    def send(self, frame: Any) -> None:
        self.received.append(frame)

    offer = send


def drive(arm: int, palm: int = 0) -> Drive:
    return Drive(palm, 0, stop=False, wheels=True, palm_rad=0.2, speed_m_s=0.0, arm=arm)


def reading(arm: int, is_there: bool) -> list[Any]:
    """What the world sends while the arm does this: the arm is `is_there`."""
    return [*ReadingFrame(0, True, 0.0, 0, arm=arm, arm_there=is_there, arm_steps=2)]


@pytest.mark.parametrize("frames", [0, 1], ids=["no newer reading", "a reading on its way"])
def test_an_arm_has_not_arrived_until_the_world_has_received_the_newest_command(
    frames: int,
) -> None:
    """Otherwise a robot whose arm held for a moment believes that it is up."""
    world = World()
    driver = SimulatedDriver(world, "left", 1)
    world.sent.append(reading(HOLDS, True))
    driver.write(drive(HOLDS))
    seen = driver.read()
    assert seen is not None
    assert seen.arm_there
    driver.write(drive(RISES))
    world.sent.extend([reading(HOLDS, True)] * frames)
    seen = driver.read()
    assert seen is not None
    assert not seen.arm_there
    for is_there in (False, True):
        world.sent.append(reading(RISES, is_there))
        seen = driver.read()
        assert seen is not None
        assert seen.arm_there is is_there


@pytest.mark.parametrize("arm", [None, HOLDS], ids=["carry", "job"])
def test_a_palm_has_not_turned_until_the_world_has_received_the_newest_command(
    arm: int | None,
) -> None:
    world = World()
    driver = SimulatedDriver(world, "left", 1)
    found = []
    for in_force, wanted, turned in ((0, 0, True), (0, 1, True), (1, 1, False), (1, 1, True)):
        driver.write(drive(HOLDS, wanted))
        world.sent.append([*ReadingFrame(0, turned, 0.0, in_force, arm=arm, arm_there=True)])
        seen = driver.read()
        assert seen is not None
        found.append(seen.palm_at_target)
    assert found == [True, False, False, True]

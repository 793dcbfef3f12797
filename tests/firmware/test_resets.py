# SPDX-License-Identifier: Apache-2.0
"""The supply fails at random instructions: the object stays on the palms, or the robots stop.

A carry is run once, with snapshots. Each failure starts from the last snapshot before it.
"""

import bisect
import random
from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest

from emulator.board import Image
from emulator.live import LivePair
from palmbots.firmware.pair_settings import BoardPair

COURSE_S = 5.0
STEP_S = 0.25
FOLLOWED_S = 2.0
MOVING = ("carrying", "holding")
FIRST = 20
"""Failures in `make test-firmware`."""
CHUNK, CHUNKS = 20, 50
"""Those of `make soak`: 1000 in all."""
BOOT = 40_000
"""About the instructions of a boot and its first ticks."""


class Course:
    """A carry of two boards, with snapshots."""

    def __init__(self, pair: LivePair) -> None:
        assert pair.start(), pair.state()
        self.pair = pair
        self.snapshots: list[Any] = []
        self.executed: list[list[int]] = [[], []]
        """Instructions of each board at each snapshot."""
        for _ in range(round(COURSE_S / STEP_S)):
            self._take_snapshot()
            pair.run(STEP_S)
        self._take_snapshot()

    def _take_snapshot(self) -> None:
        assert all(robot.mode in MOVING for robot in self.pair.robots), self.pair.state()
        self.snapshots.append(self.pair.snapshot())
        for executed, robot in zip(self.executed, self.pair.robots, strict=True):
            executed.append(robot.board.meter.instructions)

    def fail(self, number: int) -> Counter[str]:
        """Let the supply of a board fail at a random instruction, and follow both for a time.

        In every fourth case it fails again while the board boots.

        Returns:
            What has happened: the mode of each robot at the end.
        """
        chance = random.Random(number)
        side = chance.randrange(2)
        executed = self.executed[side]
        place = chance.randrange(executed[0], executed[-1])
        at = bisect.bisect_right(executed, place) - 1
        pair = self.pair
        pair.restore(self.snapshots[at])
        robot = pair.robots[side]
        robot.outage_s = chance.choice((0.002, 0.05, 0.5))
        board = robot.board
        failures = len(board.resets)
        board.fails_at = place
        what = f"failure {number}: {('left', 'right')[side]} board, instruction {place}"
        is_twice = number % 4 == 0
        ticks = 0
        while ticks < FOLLOWED_S / pair.scene.control.period_s:
            pair.tick()
            ticks += len(board.resets) > failures
            if is_twice and len(board.resets) > failures:
                is_twice = False
                board.fails_at = board.meter.instructions + chance.randrange(BOOT)
            assert pair.is_held, (what, pair.state())
        assert len(board.resets) - failures == (2 if number % 4 == 0 else 1), (what, pair.state())
        assert board.resets[failures:] == ["power"] * (len(board.resets) - failures)
        for each in pair.robots:
            rests = each.command()[2] and each.command()[1] == 0
            assert each.mode in MOVING or rests, (what, pair.state())
        return Counter(each.mode for each in pair.robots)


@pytest.fixture(scope="module")
def course(
    image: Image,
    boards_in: Callable[..., BoardPair],
    tmp_path_factory: pytest.TempPathFactory,
) -> Course:
    boards = boards_in(tmp_path_factory.mktemp("pair"), overrides={"task.distance_m": 1.0})
    return Course(LivePair(image, boards, seed=100, loss=0.02))


def test_a_snapshot_is_all_there_is(course: Course) -> None:
    """What follows a snapshot is the same each time."""

    def ends() -> list[Any]:
        course.pair.restore(course.snapshots[3])
        course.pair.run(1.0)
        boards = [robot.board for robot in course.pair.robots]
        return [(b.meter.instructions, b.now, b.bytes_at(0x20000000, 0x2000)) for b in boards]

    first = ends()
    course.fail(1)
    assert ends() == first
    assert [executed for executed, _, _ in first] == [e[7] for e in course.executed]


def test_the_supply_may_fail_at_any_instruction(course: Course) -> None:
    for number in range(FIRST):
        course.fail(number)


@pytest.mark.soak
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_the_supply_may_fail_at_a_thousand_instructions(course: Course, chunk: int) -> None:
    for number in range(FIRST + CHUNK * chunk, FIRST + CHUNK * (chunk + 1)):
        course.fail(number)

# SPDX-License-Identifier: Apache-2.0
"""The supply fails at random instructions: the object stays on the palms, or the robots stop.

A carry is run once, with snapshots. Each failure starts from the last snapshot before it.
"""

import bisect
import random
from collections import Counter
from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

from emulator.board import Image
from emulator.live import LivePair
from flash_records import flash_records
from palmbots.boards.pair_settings import BoardPair

COURSE_S = 5.0
STEP_S = 0.25
FOLLOWED_S = 2.0
MOMENTS_S = (0.002, 0.05, 0.5)
OUTAGES_S = (*MOMENTS_S, 10.0)
MOVING = ("carrying", "holding")
FIRST = 20
"""Failures in `make test-firmware`."""
CHUNK, CHUNKS = 20, 50
"""Those of `make soak`: 1000 in all."""
BOOT = 40_000
"""About the instructions of a boot and its first ticks."""


class Course:
    """A carry of two boards, with snapshots."""

    def __init__(self, pair: LivePair, outages_s: tuple[float, ...]) -> None:
        assert pair.start(), pair.state()
        self.pair, self.outages_s = pair, outages_s
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

        In every fourth case it fails again while the board boots, unless it stays away.

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
        robot.outage_s = chance.choice(self.outages_s)
        board = robot.board
        failures = len(board.resets)
        board.fails_at = place
        what = f"failure {number}: {('left', 'right')[side]} board, instruction {place}"
        expected = 2 if number % 4 == 0 and robot.outage_s < FOLLOWED_S else 1
        ticks = 0
        while ticks < FOLLOWED_S / pair.scene.control.period_s:
            pair.tick()
            ticks += len(board.resets) > failures
            if expected == 2 and len(board.resets) == failures + 1 and board.fails_at is None:
                board.fails_at = board.meter.instructions + chance.randrange(BOOT)
            assert pair.is_held, (what, pair.state())
        assert board.resets[failures:] == ["power"] * expected, (what, pair.state())
        for each in pair.robots:
            rests = each.command()[2] and each.command()[1] == 0
            may_move = each.mode in MOVING and robot.outage_s < FOLLOWED_S
            assert may_move or rests, (what, pair.state())
        return Counter(each.mode for each in pair.robots)


MakeCourse = Callable[..., Course]


@pytest.fixture(scope="module")
def make_course(
    image: Image,
    boards_in: Callable[..., BoardPair],
    tmp_path_factory: pytest.TempPathFactory,
) -> MakeCourse:
    """Makes the course of a controller, once."""

    @cache
    def make(controller: str = "resilient", outages_s: tuple[float, ...] = OUTAGES_S) -> Course:
        folder = tmp_path_factory.mktemp("pair")
        boards = boards_in(folder, controller, {"task.distance_m": 1.0})
        return Course(LivePair(image, boards, seed=100, loss=0.02), outages_s)

    return make


def test_a_snapshot_is_all_there_is(make_course: MakeCourse) -> None:
    """What follows a snapshot is the same each time."""
    course = make_course()

    def ends() -> list[Any]:
        course.pair.restore(course.snapshots[3])
        course.pair.run(1.0)
        boards = [robot.board for robot in course.pair.robots]
        return [(b.meter.instructions, b.now, b.bytes_at(0x20000000, 0x2000)) for b in boards]

    first = ends()
    course.fail(1)
    assert ends() == first
    assert [executed for executed, _, _ in first] == [e[7] for e in course.executed]


def test_the_supply_may_fail_at_any_instruction(make_course: MakeCourse) -> None:
    ends = Counter[str]()
    for number in range(FIRST):
        ends += make_course().fail(number)
    assert ends["off"] > 0 and ends["carrying"] > ends["off"]  # both kinds of outages happened


@pytest.mark.parametrize("word", range(6))
def test_the_supply_may_fail_at_every_word_that_is_stored(
    make_course: MakeCourse, word: int
) -> None:
    """Of two records while the robots carry: what counts then is the old or the new one."""
    pair = make_course().pair
    pair.restore(make_course().snapshots[0])
    board = pair.robots[0].board
    stored = [flash_records(board.storage())[-1]]
    while len(stored) < 3:
        pair.tick()
        newest = flash_records(board.storage())[-1]
        stored += [newest] * (newest != stored[-1])
    pair.restore(make_course().snapshots[0])
    board.nvmc.power_fails_in = word
    while not board.resets:
        pair.tick()
    found = flash_records(board.storage())[-1]
    assert found == stored[word // 3]  # the third word, the check, completes a record
    epochs = set(pair.robots[0].sent_epochs)
    pair.robots[0].sent_epochs.clear()
    pair.run(1.0)
    assert pair.is_held
    assert pair.robots[0].sent_epochs == {found.epoch + 1}
    assert found.epoch + 1 not in epochs


@pytest.mark.soak
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_the_supply_may_fail_at_a_thousand_instructions(
    make_course: MakeCourse, chunk: int
) -> None:
    for number in range(FIRST + CHUNK * chunk, FIRST + CHUNK * (chunk + 1)):
        make_course().fail(number)


@pytest.mark.soak
@pytest.mark.parametrize("chunk", range(5))
@pytest.mark.parametrize("controller", ["silent", "shared-sign"])
def test_the_supply_may_fail_for_a_moment_with_other_controllers(
    make_course: MakeCourse, controller: str, chunk: int
) -> None:
    """They go on after a boot."""
    for number in range(CHUNK * chunk, CHUNK * (chunk + 1)):
        make_course(controller, MOMENTS_S).fail(number)

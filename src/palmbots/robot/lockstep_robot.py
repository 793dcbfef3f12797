# SPDX-License-Identifier: Apache-2.0
"""A robot's program in lockstep with a world, which is its clock, its driver and its link.

The loop is that of every robot (`palmbots.robot.robot_loop`). The carry is under way from the first
tick on, and the controller alone decides.
"""

import contextlib
import math
import threading
from collections.abc import Callable
from typing import Any

import palmbots._core as _core
from palmbots._types import Side
from palmbots.clocks.control_clock import JITTER_LIMITS_MS
from palmbots.drivers.driver import Drive, Reading
from palmbots.links.greeting import scene_number
from palmbots.links.link import Link
from palmbots.links.lockstep_line import Input, LockstepLine
from palmbots.pair.live_ends import check_speed
from palmbots.pair.pair_file import Pair
from palmbots.pair.stored_state import StoredState, booted
from palmbots.robot.core_program import check_works, robot_program
from palmbots.robot.logged_steps import RobotLog
from palmbots.robot.reading_gauge import ReadingGauge
from palmbots.robot.robot_loop import RobotEnd, RobotLoop, Step
from palmbots.robot.storage_thread import StateWriter
from palmbots.wire import Role

_ALIKE = {"after_reboot": "rejoin", "partner_lost": "controller"}  # as robots in lockstep do
_NOTHING_YET = Reading(0, True, math.nan, beneath=False)


class LockstepWorld:
    """The world as a clock, a driver and a link. It gets the answer to a tick when all of it is
    known."""

    is_stepped = True
    works = True
    overruns = recent_overruns = 0
    jitter = (0,) * (len(JITTER_LIMITS_MS) + 1)

    def __init__(self, line: LockstepLine) -> None:
        self._line = line
        self._input: Input | None = None
        self._sent: list[bytes] = []
        self.program: Any = None
        """Of the robot; it greets the others before the carry."""

    def wait(self) -> int:
        """The world grants the next tick; returns the number of ticks since the last one."""
        self._input = self._line.next(lambda _: self.program.greet(), self.program.hear)
        return 1 if self._input is None else self._input.elapsed

    def read(self) -> Reading | None:
        """What the world shows; None: the carry is over."""
        seen = self._input
        if seen is None:
            return None
        touches, arm_there, far_enough, steps, beneath = seen.senses
        return Reading(
            seen.sign, seen.palm_at_target, math.nan, has_contact=touches, arm_there=arm_there,
            arm_steps=steps, far_enough=far_enough, beneath=beneath,
        )  # fmt: skip

    def receive(self) -> list[bytes]:
        """The packets of this tick."""
        assert self._input is not None
        return self._input.packets

    def write(self, drive: Drive) -> None:
        """The answer has it, too (`take`)."""

    def send(self, receiver: Role, data: bytes) -> None:
        """Send a packet, with the answer."""
        self._sent.append(data)

    def take(self, _: RobotLoop, step: Step) -> None:
        """Answer a tick."""
        palm, move, stop, packets, *rest = step.answer
        sent = [packet for packet in packets if packet[1] in self._sent]
        self._sent = []
        self._line.answer(palm, move, stop, *rest, packets=sent, at=3)

    def link(self, link: Link) -> Link:
        """The same link."""
        return link

    def run_at(self, rate: float) -> None:
        """The world knows the rate of each clock."""

    def forget(self) -> None:
        """Nothing is counted."""

    def stop(self) -> None:
        """The world has ended the carry."""

    def close(self) -> None:
        """Close the line."""
        self._line.close()


def without_effect(pair: Pair) -> str:
    """A line about the limits of a pair that are not in force in lockstep; empty: there are none.

    There the controller alone decides, as in `palmbots carry`.
    """
    table = pair.settings.limits
    given = {"after_reboot": table.after_reboot, "partner_lost": table.partner_lost}
    idle = [f'{key} = "{given[key]}"' for key, same in _ALIKE.items() if given[key] != same]
    if not idle:
        return ""
    return (
        f"{pair.file}: [limits] {' and '.join(idle)} have no effect in lockstep, where the "
        "controller alone decides, as in palmbots carry"
    )


def run_lockstep_robot(pair: Pair, side: Side, on_line: Callable[[str], None] = print) -> RobotEnd:
    """Boot the program of one robot, and run it until the world ends the carry.

    Args:
        pair: the pair.
        side: which of its robots.
        on_line: called with a warning about keys of the pair that have no effect.

    Raises:
        PalmbotsError: a file is missing or damaged, or the world is lost.
    """
    file, silent = pair.state_file(side), pair.with_logs(None, is_off=True)
    settings = _core.runtime.RuntimeSettings.lockstep()
    scene = pair.checked_scene()
    check_works(scene, side)
    check_speed(pair, side, scene)
    if text := without_effect(pair):
        on_line(f"warning: {text}")
    with booted(file) as state, contextlib.ExitStack() as stack:

        def start(state: StoredState) -> tuple[Any, RobotLog]:
            program = robot_program(pair, side, state, scene, settings, carries=True)
            return program, RobotLog(silent, side, state, scene, {}, print)

        start(state)  # refuses before anything is opened
        keeper = stack.enter_context(StateWriter(file, state))
        line = LockstepLine(pair.settings.driver.address, side, state.epoch, scene_number(scene))
        world = stack.enter_context(contextlib.closing(LockstepWorld(line)))
        gauge = ReadingGauge(pair, side, scene, _NOTHING_YET, StoredState())
        loop = RobotLoop(
            side, scene, start, world, world, world, keeper, gauge,
            watchdog=math.inf, watch=world.take,
        )  # fmt: skip
        loop.start(state)
        world.program = loop.robot
        loop.run(threading.Event())
        return loop.end({})

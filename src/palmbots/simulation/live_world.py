# SPDX-License-Identifier: Apache-2.0
"""A simulated world in real time: the motor boards and sensors of two robots.

The programs of the robots connect as drivers (`palmbots.drivers.simulated`). In every tick the
world sends a reading to each, takes the newest command of each, and moves the robots. If a program
has written nothing for ``control.watchdog_s``, the wheels of its robot stop, as on a motor board.
"""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from socket import socket
from typing import Any

import numpy as np

from palmbots._types import SIDES
from palmbots._util import process_clock
from palmbots.clocks.control_clock import control_clock
from palmbots.links.greeting import scene_number
from palmbots.links.local_connection import Connection, ConnectionLost
from palmbots.scene.scene import Scene
from palmbots.simulation.carry_ends import reason_text
from palmbots.simulation.entrance import Entrance
from palmbots.simulation.imperfections import Imperfections
from palmbots.simulation.unavoidable_drops import left_palm_unavoidably
from palmbots.simulation.world_stage import CommandForm, ImperfectStage, Stage, perfect_stage

_ALONE_S = 3.0
_REMEMBERED_S = 60.0
_DELIVERED_SHARE = 0.95
_RESTS_S = 3.0  # longer than robots stand within a carry
_MOVES_M = 1e-3  # more than a world at rest trembles
_ANSWER_WITHIN_S = 30.0  # in lockstep
_COMES = {True: "is gone", False: "has come back"}


@dataclass(frozen=True)
class LiveCarry:
    """The result of a carry in real time."""

    outcome: str
    """``delivered``: carried over at least 95 % of the distance; ``dropped``, or ``stopped``."""
    distance_m: float
    """Distance that the midpoint of the robots has covered while they carried the object."""
    time_s: float
    """Simulated time from the first motion of the pair to the last."""
    overruns: int
    """Ticks that the world missed."""
    avoidable: bool | None = None
    """After a drop: whether a controller could have prevented it."""
    reason: str | None = None
    """Why the object was dropped."""

    def line(self) -> str:
        """The same in a line for people."""
        drop = {None: "", True: ", avoidable", False: ", unavoidable"}[self.avoidable]
        why = f"  {self.reason}" if self.reason else ""
        return f"{self.outcome.upper()}{drop}  {self.distance_m:.2f} m in {self.time_s:.1f} s{why}"


class EventLines:
    """Prints a line when the pair begins to move or has come to rest, and when the program of a
    robot is gone or has come back.

    Args:
        on_line: called with each line.
        period_s: the control period.
    """

    def __init__(self, on_line: Callable[[str], None], period_s: float) -> None:
        self._on_line = on_line
        self._patience = round(_RESTS_S / period_s)
        self._place, self._still, self._moves = 0.0, 0, False
        self._missing: list[str] = []

    def take(self, midpoint: float, missing: list[str]) -> None:
        """After a tick: where the midpoint of the robots is [m], and the robots without a
        program."""
        for side in sorted({*missing} ^ {*self._missing}):
            self._on_line(f"the program of the {side} robot {_COMES[side in missing]}")
        self._missing = missing
        self._still += 1
        if abs(midpoint - self._place) > _MOVES_M:
            self._place, self._still = midpoint, 0
            if not self._moves:
                self._on_line("the pair begins to move")
            self._moves = True
        elif self._moves and self._still == self._patience:
            self._moves = False
            self._on_line(f"the pair has come to rest, at {abs(midpoint):.2f} m")


class Board:
    """The motor board of one robot.

    Args:
        stage: to which it is connected.
        side: of the robot.
        watchdog_ticks: without a command for more ticks than this, the wheels stop.
        rate: multiple of real time; infinite in lockstep.
    """

    def __init__(self, stage: CommandForm, side: int, watchdog_ticks: int, rate: float) -> None:
        self._stage, self._side, self._rate = stage, side, rate
        self._watchdog_ticks = watchdog_ticks
        self.driver: Connection | None = None
        self.command: Any = stage.rest(None)
        self._silent = 0

    def plug(self, driver: Connection) -> None:
        """A program has connected."""
        self.driver = driver
        if greeting := self._stage.greeting(self._side):
            self.send([*greeting, self._rate])

    def take(self) -> None:
        """Take in the newest command; stop the wheels if there was none for too long."""
        self._silent += 1
        try:
            while self.driver is not None and (frame := self.driver.poll()) is not None:
                self.command, self._silent = self._stage.command_in(frame), 0
        except ConnectionLost:
            self.unplug()
        if self._silent > self._watchdog_ticks:
            self.command = self._stage.rest(self.command)

    def await_command(self) -> None:
        """Wait for the next command, in lockstep; without a program the wheels stop."""
        try:
            if self.driver is not None:
                frame = self.driver.receive(_ANSWER_WITHIN_S)
                self.command, self._silent = self._stage.command_in(frame), 0
        except ConnectionLost:
            self.unplug()
        if self.driver is None:
            self.command = self._stage.rest(self.command)

    def send(self, reading: Any, *, waits: bool = False) -> None:
        """Send a reading to the program; one that is frozen misses it, unless the board waits."""
        if self.driver is not None:
            try:
                (self.driver.send if waits else self.driver.offer)(reading)
            except ConnectionLost:
                self.unplug()

    def unplug(self) -> None:
        """The program is gone."""
        if self.driver is not None:
            self.driver.close()
        self.driver = None


class LiveRobots:
    """The robots of a world in real time: a motor board for each, and the entrance for programs.

    Args:
        scene: the scene.
        stage: to which the motor boards are connected.
        door: where the programs connect.
        rate: multiple of real time.
        waits: each tick waits for a command of each robot that has a program, as in lockstep.
        watchdog_s: without a command for longer than this, wheels stop; None: as in the scene.
    """

    def __init__(
        self,
        scene: Scene,
        stage: Stage,
        door: socket,
        rate: float,
        *,
        waits: bool = False,
        watchdog_s: float | None = None,
    ) -> None:
        self._stage, self._waits, self.sides = stage, waits, scene.working_sides
        held_s = scene.control.watchdog_s if watchdog_s is None else watchdog_s
        watchdog_ticks = round(held_s / scene.control.period_s)
        self._boards: dict[str, Board] = {
            side: Board(stage, k, watchdog_ticks, math.inf if waits else rate)
            for k, side in enumerate(SIDES)
        }
        self._entrance = Entrance(door, self.sides, scene_number(scene))

    def missing(self) -> list[str]:
        """The robots without a program; one that stands aside needs none."""
        return [side for side in self.sides if self._boards[side].driver is None]

    def wait(self, on_line: Callable[[str], None]) -> None:
        """Wait until both programs have connected.

        Args:
            on_line: called with a line that names the programs still missing after some seconds.

        Raises:
            PalmbotsError: one does not come.
        """

        def missing() -> list[str]:
            for board in self._boards.values():
                board.take()  # notices a program that is gone
            return self.missing()

        self._entrance.wait(missing, self._plug, on_line)

    def tick(self) -> None:
        """One control period."""
        for side, program in self._entrance.admit([*{*self.sides} - {*self.missing()}]):
            self._plug(side, program)
        for board, frame in zip(self._boards.values(), self._stage.frames(), strict=True):
            if not self._waits:
                board.take()
            board.send(frame, waits=self._waits)
        if self._waits:
            for board in self._boards.values():
                board.await_command()
        left, right = (board.command for board in self._boards.values())
        self._stage.step(left, right)

    def end(self) -> None:
        """End the programs."""
        for board in self._boards.values():
            board.send("end")
            board.unplug()

    def _plug(self, side: str, program: Connection) -> None:
        self._boards[side].plug(program)


def run_live_world(
    scene: Scene,
    door: socket,
    *,
    world: str = "quasistatic",
    seed: int = 0,
    rate: float = 1.0,
    imperfections: Imperfections | None = None,
    on_line: Callable[[str], None] = lambda line: None,
    on_event: Callable[[str], None] | None = None,
) -> LiveCarry:
    """Run a world until the programs of both robots have gone, or the object is dropped.

    Args:
        scene: the scene; its radio and the faults of its robots are not simulated here.
        door: where the programs connect.
        world: name of the world.
        seed: of the noise.
        rate: multiple of real time.
        imperfections: what the robots really are; None: they are as in the scene.
        on_line: called with a line that names the programs still missing after some seconds.
        on_event: called with the lines of `EventLines`; None: there are none.

    Raises:
        PalmbotsError: a program does not connect in time, or is not a robot.
    """
    stage: Stage
    if imperfections is None:
        stage = perfect_stage(scene, world, seed)
    else:
        stage = ImperfectStage(scene, world, seed, imperfections)
    period_s = scene.control.period_s
    robots = LiveRobots(scene, stage, door, rate)
    robots.wait(on_line)
    clock = control_clock("world", period_s / rate)
    ticks = first = last = 0  # so far; and before and after the pair moved
    contacts: deque[tuple[float, float]] = deque(maxlen=round(_REMEMBERED_S / period_s))
    alone_since = None
    events = None if on_event is None else EventLines(on_event, period_s)
    while stage.outcome == "running":
        clock.wait()
        before = stage.midpoint
        robots.tick()
        contacts.append(stage.contacts)
        ticks += 1
        if events is not None:
            events.take(stage.midpoint, robots.missing())
        if stage.midpoint != before:
            first, last = first or ticks - 1, ticks
        if len(robots.missing()) == len(robots.sides):
            now = process_clock.monotonic()
            alone_since = alone_since or now
            if now - alone_since > _ALONE_S / rate:
                break
        else:
            alone_since = None
    robots.end()
    distance_m = abs(stage.carried_m)
    outcome = "dropped" if stage.outcome == "dropped" else "stopped"
    is_far = distance_m >= _DELIVERED_SHARE * scene.task.distance_m
    if outcome == "stopped" and is_far and stage.is_put_down:
        outcome = "delivered"
    avoidable = reason = None
    if outcome == "dropped":
        avoidable = not _was_unavoidable(scene, stage, np.array(contacts))
        reason = reason_text(stage.drop_reason() or "", world)
    time_s = (last - first) * period_s
    return LiveCarry(outcome, distance_m, time_s, clock.overruns, avoidable, reason)


def _was_unavoidable(scene: Scene, stage: Stage, contacts: np.ndarray) -> bool:
    """Whether braking could not have prevented the drop; the last contacts are those of the
    drop."""
    if stage.drop_reason() != "off-palm":
        return False
    times = scene.control.period_s * np.arange(len(contacts))
    return left_palm_unavoidably(scene, times, contacts)

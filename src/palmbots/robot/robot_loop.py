# SPDX-License-Identifier: Apache-2.0
"""The control loop of a robot: reads its driver, exchanges packets, and writes its driver.

The compiled core makes all decisions (`_core.runtime.Robot`). This loop only moves bytes: in every
step it passes readings and packets to the core, and carries out the answer. Its clock, driver and
link decide whether that happens in real time, in lockstep with a world, or inside a test.
"""

import contextlib
import gc
import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol, get_args

import palmbots._core as _core
from palmbots._types import Side
from palmbots.clocks.clock import Clock
from palmbots.clocks.control_clock import jitter_table
from palmbots.drivers.arm import NEW_ARM
from palmbots.drivers.driver import Drive, Driver, Reading, works
from palmbots.errors import PalmbotsError
from palmbots.links.link import Link
from palmbots.links.packet_statistics import LinkCounts, PacketStatistics
from palmbots.pair.drive_table import drive_table
from palmbots.pair.stored_state import StoredState
from palmbots.robot.logged_steps import RobotLog
from palmbots.robot.reading_gauge import ReadingGauge
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.wire import Role, Verdict
from palmbots.wire.packets import ROLES


@dataclass(frozen=True)
class RobotEnd:
    """How the program of a robot has run."""

    side: Side
    boots: int
    """How often the robot has booted in its life."""
    mode: str
    """Its last mode."""
    fault: str
    ticks: int
    """Steps of the control loop."""
    overruns: int
    """Steps that were missed."""
    jitter: dict[str, int]
    """How many steps began late by how much."""
    link: LinkCounts
    """What was exchanged with each other end (`palmbots.links.packet_statistics`)."""
    verdicts: dict[str, int]
    """Received packets by verdict."""


class Keeper(Protocol):
    """Stores what a robot must remember (`palmbots.robot.storage_thread`)."""

    works: bool
    """The newest attempt to write has not failed."""

    @property
    def is_done(self) -> bool:
        """All that the partner relies on after a boot is stored."""
        ...

    def keep(self, state: StoredState) -> None:
        """Store the state, if it has changed; returns at once."""
        ...

    def boot(self) -> StoredState:
        """Count a boot, and return the state after it, which is stored."""
        ...

    def settle(self) -> None:
        """Wait until everything has been tried once."""
        ...


class Step(NamedTuple):
    """One step of the loop, for those who watch it."""

    seen: Reading
    drive: Drive
    answer: Any
    """Of `_core.runtime.Robot.step`."""


class RobotLoop:
    """The control loop of one robot.

    Args:
        side: which robot.
        scene: of the pair.
        start: starts the core's program after a boot; returns it with a log of its own.
        driver: of the robot.
        link: of the robot.
        clock: grants the steps.
        keeper: stores the state.
        gauge: makes the core's inputs of readings.
        watchdog: ticks after which a program that was held up in a carry boots again.
        last_ticks: for which the others hear that the driver is lost.
        watch: called after every step.
        on_line: called with a line when the program has been held up and starts again.
    """

    def __init__(
        self,
        side: Side,
        scene: Scene,
        start: Callable[[StoredState], tuple[Any, RobotLog]],
        driver: Driver,
        link: Link,
        clock: Clock,
        keeper: Keeper,
        gauge: ReadingGauge,
        *,
        watchdog: float,
        last_ticks: int = 1,
        watch: Callable[["RobotLoop", Step], None] = lambda *_: None,
        on_line: Callable[[str], None] = print,
    ) -> None:
        self._side: Side = side
        self._start, self._driver, self._link, self.clock = start, driver, link, clock
        self._keeper, self._gauge, self._watch, self._on_line = keeper, gauge, watch, on_line
        self._drives = drive_table(scene, side)
        self._has_arms = to_spec(scene).uses_floor
        self._period_s = scene.control.period_s
        self._watchdog, self._last_ticks = watchdog, last_ticks
        self._ticks = self._epoch = 0
        self._statistics = PacketStatistics(side)
        self._may_resume = False
        self._arm = NEW_ARM
        self.robot: Any = None
        """The core's program."""
        self._log: RobotLog | None = None

    def start(self, state: StoredState, *, may_resume: bool = True) -> None:
        """Start the program, with a log of its own; `may_resume`: a stored carry goes on."""
        self._epoch, self._may_resume, self._arm = state.epoch, may_resume, state.arm
        self._carries = state.carries and may_resume
        self.close()
        self.robot, self._log = self._start(state)

    def close(self) -> None:
        """Write what is left of the log."""
        if self._log is not None:
            self._log.close()

    def run(self, ended: threading.Event) -> None:
        """Step until the driver ends it, or the event is set."""
        with _little_garbage():
            while not ended.is_set() and self.step(self.clock.wait()):
                pass
        self._driver.stop()

    def step(self, elapsed: int) -> bool:
        """One step, so many ticks after the last one; false: the driver has ended the carry.

        Raises:
            PalmbotsError: the driver is lost. The others have heard of it.
        """
        if self.robot.wheels and elapsed > self._watchdog:
            elapsed = self._boot(elapsed)
        seen = self._read()
        if seen is None:
            return False
        self._arm = seen.stored_arm
        values = self._gauge.take(
            seen,
            carries=self._carries,
            counts=self.robot.counts,
            share_of_way=self.robot.share_of_way,
            backs_off=self.robot.phase == "back_off",
            driver_ok=works(self._driver),
            storage_ok=self._keeper.works,
            overruns=min(self.clock.recent_overruns, 0xFFFF),
        )
        packets = self._link.receive()
        answer = self._decide(min(elapsed, 0xFFFF), values, packets)
        for data, (_, sender, stamp, heard) in zip(packets, self.robot.judged, strict=True):
            if sender >= 0:
                self._statistics.take(ROLES[sender], stamp, data, heard)
        drive = self._obey(answer)
        self._carries = self.robot.wheels
        self._ticks += 1
        self._watch(self, Step(seen, drive, answer))
        return True

    @property
    def heard(self) -> tuple[Role, ...]:
        """The other ends from which an authentic packet has arrived."""
        return tuple(end for end, one in self._statistics.ends.items() if one.received)

    def end(self, details: Mapping[str, Any]) -> RobotEnd:
        """How it has run; `details`: what the link says about itself."""
        robot, clock = self.robot, self.clock
        return RobotEnd(
            self._side,
            self._epoch,
            robot.mode,
            robot.fault,
            self._ticks,
            clock.overruns,
            jitter_table(clock.jitter),
            self._statistics.counts(details),
            self.verdicts(),
        )

    def verdicts(self) -> dict[str, int]:
        """Received packets by verdict."""
        return {name: self.robot.count(number) for number, name in enumerate(get_args(Verdict))}

    def _boot(self, elapsed: int) -> int:
        """Start again: in a carry, a program that was held up for longer than the watchdog's time
        may not go on with what it knew (docs/theory/protocols.md)."""
        held_up_s = elapsed * self._period_s
        self._on_line(
            f"{self._side}: was held up for {held_up_s:.2f} s, longer than control.watchdog_s; "
            "starts again"
        )
        self.start(self._keeper.boot(), may_resume=self._may_resume)
        self.clock.forget()
        return 1

    def _read(self) -> Reading | None:
        """What the driver reads; None: it has ended the carry.

        Raises:
            PalmbotsError: the driver is lost. The others have heard of it.
        """
        try:
            return self._driver.read()
        except PalmbotsError:
            for _ in range(self._last_ticks):
                lost = {"sign": 0, "palm_at_target": False, "driver_ok": False}
                for receiver, data, _ in self._decide(1, lost, [])[3]:
                    self._link.send(ROLES[receiver], data)
            self._keeper.keep(self._stored(False))
            raise

    def _stored(self, assists: bool) -> StoredState:
        """What the robot has to remember over a boot."""
        carries, is_stopped = self.robot.to_store
        covered_m, approached_m = self._gauge.to_store_m if carries else (0.0, 0.0)
        return StoredState(
            self._epoch, assists, carries, is_stopped, covered_m, self.robot.holds, self._arm,
            approached_m,
        )  # fmt: skip

    def _decide(self, elapsed: int, values: dict[str, Any], packets: list[bytes]) -> Any:
        """A step of the core's program, logged."""
        answer = self.robot.step(elapsed, _core.runtime.Reading(**values), packets)
        assert self._log is not None
        self._log.take(self.robot, elapsed, values, packets, answer)
        return answer

    def _obey(self, answer: Any) -> Drive:
        """Store, drive and send what the core has decided."""
        assert self._log is not None
        palm, move, stop, packets, *_, assists = answer
        self._keeper.keep(self._stored(assists))
        drive = self._drives[palm, move, stop, self.robot.wheels]
        if self._has_arms:
            drive = replace(
                drive, arm=self.robot.arm, arm_ends=self.robot.arm_ends,
                phase=self.robot.phase_state,
            )  # fmt: skip
        self._driver.write(drive)
        if self.clock.is_stepped:
            self._keeper.settle()
        for (receiver, data, _), stamp in zip(packets, self.robot.stamps, strict=True):
            # What the partner relies on after a boot is stored before it is said. A robot that
            # does not carry promises nothing, and must pass on a stop at once.
            if receiver == 2 or self._keeper.is_done or not self.robot.wheels:
                self._statistics.note_sent(ROLES[receiver], stamp, data)
                self._link.send(ROLES[receiver], data)
            else:
                self._log.withhold(receiver)
        return drive


@contextlib.contextmanager
def _little_garbage() -> Iterator[None]:
    """What is there stays: to search it for garbage would hold up the loop."""
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()

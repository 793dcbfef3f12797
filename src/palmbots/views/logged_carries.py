# SPDX-License-Identifier: Apache-2.0
"""When each robot of a run carried, how far, and why it ended, from the logs of the robots."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palmbots._types import SIDES
from palmbots.logs.run_log_reader import RunLog
from palmbots.pair.fault_words import FAULT_WORDS
from palmbots.views.log_alignment import ClockFit

WHOLE = 65535
"""The progress of a robot that has covered the whole distance."""
_MODES = ("carrying", "holding")


@dataclass(frozen=True)
class LoggedCarry:
    """One robot from the tick in which it began to carry to the one in which it ended."""

    robot: str
    file: str
    run: int
    start_s: float
    """On the clock of the reference of the run."""
    duration_s: float
    """On the robot's own clock."""
    covered: float
    """Share of the task's distance that the robot had covered at the end, from 0 to 1."""
    end: str
    """Why it ended."""

    @property
    def row(self) -> tuple[str, ...]:
        """This carry as a row of a table."""
        name, start, time = (
            Path(self.file).name,
            f"{self.start_s:.2f} s",
            f"{self.duration_s:.2f} s",
        )
        return str(self.run), name, start, time, f"{self.covered:.0%}", self.end


def travel_ticks(log: RunLog) -> int:
    """How many ticks a robot without encoders takes to cover the distance; 0: it has encoders."""
    return int(log.facts["settings"]["travel"])


def logged_carries(logs: Sequence[RunLog], clocks: Sequence[ClockFit]) -> tuple[LoggedCarry, ...]:
    """Every carry of every robot, in the order of time in each run.

    Args:
        logs: of the programs.
        clocks: for each log how its clock relates to that of the reference of its run.
    """
    orders = [
        _Stop(fit.run, fit.to_reference(now), line.text)
        for log, fit in zip(logs, clocks, strict=True)
        if log.end not in SIDES
        for now, line in log.messages["lines"]
        if line.text.endswith((": stop", ": e-stop"))  # as the station says what is wanted, of whom
    ]
    found = [
        carry
        for log, fit in zip(logs, clocks, strict=True)
        if log.end in SIDES
        for carry in _of_robot(log, fit, orders)
    ]
    return tuple(sorted(found, key=lambda one: (one.run, one.start_s)))


@dataclass(frozen=True)
class _Stop:
    """A stop that the station has ordered."""

    run: int
    time_s: float
    text: str


def _of_robot(log: RunLog, fit: ClockFit, orders: Sequence[_Stop]) -> Iterator[LoggedCarry]:
    first: tuple[float, Any] | None = None
    last: tuple[float, Any] | None = None
    carried, travelled = 0, False  # ticks in mode carrying; whether the last one was in it

    def carry(end: str) -> LoggedCarry:
        assert first is not None
        assert last is not None
        start_s, duration_s = fit.to_reference(first[0]), last[0] - first[0]
        covered = last[1].progress / WHOLE
        if travel := travel_ticks(log):
            covered = min(1.0, carried / travel)
        return LoggedCarry(log.end, str(log.path), fit.run, start_s, duration_s, covered, end)

    for now, tick in log.messages["ticks"]:
        if tick.mode in _MODES:
            carried = carried + tick.elapsed * travelled if first else 0
            travelled = tick.mode == "carrying"
            first, last = first or (now, tick), (now, tick)
        elif first is not None:
            begin_s, end_s = fit.to_reference(first[0]), fit.to_reference(now) + fit.uncertainty_s
            known = [one for one in orders if one.run == fit.run and begin_s <= one.time_s <= end_s]
            yield carry(_end(tick, known[-1].text if known else ""))
            first = None
    if first is not None:
        why = "was killed, or its disk was full" if log.is_cut else "ended or started again"
        yield carry(f"its program {why}")


def _end(tick: Any, order: str) -> str:
    """What the first tick after a carry says about its end; `order` is a stop of the station."""
    if tick.mode == "stopped" and order and not tick.stop:
        return f"stopped ({order})"
    if tick.mode == "stopped":
        return "stopped by hand" if tick.stop else "stopped by hand, its partner or the station"
    words = FAULT_WORDS.get(tick.fault)
    return tick.mode if words is None else f"{tick.mode} ({tick.fault}: {words.meaning})"

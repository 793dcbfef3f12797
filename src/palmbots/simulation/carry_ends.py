# SPDX-License-Identifier: Apache-2.0
"""What ends a carry, and why: the table of the core (mechanics/carry_ends.hpp), in words."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import palmbots._core as _core
from palmbots._util.command import command
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result

if TYPE_CHECKING:
    from palmbots.simulation.outcome_counts import OutcomeCounts

PHASES: dict[str, str] = _core.carry_phases
"""The phases of a task that differ in what ends it, in words."""
_ROWS: dict[str, tuple[str, str, dict[str, Any]]] = _core.carry_ends
_FOLLOWS = {
    "never": "–",
    "goes on": "goes on",
    "stalls": "wheels stall",
    "falls": "falls, or {}",
    "ends": "ends",
}
_LEGEND = {
    "wheels stall": "they stand for the rest of the control period; the carry goes on",
    "falls, or NAME": "the object falls to where it rests; if that is farther than world.fall_m, "
    "the carry ends as NAME",
    "–": "does not happen in this phase",
}


@dataclass(frozen=True)
class CarryEnd:
    """What may happen, and in which phases of the task it ends a carry."""

    name: str
    meaning: str
    in_mujoco: str
    """Its meaning in MuJoCo."""
    follows: dict[str, str]
    """By phase: "goes on", "ends", or one of the words that `palmbots ends` explains."""


@dataclass(frozen=True, repr=False)
class EndList(Result):
    """Everything that may end a carry."""

    phases: dict[str, str]
    """What each phase is."""
    ends: tuple[CarryEnd, ...]

    def lines(self) -> Iterator[Item]:
        """What follows in each phase, and what the names mean."""
        rows = [(bold(end.name), *end.follows.values()) for end in self.ends]
        yield Table([("", *map(bold, self.phases)), *rows], gap=2)
        yield ""
        yield Table([(bold(name), meaning) for name, meaning in self.phases.items()], gap=2)
        yield ""
        yield Table([(bold(what), meaning) for what, meaning in _LEGEND.items()], gap=2)
        yield ""
        for end in self.ends:
            yield Line(bold(f"{end.name}: "), end.meaning)
            if end.in_mujoco != end.meaning:
                yield quiet(f"  in MuJoCo: {end.in_mujoco}")


@command(order=175, example="palmbots ends")
def ends() -> EndList:
    """List what ends a carry, and in which phases of the task."""
    rows = []
    for name, (meaning, in_mujoco, by_phase) in _ROWS.items():
        follows = {
            phase: _FOLLOWS[then].format(reason) for phase, (then, reason) in by_phase.items()
        }
        rows.append(CarryEnd(name, meaning, in_mujoco, follows))
    return EndList(PHASES, tuple(rows))


def ends_in(phase: str) -> dict[str, str]:
    """The reason for which each event ends a carry in a phase. Falls count as ends."""
    by_name = ((name, by_phase[phase][1]) for name, (*_, by_phase) in _ROWS.items())
    return {name: reason for name, reason in by_name if reason}


def reason_text(reason: str, world: str) -> str:
    """The reason of a drop and what it means."""
    meaning, in_mujoco, _ = _ROWS.get(reason, ("", "", None))
    return f"{reason}: {in_mujoco if world == 'mujoco' else meaning}".rstrip(": ")


def usual_reason(counts: "OutcomeCounts", world: str) -> str | None:
    """The most frequent reason of the drops, and what it means; None: nothing dropped."""
    return next((reason_text(reason, world) for reason in counts.reasons), None)

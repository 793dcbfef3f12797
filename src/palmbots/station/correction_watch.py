# SPDX-License-Identifier: Apache-2.0
"""Corrections as the station sees them: from the cases that the robots report."""

from dataclasses import dataclass, replace

from palmbots._types import SIDES, Side
from palmbots._util.text import letter_label
from palmbots.scene.scene import Scene

ASSISTING = "c"
_NONE = " "
_LEAST_LIMIT_S = 5.0


def longest_correction_s(scene: Scene) -> float:
    """A time that no correction needs, unless a robot waits for a message that never comes: the way
    over a whole palm at the correction speed, and two turns of a palm [s]; at least 5 s."""
    longest = _LEAST_LIMIT_S
    for side in SIDES:
        palm, speed_m_s = scene.palm_of(side), scene.robot_of(side).correction_m_s
        if speed_m_s > 0:
            turn_s = abs(palm.steep_deg - palm.shallow_deg) / palm.rate_deg_s
            longest = max(longest, palm.length_m / speed_m_s + 2 * turn_s)
    return longest


@dataclass(frozen=True)
class SeenCorrection:
    """One correction, as far as it is known."""

    label: str
    """A, B, … Z, AA, … in the order in which they were seen to start."""
    robot: Side
    """Whose contact is corrected."""
    case: str
    """``a``, ``b``, ``d`` of Table 2, or ``1`` to ``8`` of Table 1."""
    assistant: Side | None
    """The robot that was seen to assist."""
    start_s: float
    end_s: float | None
    """None: it is under way."""


class CorrectionWatch:
    """Finds corrections in the cases that the robots report, with the labels of Figure 8.

    A correction that is shorter than the time between two reports can be missed.

    Args:
        limit_s: a correction that lasts longer hangs (`longest_correction_s`).
    """

    def __init__(self, limit_s: float = _LEAST_LIMIT_S) -> None:
        self._limit_s = limit_s
        self._cases: dict[Side, str] = dict.fromkeys(SIDES, _NONE)
        self._since_s: dict[Side, float] = {}  # of the cases of which nothing has been said yet
        self._under_way: dict[Side, SeenCorrection] = {}
        self._count = 0
        self.ended: list[SeenCorrection] = []
        """The corrections that are over, in the order of their ends."""

    @property
    def under_way(self) -> tuple[SeenCorrection, ...]:
        """The corrections that are under way, in the order of their starts."""
        return tuple(sorted(self._under_way.values(), key=lambda one: one.start_s))

    def take(self, side: Side, case: str, now: float) -> str | None:
        """A robot reports its case; returns a line about what has begun or ended, if anything."""
        before, self._cases[side] = self._cases[side], case
        if case == before:
            return None
        self._since_s[side] = now
        other: Side = "right" if side == "left" else "left"
        line = None
        if (over := self._under_way.pop(side, None)) is not None:
            self.ended.append(replace(over, end_s=now))
            line = f"correction {over.label} ends after {now - over.start_s:.1f} s"
        if case == ASSISTING:
            helped = self._under_way.get(other)
            if helped is None:
                return f"{side} assists"
            self._under_way[other] = replace(helped, assistant=side)
            return f"correction {helped.label}: {side} assists"
        if case == _NONE:
            return line
        assistant = other if self._cases[other] == ASSISTING else None
        begun = SeenCorrection(letter_label(self._count), side, case, assistant, now, None)
        self._count += 1
        self._under_way[side] = begun
        return f"correction {begun.label} of {side} ({case}) begins"

    def hanging(self, now: float) -> list[str]:
        """A line, once, about each robot that corrects or assists for too long."""
        lines = []
        for side, since_s in [*self._since_s.items()]:
            if self._cases[side] == _NONE or now - since_s <= self._limit_s:
                continue
            del self._since_s[side]
            one = self._under_way.get(side)
            what = f"{side} assists" if one is None else f"correction {one.label} of {side} lasts"
            lines.append(f"{what} for more than {self._limit_s:g} s: it hangs")
        return lines

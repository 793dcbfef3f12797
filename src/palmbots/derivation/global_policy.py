# SPDX-License-Identifier: Apache-2.0
"""A global policy as data: Table 1 of the paper, and its mirror image.

A policy looks at the signs of both contacts p_L and p_R, 0 being the nominal place and positive
outward, and says which palm to tilt up and how to change the separation until a contact has come
to 0. Robots and palms are numbered as everywhere: 0 left, 1 right. A case of a policy file
(policy_file.py) states both palms and the wheels of both robots, and ends when a sign changes.

Source: section 2 and Table 1; `table_1` is read from the table that the controller runs.
"""

from dataclasses import dataclass, replace
from typing import Literal

import palmbots._core as _core
from palmbots._types import SIDES

Signs = tuple[int, int]
Direction = Literal["away", "closer"]
Angle = Literal["steep", "shallow"]
Angles = tuple[Angle, Angle]
Drives = tuple[bool, bool]
"""Which robots drive."""

_MARK = {-1: "−", 0: "0", 1: "+"}


def signs_text(signs: Signs) -> str:
    """A pair of signs in the notation of the docs: (+, −)."""
    return f"({_MARK[signs[0]]}, {_MARK[signs[1]]})"


@dataclass(frozen=True)
class Until:
    """A condition on one contact: p ≤ 0 or p ≥ 0; in a policy file also p < 0 or p > 0."""

    contact: int
    relation: Literal["≤", "≥", "<", ">"]

    def holds(self, signs: Signs) -> bool:
        """Whether these signs fulfil the condition."""
        sign = signs[self.contact]
        return {"≤": sign <= 0, "≥": sign >= 0, "<": sign < 0, ">": sign > 0}[self.relation]

    def __str__(self) -> str:
        return f"p_{'LR'[self.contact]} {self.relation} 0"


@dataclass(frozen=True)
class Move:
    """The separation changes until one of the conditions holds."""

    direction: Direction
    until: tuple[Until, ...]

    @property
    def end(self) -> str:
        """The condition in words."""
        relations = {u.relation for u in self.until}
        if not relations:
            return "a sign changes"
        if len(relations) > 1:
            return " or ".join(map(str, self.until))
        return " or ".join(f"p_{'LR'[u.contact]}" for u in self.until) + f" {relations.pop()} 0"

    def over(self, signs: Signs) -> bool:
        """Whether these signs end the move."""
        return any(condition.holds(signs) for condition in self.until)


@dataclass(frozen=True)
class Case:
    """A row of the policy: the signs, the palm to tilt up, and the moves in their order."""

    signs: Signs
    tilt: int | None
    moves: tuple[Move, ...]
    angles: Angles | None = None
    """Both palms, in a policy file; None: steep, apart from the one to tilt up."""
    drives: Drives | None = None
    """Which robots drive, in a policy file; None: those whose contacts end the move."""

    @property
    def palms(self) -> Angles:
        """The angles of both palms during the moves."""
        if self.angles is not None:
            return self.angles
        return "shallow" if self.tilt == 0 else "steep", "shallow" if self.tilt == 1 else "steep"

    def label(self, number: int) -> str:
        """How messages call the case: by its number, in a policy file by its signs."""
        return f"case {number}" if self.angles is None else f"row {signs_text(self.signs)}"


Policy = tuple[Case, ...]


@dataclass(frozen=True)
class Wiring:
    """Which robot senses each contact and which one turns each palm; pairs are (left, right).

    The wheels of both robots change the separation.
    """

    senses: tuple[int, int] = (0, 1)
    turns: tuple[int, int] = (0, 1)

    @property
    def alike(self) -> bool:
        """Whether the robots are mirror images of each other."""
        return all(left != right for left, right in (self.senses, self.turns))


def table_1() -> Policy:
    """Table 1 as the centralized controller runs it."""
    return tuple(
        Case(
            (signs[0], signs[1]),
            None if tilt == "none" else SIDES.index(tilt),
            tuple(_move(*action) for action in actions if action[0] != "hold"),
        )
        for signs, tilt, *actions in _core.table1()
    )


def _move(direction: str, whose: str, until: str) -> Move:
    contacts = (0, 1) if whose == "either" else (SIDES.index(whose),)
    relation = "≤" if until == "le_zero" else "≥"
    return Move(
        "away" if direction == "away" else "closer", tuple(Until(c, relation) for c in contacts)
    )


def as_printed() -> Policy:
    """Table 1 as printed in our copy of the paper: the conditions of case 7 are inverted."""
    turned: dict[str, Literal["≤", "≥"]] = {"≤": "≥", "≥": "≤"}
    *others, seven, eight = table_1()
    inverted = tuple(
        replace(move, until=tuple(replace(u, relation=turned[u.relation]) for u in move.until))
        for move in seven.moves
    )
    return (*others, replace(seven, moves=inverted), eight)


def mirrored(policy: Policy) -> Policy:
    """The policy with left and right exchanged, case by case."""
    return tuple(
        Case(
            (case.signs[1], case.signs[0]),
            None if case.tilt is None else 1 - case.tilt,
            tuple(
                replace(move, until=tuple(replace(u, contact=1 - u.contact) for u in move.until))
                for move in case.moves
            ),
            None if case.angles is None else (case.angles[1], case.angles[0]),
            None if case.drives is None else (case.drives[1], case.drives[0]),
        )
        for case in policy
    )

# SPDX-License-Identifier: Apache-2.0
"""Global policies from TOML files.

A file has a row for each pair of contact signs, (p_L, p_R). A row gives the angles of both palms
and what each robot's wheels do, and holds until a sign changes::

    description = "one line"

    [rows]
    "+0" = { palms = ["steep", "shallow"], drives = ["away", "hold"] }
    …

The row "00" is the goal: its palms are those at rest.
"""

import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal, cast, get_args

from palmbots._util.arguments import show
from palmbots._util.user_paths import user_path
from palmbots.derivation.contact_motion import sliders, up
from palmbots.derivation.global_policy import (
    Angle,
    Angles,
    Case,
    Direction,
    Move,
    Policy,
    Signs,
    Until,
)
from palmbots.errors import PalmbotsError
from palmbots.scene.file_kinds import FileKind
from palmbots.scene.files import read_table

Drive = Literal["hold", "away", "closer"]
POLICY_FILE = FileKind(
    "a policy file",
    "--controller and palmbots derive",
    "it has nine rows",
    keys=("description", "rows"),
)
_SIGNS = {"-": -1, "0": 0, "+": 1}
_KEYS: dict[str, Signs] = {
    left + right: (_SIGNS[left], _SIGNS[right]) for left, right in product("+0-", "+0-")
}
# What ends a move, by the sign of a contact that may slide and the sign of its change. A contact
# that moves on without a change of its sign ends nothing.
_UNTIL: dict[tuple[int, int], Literal["≤", "≥", "<", ">"]] = {
    (1, -1): "≤", (0, -1): "<", (0, 1): ">", (-1, 1): "≥",
}  # fmt: skip


@dataclass(frozen=True)
class Row:
    """What a policy does at a pair of signs. Pairs are (left, right)."""

    palms: Angles
    drives: tuple[Drive, Drive]

    @property
    def direction(self) -> Direction | None:
        """How the separation changes; None: it does not."""
        for drive in self.drives:
            if drive != "hold":
                return drive
        return None


@dataclass(frozen=True)
class PolicyTable:
    """A policy file: nine rows."""

    description: str
    rows: Mapping[Signs, Row]

    @property
    def rest(self) -> Angles:
        """The palms at rest: those of the row (0, 0)."""
        return self.rows[0, 0].palms

    @property
    def cases(self) -> Policy:
        """The rows as cases of a policy, in the order of the signs; (0, 0) only if it moves."""
        return tuple(
            _case(signs, self.rows[signs])
            for signs in _KEYS.values()
            if signs != (0, 0) or self.rows[signs].direction is not None
        )

    def first(self, signs: Signs) -> int | None:
        """The robot whose contact alone may slide in a row; None: there is none."""
        row = self.rows[signs]
        movable = sliders(row.palms, row.direction) if row.direction is not None else frozenset()
        return next(iter(movable)) if len(movable) == 1 else None


def _case(signs: Signs, row: Row) -> Case:
    moves: tuple[Move, ...] = ()
    if row.direction is not None:
        ends = {c: (signs[c], up(row.direction)) for c in sorted(sliders(row.palms, row.direction))}
        until = tuple(Until(c, _UNTIL[end]) for c, end in ends.items() if end in _UNTIL)
        moves = (Move(row.direction, until),)
    return Case(signs, None, moves, row.palms, (row.drives[0] != "hold", row.drives[1] != "hold"))


def read_policy(path: str | os.PathLike[str]) -> PolicyTable:
    """The policy in a TOML file.

    Raises:
        PalmbotsError: the file cannot be read, or is no policy. The message, of one line, names the
            file and the key, and says what is allowed.
    """
    name = os.fspath(user_path(path))
    table = read_table(name, POLICY_FILE)
    _known(name, table, POLICY_FILE.keys)
    description = table.get("description", "")
    if not isinstance(description, str) or len(description.splitlines()) > 1:
        raise PalmbotsError(
            f"{name}: description is {show(description)}; allowed: a text of one line"
        )
    rows = table.get("rows")
    if not isinstance(rows, dict):
        what = "is missing" if rows is None else f"is {show(rows)}"
        raise PalmbotsError(f"{name}: rows {what}; allowed: a table with the nine rows {_listed()}")
    _known(name, rows, tuple(_KEYS), "rows", _listed())
    missing = [key for key in _KEYS if key not in rows]
    if missing:
        lacking = ", ".join(f'"{key}"' for key in missing)
        raise PalmbotsError(f"{name}: rows has no {lacking}; needed: all of {_listed()}")
    return PolicyTable(
        description, {signs: _row(name, key, rows[key]) for key, signs in _KEYS.items()}
    )


def _listed() -> str:
    return ", ".join(f'"{key}"' for key in _KEYS)


def _known(
    name: str, table: Mapping[str, Any], keys: Collection[str], within: str = "", allowed: str = ""
) -> None:
    for key in table:
        if key not in keys:
            where = f"{within}: " if within else ""
            raise PalmbotsError(
                f"{name}: {where}unknown key {show(key)}; allowed: {allowed or ', '.join(keys)}"
            )


def _row(name: str, key: str, given: object) -> Row:
    where = f'rows."{key}"'
    if not isinstance(given, dict):
        raise PalmbotsError(
            f"{name}: {where} is {show(given)}; allowed: "
            '{ palms = ["steep", "shallow"], drives = ["away", "hold"] } and the like'
        )
    _known(name, given, ("palms", "drives"), where)
    palms = _pair(name, where, given, "palms", get_args(Angle))
    drives = _pair(name, where, given, "drives", get_args(Drive))
    if {"away", "closer"} <= set(drives):
        raise PalmbotsError(
            f"{name}: {where}.drives is {show(list(drives))}, which cancels out; allowed: "
            "the same direction for both robots, or hold"
        )
    return Row(cast("Angles", palms), cast("tuple[Drive, Drive]", drives))


def _pair(
    name: str, where: str, row: Mapping[str, Any], key: str, legal: Sequence[str]
) -> tuple[str, str]:
    allowed = f"two of {', '.join(legal)}: the left robot's, the right robot's"
    if key not in row:
        raise PalmbotsError(f"{name}: {where}.{key} is missing; allowed: {allowed}")
    value = row[key]
    if (
        not isinstance(value, list)
        or len(value) != 2
        or not all(isinstance(one, str) and one in legal for one in value)
    ):
        raise PalmbotsError(f"{name}: {where}.{key} is {show(value)}; allowed: {allowed}")
    return value[0], value[1]

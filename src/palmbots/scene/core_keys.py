# SPDX-License-Identifier: Apache-2.0
"""The keys that the core reads: default, unit and limits come from its table.

A field of a section states the name of its key, ``loss: float = key("radio.loss")``, and adds a
type and a docstring. The rows stand in ``include/palmbots/sim/*_keys.hpp``. `OUTSIDE_CORE` lists
the keys of a scene that the core does not read; their fields have limits of their own.
"""

from dataclasses import dataclass
from typing import Any

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticUndefined

import palmbots._core as _core
from palmbots.scene.fields import OneOf, Range, from_list, is_switch, whole

OUTSIDE_CORE = (
    "palm.width_m", "palm.lip_height_m", "palm.lip_clearance_m", "robot.error_trace", "radio.trace",
    "task.path", "task.route", "mujoco.wheel_radius_mismatch", "mujoco.switch", "mujoco.step_s",
)  # fmt: skip
"""Beginnings of keys of a scene that only Python reads: of the MuJoCo world, of the curve of a
path, of routes, and names of recordings."""

ROWS: dict[str, dict[str, Any]] = {row["name"]: row for row in _core.scene_keys()}
"""The rows of the core's table by name. ``[]`` in a name stands for the records of a list."""
_LISTS: dict[str, tuple[int, list[float]]] = _core.scene_lists()


@dataclass(frozen=True)
class Optionally:
    """A validator that lets None, a key that is not set, pass."""

    check: Any

    def __call__(self, value: object) -> Any:
        """None, or what the validator makes of the value."""
        return None if value is None else self.check(value)


def keys_with_holders(section: str) -> set[str]:
    """The keys of a section for which a side or a sender may have a value of its own."""
    paths = (name.partition(".") for name, row in ROWS.items() if row["holders"])
    return {key for table, _, key in paths if table == section}


def most_records(name: str) -> int:
    """How many records a list may have."""
    return _LISTS[name][0]


def _check_of(row: dict[str, Any]) -> Any:
    least, most = row["least"], row["most"]
    if row["kind"] == "flag":
        return is_switch
    if row["kind"] == "choice":
        return OneOf(row["choices"])
    if row["kind"] == "whole":
        return whole(int(least), None if most is None else int(most))
    if row["is_open"]:
        return Range(row["unit"], above=least, below=most)
    return Range(row["unit"], least=least, most=most)


def _field(check: Any, default: Any) -> Any:
    field: Any = Field(default=default)
    field.metadata.append(BeforeValidator(check))
    return field


def key(name: str, *, has_default: bool = False) -> Any:
    """The field of a key: its default, and a validator with its limits.

    A key of a record is required, unless `has_default` is set.
    """
    row = ROWS[name]
    check, default = _check_of(row), row["default"]
    if default is None:
        return _field(Optionally(check), None)
    is_required = "[]" in name and not has_default
    return _field(check, PydanticUndefined if is_required else default)


def limits(name: str) -> BeforeValidator:
    """The limits of a key, for a number within a list."""
    return BeforeValidator(_check_of(ROWS[name]))


def default_pair(name: str) -> tuple[Any, Any]:
    """The default of two numbers, of which each has a row."""
    return ROWS[f"{name}[0]"]["default"], ROWS[f"{name}[1]"]["default"]


def default_points(name: str) -> tuple[tuple[float, float], ...]:
    """The default of a list of points."""
    numbers = _LISTS[name][1]
    return tuple(zip(numbers[::2], numbers[1::2], strict=True))


def records(name: str, *, is_optional: bool = False) -> Any:
    """The field of a list of records."""
    most, _ = _LISTS[name]
    rows = [row for row in ROWS.values() if row["name"].startswith(f"{name}[].")]
    needed = ", ".join(row["name"].rpartition(".")[2] for row in rows if row["default"] is not None)
    check = from_list(f"a list of at most {most} tables {{{needed}}}", 0, most)
    return _field(Optionally(check), None) if is_optional else _field(check, ())

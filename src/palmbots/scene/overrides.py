# SPDX-License-Identifier: Apache-2.0
"""Overrides of scene keys: ``--set radio.loss=0.1``.

A key is dotted, and a value is written as in TOML. Shells remove quotes. A text that is not a TOML
value and does not begin like a list, table or quoted string is therefore a string; validation
refuses it for a key that needs a number.
"""

import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

from palmbots._types import SIDES
from palmbots._util.arguments import show
from palmbots.errors import SceneError
from palmbots.scene.core_keys import ROWS
from palmbots.scene.section import Section

_FORM = "KEY=VALUE with a dotted key and a TOML value, as in"
_EXAMPLES = 'radio.loss=0.1 or task.direction="backward"'


def parse_override(text: str, option: str = "--set", examples: str = _EXAMPLES) -> tuple[str, Any]:
    """The dotted key and the value of one ``KEY=VALUE``.

    Raises `SceneError` where there is no key, no value, or a value that TOML cannot read; the
    message names the option and gives the examples.
    """
    key, equals, written = text.partition("=")
    key, written = key.strip(), written.strip()
    allowed = f"allowed: {_FORM} {examples}"
    if not equals or not all(part.strip() for part in key.split(".")):
        raise SceneError(f"{option} {text}: is not of the form KEY=VALUE; {allowed}")
    if not written:
        raise SceneError(f"{option} {text}: the value is missing; {allowed}")
    return key, _value(written, f"{option} {text}", allowed)


def parse_overrides(texts: Iterable[str]) -> dict[str, Any]:
    """Many of them, as `load_scene` takes them.

    Raises `SceneError` where a key is given twice.
    """
    overrides: dict[str, Any] = {}
    given: set[str] = set()
    for text in texts:
        key, value = parse_override(text)
        for name in leaves(key, value):
            if name in given:
                raise _twice(name)
            given.add(name)
        if key in overrides:  # two tables with different keys
            if not (isinstance(value, Mapping) and isinstance(overrides[key], Mapping)):
                raise _twice(key)
            value = merged(overrides[key], value, f"{key}.", "--set")
        overrides[key] = value
    return overrides


def _twice(key: str) -> SceneError:
    return SceneError(f"--set {key}: is given twice; allowed: each key once")


def leaves(key: str, value: Any) -> dict[str, Any]:
    """What an override sets by dotted keys: more than one where the value is a table."""
    key = ".".join(part.strip() for part in key.split("."))
    if not isinstance(value, Mapping):
        return {key: value}
    found: dict[str, Any] = {}
    for inner, item in value.items():
        found |= leaves(f"{key}.{inner}", item)
    return found


def merged(
    data: Mapping[str, Any],
    overrides: Mapping[str, Any],
    inside: str = "",
    called: str = "overrides:",
) -> dict[str, Any]:
    """`data` with overrides: {"palm.left.friction": 0.4} or nested tables.

    Tables are merged, None removes a key, and other values replace the old ones; the arguments are
    not changed. Raises `SceneError` where an override needs a table but finds another value. The
    scene checks later whether the keys exist. `inside` is the dotted key of `data`, with a dot;
    `called` is what a message calls the overrides.
    """
    result = dict(data)
    for key, value in overrides.items():
        if not isinstance(key, str):
            raise SceneError(f"{called} {inside}{show(key)} is not a key; allowed: a dotted key")
        first, dot, rest = key.partition(".")
        if dot:
            value = {rest: value}
        if value is None:
            result.pop(first, None)
        elif isinstance(value, Mapping):
            table = result.get(first, {})
            if not isinstance(table, Mapping):
                raise SceneError(
                    f"{called} {inside}{key}: {inside}{first} is {show(table)}, which holds no "
                    "keys; allowed: a key inside a table"
                )
            result[first] = merged(table, value, f"{inside}{first}.", called)
        else:
            result[first] = value
    return result


SUPERSEDES = {
    "object": {
        "vertices_m": ("box_m", "edge_radius_m", "contacts", "com_m", "mass_kg"),
        "box_m": ("vertices_m", "edge_radius_m", "contacts", "com_m", "mass_kg"),
    },
    "palm": {"friction": ("friction_angle_deg",), "friction_angle_deg": ("friction",)},
}
"""An override of the first key (to this value) makes the other keys of its table obsolete in the
scene below it. The page follows the same table."""

SUPERSEDES["task.path"] = {
    "kind=straight": ("radius_m", "angle_deg", "turn", "transition_m", "lead_in_m", "waypoints_m",
                      "file"),
}  # fmt: skip
SUPERSEDES |= {f"palm.{side}": SUPERSEDES["palm"] for side in SIDES}


def without_superseded(
    data: Mapping[str, Any], overrides: Mapping[str, Any], called: str
) -> dict[str, Any]:
    """`data` without the keys that are obsolete once `overrides` are set.

    The centre of mass of an earlier outline is not that of a new one, and a friction coefficient
    and a friction angle exclude each other.
    """
    given = merged({}, overrides, called=called)
    obsolete: dict[str, Any] = {}
    for table, rules in SUPERSEDES.items():
        keys = _table_at(given, table)
        for rule, others in rules.items():
            key, _, value = rule.partition("=")
            if key in keys and value in ("", keys[key]):
                obsolete |= {f"{table}.{other}": None for other in others if other not in keys}
    return merged(data, obsolete) if obsolete else dict(data)


HOLDERS: dict[str, tuple[str, ...]] = {
    name.partition(".")[0]: row["holders"] for name, row in ROWS.items() if row["holders"]
}
"""The sections in which a side or a sender may override a key."""
_EITHER = ("friction", "friction_angle_deg")  # a side with one of them ignores both of the pair


def overriding(scene: Section, key: str) -> tuple[str, ...]:
    """The sides and senders with a value of their own for a key without a side."""
    section, _, name = key.partition(".")
    names = _EITHER if key.startswith("palm.") and name in _EITHER else (name,)
    found = []
    for holder in HOLDERS.get(section, ()):
        own = getattr(getattr(scene, section), holder)
        if any(getattr(own, one, None) is not None for one in names):
            found.append(holder)
    return tuple(found)


def refuse_without_effect(scene: Section, changes: Mapping[str, Any], called: str) -> None:
    """Raise `SceneError` for a change of a key without a side that both sides override, because
    it has no effect, unless `changes` also sets both overrides. `scene` has the changes already."""
    given = merged({}, changes)
    for section in HOLDERS:
        if not isinstance(given.get(section), Mapping):
            continue
        keys = {k for k, value in leaves(section, given[section]).items() if value is not None}
        for key in sorted(keys):
            own = overriding(scene, key)
            if has_no_effect(own) and not {key_of(key, one) for one in SIDES} <= keys:
                ones = " and ".join(key_of(key, one) for one in SIDES)
                raise SceneError(f"{called} {key}: both sides override it; allowed: {ones}")


def has_no_effect(overriding: tuple[str, ...]) -> bool:
    """Whether a key without a side has no effect, because both robots have values of their own.
    The station does not count: its value has a key of its own."""
    return set(SIDES) <= set(overriding)


def key_of(key: str, holder: str) -> str:
    """The key of a side or sender that overrides this one."""
    return key.replace(".", f".{holder}.", 1)


def _table_at(data: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    """The table at a dotted key; empty where there is none."""
    value: Any = data
    for part in key.split("."):
        value = value.get(part) if isinstance(value, Mapping) else None
    return value if isinstance(value, Mapping) else {}


def _value(written: str, called: str, allowed: str) -> Any:
    try:
        table = tomllib.loads(f"value = {written}")
    except (ValueError, RecursionError) as error:  # ValueError: integers too long for Python too
        if written[0] not in "[{\"'":
            return written
        reason = "is nested too deeply" if isinstance(error, RecursionError) else "is not TOML"
        raise SceneError(f"{called}: the value {reason}; {allowed}") from None
    if len(table) != 1:  # a line break in the value begins a second key
        raise SceneError(f"{called}: is more than one line; {allowed}")
    return table["value"]

"""Single keys of a scene set from outside: ``--set radio.loss=0.1``.

A key is dotted, a value is written as in TOML. Since a shell eats quotes, text that is no TOML
value and does not begin like a list, table or quoted string is taken as a string: a key that wants
a number will then say so.
"""

import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

from palmbots.errors import SceneError, show

__all__ = ["merged", "parse_override", "parse_overrides"]

_FORM = (
    "KEY=VALUE with a dotted key and a TOML value, "
    'as in radio.loss=0.1 or task.direction="backward"'
)


def parse_override(text: str) -> tuple[str, Any]:
    """The dotted key and the value of one ``KEY=VALUE``.

    Raises `SceneError` where there is no key, no value, or a value that TOML cannot read.
    """
    key, equals, written = text.partition("=")
    key, written = key.strip(), written.strip()
    if not equals or not all(part.strip() for part in key.split(".")):
        raise SceneError(f"--set {text}: is not of the form KEY=VALUE; allowed: {_FORM}")
    if not written:
        raise SceneError(f"--set {text}: the value is missing; allowed: {_FORM}")
    return key, _value(written, text)


def parse_overrides(texts: Iterable[str]) -> dict[str, Any]:
    """Many of them, for `load_scene`; of a key that comes twice the last one counts."""
    return dict(parse_override(text) for text in texts)


def merged(
    data: Mapping[str, Any],
    overrides: Mapping[str, Any],
    inside: str = "",
    called: str = "overrides:",
) -> dict[str, Any]:
    """`data` with the overrides put in: {"palm.left.friction": 0.4} or nested tables.

    Tables are merged, None takes a key away, anything else is replaced; the arguments stay as they
    are. Raises `SceneError` where an override is to go into something that is no table; which keys
    there may be is for the scene to say. `inside` is the dotted key of `data`, with a dot; `called`
    is what a message calls the overrides.
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


def _value(written: str, text: str) -> Any:
    try:
        table = tomllib.loads(f"value = {written}")
    except (ValueError, RecursionError) as error:  # ValueError: integers too long for Python too
        if written[0] not in "[{\"'":
            return written
        reason = "is nested too deeply" if isinstance(error, RecursionError) else "is not TOML"
        raise SceneError(f"--set {text}: the value {reason}; allowed: {_FORM}") from None
    if len(table) != 1:  # a line break made more than one key of it
        raise SceneError(f"--set {text}: is more than one line; allowed: {_FORM}")
    return table["value"]

# SPDX-License-Identifier: Apache-2.0
"""What JSON has of a result: its fields, and its derived values.

A dataclass becomes a table with a key for each field, except those with the metadata `NOT_IN_JSON`
(traces, arrays, whatever else is large or no value), and for each `derived` property. Numbers that
are NaN or infinite become null; `palmbots._types.MaybeNaN` marks where they may be.
"""

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

NOT_IN_JSON = {"json": False}
"""Metadata of a field that JSON does not have: ``field(metadata=NOT_IN_JSON)``."""


class derived(property):  # used like property
    """A property that JSON has, too."""


@cache
def keys_of(kind: Any) -> tuple[str, ...]:
    """The keys that JSON has of a dataclass or named tuple: fields, derived values, the scene."""
    if not is_dataclass(kind):
        return kind._fields
    own = [field.name for field in fields(kind) if field.metadata.get("json", True)]
    further = [
        name
        for base in reversed(kind.__mro__)
        for name, member in vars(base).items()
        if isinstance(member, derived)
    ]
    keys = dict.fromkeys([*own, *further])
    return tuple(sorted(keys, key=lambda key: key == "scene"))  # last: it is long


def plain(value: Any) -> Any:
    """A value as JSON has it: tables, lists, texts, finite numbers, true, false and null."""
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if is_dataclass(type(value)) or hasattr(value, "_fields"):
        return {key: plain(getattr(value, key)) for key in keys_of(type(value))}
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, tuple | list):
        return [plain(inner) for inner in value]
    if hasattr(value, "model_dump"):  # a scene, or a table of one
        return value.model_dump()
    if hasattr(value, "tolist"):  # a NumPy array, or a number of its own
        return plain(value.tolist())
    return str(value)  # a path

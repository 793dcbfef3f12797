# SPDX-License-Identifier: Apache-2.0
"""What a study varies: one axis for each scene key, with the values that the key takes.

A key is dotted, as in ``--set``; ``object.com_m[0]`` is one number of a list. An axis is a list of
values, or a range {from, to} with a linear or logarithmic scale. Computed numbers are rounded to
twelve digits, so 0.1 + 0.2 reads as 0.3, and the last bit of a library function cannot change a
design.
"""

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, ValidationError, model_validator

from palmbots._util.arguments import show, with_lists
from palmbots.scene.fields import Range, field_error, whole
from palmbots.scene.section import Section
from palmbots.scene.variations import ENTRY

_MAX_LEVELS = 100_000


class Span(Section):
    """A range of numbers, including both ends."""

    start: Annotated[float, BeforeValidator(Range(least=-1e9, most=1e9))]
    stop: Annotated[float, BeforeValidator(Range(least=-1e9, most=1e9))]
    steps: Annotated[int, BeforeValidator(whole(2, _MAX_LEVELS))] | None = None
    """The number of values in a grid."""
    scale: Literal["linear", "log"] = "linear"

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.stop <= self.start:
            raise field_error(self.stop, "is not more than from", f"more than {self.start:g}", "to")
        if self.scale == "log" and self.start <= 0:
            raise field_error(self.start, "has no logarithm", "more than 0 with scale log", "from")
        return self

    def at(self, share: float) -> float:
        """The number at a share of the range: 0 is the start, 1 the end."""
        if self.scale == "log":
            value = self.start * math.exp(share * math.log(self.stop / self.start))
        else:
            value = self.start + share * (self.stop - self.start)
        return float(f"{value:.12g}")


Levels = tuple[Any, ...]
Axis = Levels | Span
"""The values of a key one by one, or a range of them."""

_SPAN_KEYS = {"from": "start", "to": "stop", "steps": "steps", "scale": "scale"}
_SPELLING = {field: key for key, field in _SPAN_KEYS.items()}


def axes_of(table: object) -> dict[str, Axis]:
    """The axes of the table ``vary`` by dotted key; tables in it may be nested or dotted.

    Raises the error of `field_error` for an invalid axis.
    """
    if not isinstance(table, Mapping):
        raise field_error(table, "is not a table", "a table {key = [values]} or {key = {from, to}}")
    pairs = _flat(table, "")
    axes = dict(pairs)
    for name, _ in pairs:
        entry = ENTRY.fullmatch(name)
        if entry and entry[1] in axes:
            raise field_error(entry[1], f"is given beside {name}", "the list or its entries", name)
        if sum(name == other for other, _ in pairs) > 1:
            raise field_error(name, "is given twice", "each key once", name)
    return axes


def _flat(table: Mapping[Any, Any], prefix: str) -> list[tuple[str, Axis]]:
    pairs: list[tuple[str, Axis]] = []
    for key, value in table.items():
        name = f"{prefix}{key}"
        if isinstance(value, Mapping) and not value:
            raise field_error(value, "is empty", "a list of values, or a range {from, to}", name)
        if isinstance(value, Span):
            pairs.append((name, value))
        elif isinstance(value, Mapping) and not {"from", "to"} & set(value):
            pairs += _flat(value, f"{name}.")
        elif isinstance(value, Mapping):
            pairs.append((name, _span(name, value)))
        else:
            pairs.append((name, _levels(name, value)))
    return pairs


def _span(name: str, table: Mapping[Any, Any]) -> Span:
    for key in table:
        if key not in _SPAN_KEYS:
            raise field_error(key, "is an unknown key of a range", ", ".join(_SPAN_KEYS), name)
    for key in ("from", "to"):
        if key not in table:
            raise field_error(dict(table), f"has no {key}", "{from, to} with steps or scale", name)
    try:
        return Span.model_validate({_SPAN_KEYS[key]: value for key, value in table.items()})
    except ValidationError as error:
        first: Any = error.errors(include_url=False)[0]
        context = first.get("ctx", {})
        inner = ".".join(str(_SPELLING.get(step, step)) for step in first["loc"])
        key = ".".join(part for part in (name, inner, context.get("key", "")) if part)
        if first["type"] == "scene":
            value = table.get(context["key"], first["input"])
            raise field_error(value, context["problem"], context["allowed"], key) from None
        allowed = context.get("expected", first["msg"])
        raise field_error(first["input"], "is not known", allowed, key) from None


def _levels(name: str, value: object) -> Levels:
    allowed = f"a list of 1 to {_MAX_LEVELS} values, or a range {{from, to}}"
    value = with_lists(value)
    if not isinstance(value, list | tuple):
        raise field_error(value, "is neither a list nor a range", allowed, name)
    if not 1 <= len(value) <= _MAX_LEVELS:
        raise field_error(value, f"has {len(value)} values", allowed, name)
    texts: set[str] = set()
    for one in value:
        text = repr(float(one) if isinstance(one, int | float) else one)
        if text in texts:
            raise field_error(value, f"has {show(one)} twice", "each value once", name)
        texts.add(text)
    return tuple(value)

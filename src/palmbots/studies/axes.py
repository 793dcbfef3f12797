"""What a study varies: one scene key an axis, with the values that it may take.

A key is dotted, as in ``--set``; ``object.com_m[0]`` is one number of a list. An axis lists values,
or is a range {from, to} with a linear or logarithmic scale. Numbers that are worked out are rounded
to twelve digits, so that 0.1 + 0.2 reads as 0.3 and no library's last bit gets into a design.
"""

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, model_validator

from palmbots.errors import show
from palmbots.quantities import Range, fault, whole
from palmbots.scene_at import ENTRY
from palmbots.section import Section

__all__ = ["Axis", "Levels", "Span", "axes_of"]

_MOST_LEVELS = 100_000


class Span(Section):
    """A range of numbers, ends included."""

    start: Annotated[float, BeforeValidator(Range(least=-1e9, most=1e9))]
    stop: Annotated[float, BeforeValidator(Range(least=-1e9, most=1e9))]
    steps: Annotated[int, BeforeValidator(whole(2, _MOST_LEVELS))] | None = None
    """How many values a grid takes of it."""
    scale: Literal["linear", "log"] = "linear"

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.stop <= self.start:
            raise fault(self.stop, "is not more than from", f"more than {self.start:g}", "to")
        if self.scale == "log" and self.start <= 0:
            raise fault(self.start, "has no logarithm", "more than 0 with scale log", "from")
        return self

    def at(self, share: float) -> float:
        """The number at 0 (the start) to 1 (the end) of the range."""
        if self.scale == "log":
            value = self.start * math.exp(share * math.log(self.stop / self.start))
        else:
            value = self.start + share * (self.stop - self.start)
        return float(f"{value:.12g}")


Levels = tuple[Any, ...]
Axis = Levels | Span
"""The values of a key one by one, or a range of them."""


def axes_of(table: object) -> dict[str, Axis]:
    """The axes of the table ``vary``, by dotted key, whether nested or dotted in the file.

    Raises the fault of `palmbots.quantities` for an axis that makes no sense.
    """
    if not isinstance(table, Mapping):
        raise fault(table, "is not a table", "a table {key = [values]} or {key = {from, to}}")
    pairs = _flat(table, "")
    found = dict(pairs)
    for name, _ in pairs:
        entry = ENTRY.fullmatch(name)
        if entry and entry[1] in found:
            raise fault(entry[1], f"is given beside {name}", "the list or its entries", name)
        if sum(name == other for other, _ in pairs) > 1:
            raise fault(name, "is given twice", "each key once", name)
    return found


def _flat(table: Mapping[Any, Any], inside: str) -> list[tuple[str, Axis]]:
    found: list[tuple[str, Axis]] = []
    for key, value in table.items():
        name = f"{inside}{key}"
        if isinstance(value, Mapping) and not value:
            raise fault(value, "is empty", "a list of values, or a range {from, to}", name)
        if isinstance(value, Span):
            found.append((name, value))
        elif isinstance(value, Mapping) and not {"from", "to"} & set(value):
            found += _flat(value, f"{name}.")
        elif isinstance(value, Mapping):
            found.append((name, _span(name, value)))
        else:
            found.append((name, _levels(name, value)))
    return found


def _span(name: str, table: Mapping[Any, Any]) -> Span:
    known = {"from": "start", "to": "stop", "steps": "steps", "scale": "scale"}
    for key in table:
        if key not in known:
            raise fault(key, "is an unknown key of a range", "from, to, steps, scale", name)
    for key in ("from", "to"):
        if key not in table:
            raise fault(dict(table), f"has no {key}", "{from, to} with steps or scale", name)
    try:
        return Span.model_validate({known[key]: value for key, value in table.items()})
    except ValueError as error:
        first: Any = error.errors(include_url=False)[0]  # type: ignore[attr-defined]
        told = first.get("ctx", {})
        spelt = {"start": "from", "stop": "to"}
        inner = ".".join(str(spelt.get(step, step)) for step in first["loc"])
        below = ".".join(part for part in (name, inner, told.get("key", "")) if part)
        if first["type"] == "scene":
            given = table.get(told["key"], first["input"])
            raise fault(given, told["problem"], told["allowed"], below) from None
        allowed = told.get("expected", first["msg"])
        raise fault(first["input"], "is not known", allowed, below) from None


def _levels(name: str, value: object) -> Levels:
    allowed = f"a list of 1 to {_MOST_LEVELS} values, or a range {{from, to}}"
    if not isinstance(value, list | tuple):
        raise fault(value, "is neither a list nor a range", allowed, name)
    if not 1 <= len(value) <= _MOST_LEVELS:
        raise fault(value, f"has {len(value)} values", allowed, name)
    seen: set[str] = set()
    for one in value:
        plain = repr(float(one) if isinstance(one, int | float) else one)
        if plain in seen:
            raise fault(value, f"has {show(one)} twice", "each value once", name)
        seen.add(plain)
    return tuple(value)

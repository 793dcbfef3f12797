# SPDX-License-Identifier: Apache-2.0
"""Types of scene keys (numbers with a unit and limits, names, lists), and their error messages.

Validation is strict: a number is an int or a float (also of NumPy), never a bool or a string. The
limits are wide enough for any robot of this kind. They catch lengths in millimetres, angles in the
wrong unit, NaN, infinity and negative lengths.

Numbers become plain floats, so that equal scenes print alike.
"""

import math
import numbers
import os
from dataclasses import dataclass
from datetime import date, datetime, time
from typing import Annotated, Any

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from palmbots._util.arguments import show
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError

KINDS = {
    "boolean": "a boolean",
    "string": "a string",
    "whole": "a whole number",
    "number": "a number",
    "list": "a list",
    "table": "a table",
    "empty": "empty",
    "date": "a date",
    "time": "a time",
}
"""The kinds of a value, in the terms of TOML."""

PROBLEMS = {
    "kind": "is {kind}, not {wanted}",
    "infinite": "is not finite",
    "small": "is too small",
    "large": "is too large",
    "unknown": "is not known",
    "string": "is not a string",
    "table": "is not a table",
    "key": "is the value of an unknown key",
    "item": "has 1 item",
    "items": "has {count} items",
    "missing": "is missing; this table requires {keys}",
}
"""What may be wrong with a value, apart from other values. The page uses the same words."""


def field_error(value: object, problem: str, allowed: str, key: str = "") -> PydanticCustomError:
    """The error that a validator raises: "`key`: `value` `problem`; allowed: `allowed`".

    `key` is relative to the model or field that is validated; empty means the model itself.
    """
    context: dict[str, Any] = {
        "key": key,
        "value": show(value),
        "problem": problem,
        "allowed": allowed,
    }
    return PydanticCustomError("scene", "{value} {problem}; allowed: {allowed}", context)


def file_name(value: object) -> str:
    """The name of a file, which means the same in every folder."""
    allowed = "the name of a file"
    if not isinstance(value, str):
        raise _wrong_kind(value, "string", allowed)
    if not value or "\0" in value:
        raise field_error(value, "is no name", allowed)
    try:
        return os.path.abspath(user_path(value))
    except PalmbotsError:
        raise field_error(value, "is an address", "a file of this machine") from None


FileName = Annotated[str, BeforeValidator(file_name)]
"""The name of a file; a scene has it as an absolute path."""


@dataclass(frozen=True)
class Range:
    """The numbers that a key may have: from `least` to `most`, or between `above` and `below`."""

    unit: str = ""
    above: float | None = None
    least: float | None = None
    most: float | None = None
    below: float | None = None

    @property
    def allowed(self) -> str:
        """The limits in words."""
        words = [f"a number in {self.unit}" if self.unit else "a number"]
        if self.least is not None and self.most is not None:
            words.append(f"from {self.least:g} to {self.most:g}")
        else:
            limits = {
                "more than": self.above,
                "at least": self.least,
                "at most": self.most,
                "less than": self.below,
            }
            given = [f"{word} {at:g}" for word, at in limits.items() if at is not None]
            words.append(" and ".join(given))
        return ", ".join(words)

    def __call__(self, value: object) -> float:
        """The value as a float, if it is a number within the limits."""
        if isinstance(value, bool) or not isinstance(value, numbers.Real):
            raise _wrong_kind(value, "number", self.allowed)
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise field_error(value, PROBLEMS["infinite"], self.allowed)
        low = (self.above is not None and number <= self.above) or (
            self.least is not None and number < self.least
        )
        high = (self.below is not None and number >= self.below) or (
            self.most is not None and number > self.most
        )
        if low or high:
            raise field_error(value, PROBLEMS["small" if low else "large"], self.allowed)
        return number + 0.0  # −0.0 becomes 0.0: it would show in the bits of a mirrored scene


@dataclass(frozen=True)
class whole:
    """A validator for whole numbers from `least` to `most`."""

    least: int
    most: int | None = None

    @property
    def allowed(self) -> str:
        """The limits in words."""
        if self.most is None:
            return f"a whole number, at least {self.least}"
        return f"a whole number, from {self.least} to {self.most}"

    def __call__(self, value: object) -> int:
        """The value as an int, if it is a whole number within the limits."""
        allowed = self.allowed
        if isinstance(value, bool) or not isinstance(value, numbers.Integral):
            raise _wrong_kind(value, "whole", allowed)
        number = int(value)
        low = number < self.least
        if low or (self.most is not None and number > self.most):
            raise field_error(value, PROBLEMS["small" if low else "large"], allowed)
        return number


@dataclass(frozen=True)
class OneOf:
    """A validator for one of several names."""

    names: tuple[str, ...]

    @property
    def allowed(self) -> str:
        """The names, quoted."""
        quoted = [f"'{name}'" for name in self.names]
        return f"{', '.join(quoted[:-1])} or {quoted[-1]}"

    def __call__(self, value: object) -> str:
        """The value, if it is one of the names."""
        if not isinstance(value, str) or value not in self.names:
            raise field_error(value, PROBLEMS["unknown"], self.allowed)
        return value


SWITCH = "true or false"


def is_switch(value: object) -> bool:
    """The value, if it is true or false."""
    if not isinstance(value, bool):
        raise _wrong_kind(value, "boolean", SWITCH)
    return value


def _wrong_kind(value: object, wanted: str, allowed: str) -> PydanticCustomError:
    """The error about a value whose kind is not `wanted`."""
    kinds: dict[type, str] = {
        bool: "boolean",
        str: "string",
        int: "whole",
        float: "number",
        list: "list",
        tuple: "list",
        dict: "table",
        type(None): "empty",
        date: "date",
        datetime: "date",
        time: "time",
    }
    kind = kinds.get(type(value))
    words = KINDS[kind] if kind else f"of type {type(value).__name__}"
    problem = PROBLEMS["kind"].format(kind=words, wanted=KINDS[wanted])
    return field_error(value, problem, allowed)


@dataclass(frozen=True)
class from_list:
    """A validator that turns a list (or tuple) of `least` to `most` items into a tuple."""

    allowed: str
    least: int = 0
    most: int | None = None

    def __call__(self, value: object) -> Any:
        """The value as a tuple, if it is a list with so many items."""
        if not isinstance(value, list | tuple):
            raise _wrong_kind(value, "list", self.allowed)
        count = len(value)
        if count < self.least or (self.most is not None and count > self.most):
            problem = PROBLEMS["item" if count == 1 else "items"].format(count=count)
            raise field_error(value, problem, self.allowed)
        return tuple(value)


@dataclass(frozen=True)
class OneOrList:
    """A validator for one value, or for a list of such values."""

    one: Range
    many: from_list

    @property
    def unit(self) -> str:
        """That of one value."""
        return self.one.unit

    @property
    def allowed(self) -> str:
        """The limits in words."""
        return f"{self.one.allowed}, or a list of such numbers"

    def __call__(self, value: object) -> Any:
        """What `one` makes of the value or, as a tuple, of each item of a list."""
        if not isinstance(value, list | tuple):
            return self.one(value)
        return tuple(self.one(item) for item in self.many(value))


Switch = Annotated[bool, BeforeValidator(is_switch)]
Size = Annotated[float, BeforeValidator(Range("m", least=0.001, most=10))]
Extent = Annotated[float, BeforeValidator(Range("m", least=0, most=10))]

# SPDX-License-Identifier: Apache-2.0
"""Checks of arguments, and the form in which messages quote values.

Every refusal is a `PalmbotsError` of one line: the key, the value, and what is allowed.
"""

import difflib
import operator
from collections.abc import Mapping
from typing import Any

from palmbots._util.toml_writer import toml_value
from palmbots.errors import PalmbotsError, one_line

LONGEST_VALUE = 60
"""Characters of a value that a message quotes."""


def show(value: object) -> str:
    """A value as messages quote it: short, on one line, in TOML where possible."""
    if value is None:
        return "null"
    try:
        text = toml_value(value)
    except (Exception, SystemExit):  # a repr() may do anything; int's refuses very long numbers
        text = f"<{type(value).__name__}>"
    text = one_line(text)
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 1] + "…"


def shown(value: object) -> str:
    """The same for a value of a program in Python, where nothing is None."""
    return "None" if value is None else show(value)


def with_lists(value: Any) -> Any:
    """The value with lists in place of NumPy's arrays, in tables, too."""
    if isinstance(value, Mapping):
        return {key: with_lists(inner) for key, inner in value.items()}
    return value.tolist() if getattr(value, "ndim", 0) else value


def one_of(key: str, value: object, legal: tuple[str, ...]) -> None:
    """Raise `PalmbotsError` with the legal values unless the value is one of them."""
    if value not in legal:
        near = difflib.get_close_matches(str(value), legal, n=1)
        hint = f"did you mean {near[0]}? " if near else ""
        raise PalmbotsError(f"{key}: value is {show(value)}; {hint}allowed: {', '.join(legal)}")


def whole_number(key: str, value: Any, least: int, most: int, allowed: str = "") -> int:
    """The value as an int; accepts NumPy's integers, too.

    Raises `PalmbotsError` with the allowed values for other types and outside the limits.
    """
    try:
        number = None if isinstance(value, bool) else operator.index(value)
    except TypeError:
        number = None
    if number is None or not least <= number <= most:
        raise PalmbotsError(
            f"{key}: value is {show(value)}; allowed: {allowed or f'{least} to {most}'}"
        )
    return number


def two_numbers(key: str, value: Any, allowed: str = "two numbers") -> tuple[float, float]:
    """A pair of numbers, also NaN; raises `PalmbotsError` for anything else."""
    try:
        one, other = value
        return float(0.0 + one), float(0.0 + other)  # text is no number
    except (TypeError, ValueError):
        raise PalmbotsError(f"{key}: value is {show(value)}; allowed: {allowed}") from None


def ordered_pair(
    key: str, value: Any, least: float, most: float, *, differ: bool = False
) -> tuple[float, float]:
    """The ends of an interval within these limits; with `differ`, its length is not 0.

    Raises `PalmbotsError` for anything else.
    """
    allowed = f"two numbers, the lower one first, from {least:g} to {most:g}"
    low, high = two_numbers(key, value, allowed)
    if not least <= low <= high <= most or (differ and low == high):
        raise PalmbotsError(f"{key}: value is {show([low, high])}; allowed: {allowed}")
    return low, high


def seed_of(value: object) -> int:
    """The seed of a carry; raises `PalmbotsError` if the value is not a valid seed."""
    return whole_number("seed", value, 0, 2**64 - 1, "a whole number from 0 to 2^64-1")

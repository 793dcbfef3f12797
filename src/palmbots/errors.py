"""What palmbots raises on purpose: one clear line, meant to be shown to the user as it is.

A message about input names the file, the key, the value and what would have been allowed. Whatever
text goes into it (file names, keys, values) comes from outside, so control characters and the like
are escaped: a message is always one line that any terminal and any encoding can print.
"""

import difflib
import operator

from palmbots.toml_text import toml_value

__all__ = [
    "PalmbotsError",
    "SceneError",
    "one_line",
    "one_of",
    "seed_of",
    "show",
    "two_numbers",
    "whole_number",
]

_LONGEST_VALUE = 60


class PalmbotsError(Exception):
    """Something the user can put right; ``str(error)`` is one line and the whole story."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


class SceneError(PalmbotsError):
    """A scene that cannot be read or makes no sense."""


def one_line(text: str) -> str:
    """The text with everything unprintable (line breaks, lone surrogates, …) escaped."""
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape", "backslashreplace").decode()
        for c in text
    )


def show(value: object) -> str:
    """A value as a message quotes it: short, on one line, spelt as in TOML where it can be."""
    if value is None:
        return "null"
    try:
        text = toml_value(value)
    except Exception:  # a repr() may do anything; int's own refuses very long numbers
        text = f"<{type(value).__name__}>"
    text = one_line(text)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 1] + "…"


def one_of(key: str, value: object, legal: tuple[str, ...]) -> None:
    """Raise `PalmbotsError`, saying what is allowed, unless the value is one of the legal ones."""
    if value not in legal:
        near = difflib.get_close_matches(str(value), legal, n=1)
        hint = f"did you mean {near[0]}? " if near else ""
        raise PalmbotsError(f"{key}: value is {show(value)}; {hint}allowed: {', '.join(legal)}")


def whole_number(key: str, value: object, least: int, most: int, allowed: str = "") -> int:
    """The value as an int, also of one of NumPy's whole numbers.

    Raises `PalmbotsError`, saying what is allowed, for anything else and beyond the limits.
    """
    try:
        number = None if isinstance(value, bool) else operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        number = None
    if number is None or not least <= number <= most:
        raise PalmbotsError(
            f"{key}: value is {show(value)}; allowed: {allowed or f'{least} to {most}'}"
        )
    return number


def two_numbers(key: str, value: object) -> tuple[float, float]:
    """The ends of an interval, in the order given, NaN and all.

    Raises `PalmbotsError` for anything but a pair of numbers: a single one is easily given.
    """
    try:
        low, high = value  # type: ignore[misc]
        return float(low), float(high)
    except (TypeError, ValueError):
        raise PalmbotsError(
            f"{key}: value is {show(value)}; allowed: two numbers, the lower one first"
        ) from None


def seed_of(value: object) -> int:
    """The seed of a carry; raises `PalmbotsError` where it is none."""
    return whole_number("seed", value, 0, 2**64 - 1, "a whole number from 0 to 2^64-1")

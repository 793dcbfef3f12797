# SPDX-License-Identifier: Apache-2.0
"""Numbers and nouns as text."""

from typing import Any

__all__ = ["format_number", "millimetres", "plural"]


def plural(n: int, noun: str) -> str:
    """A number with its noun: 1 correction, 2 corrections, 2 carries."""
    many = f"{noun[:-1]}ies" if noun.endswith("ry") else f"{noun}s"
    return f"{n} {noun if n == 1 else many}"


def format_number(value: Any) -> str:
    """A value as text: a number with as few digits as identify it."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return short if float(short := f"{value:g}") == value else repr(value)


def millimetres(metres: float) -> str:
    """A length as text: 12.3 mm."""
    return f"{round(1e3 * metres, 1) + 0.0:.1f} mm"  # + 0.0: no "-0.0"

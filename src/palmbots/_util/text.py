# SPDX-License-Identifier: Apache-2.0
"""Numbers and nouns as text."""

import math
import string
from typing import Any


def plural(n: int, noun: str) -> str:
    """A number with its noun: 1 correction, 2 corrections, 2 carries, 2 stretches."""
    return f"{n} {noun if n == 1 else many(noun)}"


def many(noun: str) -> str:
    """The plural of a noun: corrections, carries, studies, stretches."""
    if noun.endswith(("ry", "dy")):
        return f"{noun[:-1]}ies"
    return f"{noun}es" if noun.endswith("ch") else f"{noun}s"


def format_number(value: Any) -> str:
    """A value as text: a number with as few digits as identify it."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return short if float(short := f"{value:g}") == value else repr(value)


def millimetres(metres: float) -> str:
    """A length as text: 12.3 mm."""
    return f"{round(1e3 * metres, 1) + 0.0:.1f} mm"  # + 0.0: no "-0.0"


def duration(seconds: float) -> str:
    """A time as text, in the largest unit of which it has one and a half: 90.0 s, 2.5 h."""
    for factor, unit in ((86400, "days"), (3600, "h"), (60, "min")):
        if seconds >= 1.5 * factor:
            return f"{seconds / factor:.1f} {unit}"
    return f"{seconds:.1f} s"


def data_size(n: int) -> str:
    """A number of bytes as text: 33 B, 12 kB, 3.4 MB."""
    for factor, unit in ((1e9, "GB"), (1e6, "MB")):
        if n >= factor:
            return f"{n / factor:.1f} {unit}"
    return f"{n / 1e3:.0f} kB" if n >= 1000 else f"{n:.0f} B"


def letter_label(index: int) -> str:
    """A … Z, AA, AB, …: the labels of Figure 8, counted from 0."""
    text = ""
    index += 1
    while index > 0:
        index, digit = divmod(index - 1, 26)
        text = string.ascii_uppercase[digit] + text
    return text


def rounded_up(value: float, digits: int) -> float:
    """The next number with so many digits behind the point, as a least value to allow."""
    return math.ceil(value * 10**digits) / 10**digits if math.isfinite(value) else value


def rounded_down(value: float, digits: int) -> float:
    """The same below, as a largest value to allow."""
    return math.floor(value * 10**digits) / 10**digits if math.isfinite(value) else value

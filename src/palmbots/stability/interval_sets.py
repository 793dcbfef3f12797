# SPDX-License-Identifier: Apache-2.0
"""Unions of intervals with exact ends, on which a condition holds along one quantity.

The ends are roots of the forms of `linear_conditions`, polynomials of degree at most two in the
quantity. Between two neighbouring roots no condition changes, so the middle decides for the piece.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

Interval = tuple[float, float]

VARIABLE = np.array([0.0, 1.0, -1.0])
"""Replaces a number in a form: its values at these three points determine its polynomial."""


def real_roots(values: Any) -> Iterator[float]:
    """The real roots of a quadratic polynomial given at `VARIABLE`; none for a plain number."""
    if np.ndim(values) == 0:
        return
    c, above, below = (float(value) for value in values)
    b = 0.5 * (above - below)
    a = 0.5 * (above + below) - c
    if abs(a) <= 4 * math.ulp(max(abs(above), abs(below), abs(c))):  # rounding
        if b != 0:
            yield -c / b
        return
    discriminant = b * b - 4 * a * c
    if discriminant < 0:
        return
    q = -0.5 * (b + math.copysign(math.sqrt(discriminant), b))
    yield q / a
    if q != 0:
        yield c / q


def where(
    candidates: Iterable[float], domain: Interval, holds: Callable[[float], bool]
) -> tuple[Interval, ...]:
    """The intervals of the domain on which `holds`, which changes only at the candidates."""
    low, high = domain
    inside = sorted({c for c in candidates if low < c < high})
    pieces: list[Interval] = []
    for start, end in pairwise([low, *inside, high]):
        if not holds(0.5 * (start + end)):
            continue
        if pieces and pieces[-1][1] == start:
            pieces[-1] = (pieces[-1][0], end)
        else:
            pieces.append((start, end))
    return tuple(pieces)


def around(pieces: Iterable[Interval], value: float) -> Interval | None:
    """The interval that contains a value; None: there is none."""
    return next((piece for piece in pieces if piece[0] <= value <= piece[1]), None)


def shifted(interval: Interval, by: float) -> Interval:
    """The interval, moved."""
    return interval[0] + by, interval[1] + by


def intersection(intervals: Iterable[Interval]) -> Interval | None:
    """The intersection of all intervals; None: it is empty."""
    lows, highs = zip(*intervals, strict=True)
    low, high = max(lows), min(highs)
    return (low, high) if low <= high else None

# SPDX-License-Identifier: Apache-2.0
"""Where a point lies in a polygon, in rational numbers."""

from collections.abc import Sequence
from fractions import Fraction

Exact = tuple[Fraction, Fraction]


def exact(point: Sequence[float]) -> Exact:
    """A point in rational numbers."""
    return Fraction(point[0]), Fraction(point[1])


def place_in(point: Sequence[float], polygon: Sequence[Sequence[float]]) -> int:
    """+1 inside, 0 on the boundary, −1 outside.

    A ray straight up meets the edges at some heights.
    """
    x, y = exact(point)
    ring = [exact(p) for p in polygon]
    above = 0
    for k, (ax, ay) in enumerate(ring):
        bx, by = ring[k - 1]
        if ax == bx:
            if x == ax and min(ay, by) <= y <= max(ay, by):
                return 0
            continue
        if not min(ax, bx) <= x <= max(ax, bx):
            continue
        height = ay + (by - ay) * (x - ax) / (bx - ax)
        if height == y:
            return 0
        above += height > y and x != max(ax, bx)
    return 1 if above % 2 else -1

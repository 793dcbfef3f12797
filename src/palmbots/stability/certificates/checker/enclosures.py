# SPDX-License-Identifier: Apache-2.0
"""Exact enclosures of sine, cosine and square root, in rational numbers.

Every function returns two numbers that enclose the true value, or rounds it to a given side. Only
+ − × ÷ of fractions are used. Results are rounded outward to a grid, which keeps the numbers short.
"""

from fractions import Fraction
from functools import lru_cache
from math import isqrt

F = Fraction
Ends = tuple[Fraction, Fraction]

_GRID = 10**24  # results are multiples of 1/_GRID


def down(x: Fraction) -> Fraction:
    """Rounded down to the grid."""
    return F((x * _GRID).__floor__(), _GRID)


def up(x: Fraction) -> Fraction:
    """Rounded up to the grid."""
    return F((x * _GRID).__ceil__(), _GRID)


def _arctan_of_inverse(n: int, terms: int) -> Ends:
    """1/n − 1/(3n³) + …: the sum alternates, so two neighbouring sums enclose the value."""
    total, sums = F(0), []
    for k in range(terms):
        total += F((-1) ** k, (2 * k + 1) * n ** (2 * k + 1))
        sums.append(total)
    return min(sums[-2:]), max(sums[-2:])


def _pi() -> Ends:
    a, b = _arctan_of_inverse(5, 24), _arctan_of_inverse(239, 8)  # Machin
    return down(16 * a[0] - 4 * b[1]), up(16 * a[1] - 4 * b[0])


_PI = _pi()


def _sine(x: Fraction) -> Ends:
    """For 0 ≤ x ≤ 1.6: the Taylor terms alternate and shrink."""
    term, total, k = x, x, 1
    while term > F(1, _GRID):  # rounded up it never gets below that
        term = up(term * x * x / ((k + 1) * (k + 2)))
        # Rounding the term up moves the sum by no more than one step of the grid.
        total += -term if k % 4 == 1 else term
        k += 2
    slack = term + F(k, _GRID)
    return down(total - slack), up(total + slack)


@lru_cache(maxsize=4096)  # a part of a box has most of its ends in common with others
def sine_of_degrees(degrees: Fraction) -> Ends:
    """Encloses sin of −90° to 90°."""
    size = abs(degrees)
    low = _sine(_PI[0] * size / 180)[0]
    high = _sine(_PI[1] * size / 180)[1]
    return (low, high) if degrees >= 0 else (-high, -low)


def cosine_of_degrees(degrees: Fraction) -> Ends:
    """Encloses cos of −90° to 90°."""
    return sine_of_degrees(90 - abs(degrees))


def root(x: Fraction, upward: bool) -> Fraction:
    """√x rounded to the grid, down or up."""
    scaled = x * _GRID * _GRID
    whole = isqrt(scaled.__floor__())
    if not upward:
        return F(whole, _GRID)
    return F(whole + 2, _GRID)  # √ of the part cut off adds less than 1, the floor less than 1

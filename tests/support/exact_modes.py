# SPDX-License-Identifier: Apache-2.0
"""Contact modes of rational contacts, decided without rounding.

A mode is possible if some twist of the body satisfies equations and strict inequalities, and in
balance unless, by Farkas' lemma, some vector is on one side of every ray of its wrench cone and on
the other side of the load. Both are systems with few unknowns, from which Fourier and Motzkin's
method eliminates one unknown after the other, in integers. Shares nothing with the core.
"""

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import product
from typing import NamedTuple

MOTIONS = ("ST", "SL", "SR", "BR")

Vector = tuple[Fraction, Fraction]
Row = tuple[int, ...]  # a · x against its last number

ZERO = Fraction(0)


class ExactContact(NamedTuple):
    """As SurfaceContact, in rational numbers; the normal has any length."""

    surface: str
    point: Vector
    normal: Vector
    friction: Fraction
    velocity: Vector = (ZERO, ZERO)

    @property
    def to_left(self) -> Vector:
        return -self.normal[1], self.normal[0]

    def wrench(self, force: Vector) -> list[Fraction]:
        (x, y), (fx, fy) = self.point, force
        return [fx, fy, x * fy - y * fx]

    def edge(self, sign: int) -> list[Fraction]:
        """The wrench of a force with friction to the left (+1) or right (−1), at its limit."""
        (nx, ny), (tx, ty), mu = self.normal, self.to_left, sign * self.friction
        return self.wrench((nx + mu * tx, ny + mu * ty))


def whole(row: Iterable[Fraction]) -> Row:
    """A positive multiple of the row, in small integers."""
    parts = list(row)
    scale = math.lcm(*(p.denominator for p in parts))
    numbers = [int(p * scale) for p in parts]
    common = math.gcd(*numbers) or 1
    return tuple(n // common for n in numbers)


def _mixed(a: Row, by_a: int, b: Row, by_b: int) -> Row:
    numbers = [by_a * p + by_b * q for p, q in zip(a, b, strict=True)]
    common = math.gcd(*numbers) or 1
    return tuple(n // common for n in numbers)


def has_solution(equal: Iterable[Row], at_least: Iterable[Row], above: Iterable[Row]) -> bool:
    """Whether some x has a · x = b, a · x ≥ b and a · x > b for the rows (a, b) of each kind."""
    rest = list(equal)
    rows = dict.fromkeys(at_least, False)
    rows |= dict.fromkeys(above, True)  # of two alike the strict one counts
    while rest:
        pivot = rest.pop()
        k = next((k for k, a in enumerate(pivot[:-1]) if a), None)
        if k is None:
            if pivot[-1]:
                return False
            continue
        if pivot[k] < 0:
            pivot = tuple(-n for n in pivot)
        rest = [_mixed(row, pivot[k], pivot, -row[k]) for row in rest]
        rows = _without((_mixed(r, pivot[k], pivot, -r[k]), strict) for r, strict in rows.items())
    unknowns = len(next(iter(rows), (0,))) - 1
    for k in range(unknowns):
        lower = [(r, s) for r, s in rows.items() if r[k] > 0]
        upper = [(r, s) for r, s in rows.items() if r[k] < 0]
        rows = _without(
            [(r, s) for r, s in rows.items() if r[k] == 0]
            + [(_mixed(a, -b[k], b, a[k]), s or t) for a, s in lower for b, t in upper]
        )
    return all(row[-1] < 0 or (row[-1] == 0 and not strict) for row, strict in rows.items())


def _without(rows: Iterable[tuple[Row, bool]]) -> dict[Row, bool]:
    """The rows once each."""
    found: dict[Row, bool] = {}
    for row, strict in rows:
        found[row] = strict or found.get(row, False)
    return found


def is_possible(contacts: Sequence[ExactContact], motions: Sequence[str]) -> bool:
    """Whether some twist of the body moves the contacts in this way."""
    equal, above = [], []
    for one, motion in zip(contacts, motions, strict=True):
        (x, y), (vx, vy) = one.point, one.velocity

        def row(way: Vector, sign: int = 1, x: Fraction = x, y: Fraction = y,
                vx: Fraction = vx, vy: Fraction = vy) -> Row:  # fmt: skip
            a, b = way
            return whole(sign * n for n in (a, b, x * b - y * a, a * vx + b * vy))

        if motion == "BR":
            above.append(row(one.normal))
            continue
        equal.append(row(one.normal))
        if motion == "ST":
            equal.append(row(one.to_left))
        else:
            above.append(row(one.to_left, 1 if motion == "SL" else -1))
    return has_solution(equal, [], above)


def rays_of(contacts: Sequence[ExactContact], motions: Sequence[str]) -> list[list[Fraction]]:
    """The edges of the friction cones in which the contacts push: friction opposes slip."""
    pushes = {"ST": (1, -1), "SL": (-1,), "SR": (1,), "BR": ()}
    return [
        one.edge(sign)
        for one, motion in zip(contacts, motions, strict=True)
        for sign in pushes[motion]
    ]


def is_balanced(
    contacts: Sequence[ExactContact], motions: Sequence[str], slope: Fraction = ZERO
) -> bool:
    """Whether forces of the contacts in these motions carry the weight."""
    apart = [whole([*ray, ZERO]) for ray in rays_of(contacts, motions)]
    load = whole([-slope, Fraction(-1), ZERO, ZERO])
    return not has_solution([], apart, [load])


def is_reached(
    contacts: Sequence[ExactContact],
    motions: Sequence[str],
    slope: Fraction,
    which: int,
    limit: tuple[int, Fraction],
) -> bool:
    """Whether forces that carry the weight press contact `which` with a normal force [weights] of
    at most (sign +1) or at least (−1) a value; its normal has unit length."""
    sign, value = limit
    rays = []
    for k, (one, motion) in enumerate(zip(contacts, motions, strict=True)):
        own = Fraction(sign if k == which else 0)
        rays += [[*ray, own] for ray in rays_of([one], [motion])]
    apart = [whole([*ray, ZERO]) for ray in [*rays, [ZERO, ZERO, ZERO, Fraction(1)]]]
    load = whole([-slope, Fraction(-1), ZERO, -sign * value, ZERO])
    return not has_solution([], apart, [load])


def modes_of(contacts: Sequence[ExactContact], slope: Fraction = ZERO) -> set[tuple[str, ...]]:
    """All contact modes that are possible and in balance."""
    return {
        motions
        for motions in product(MOTIONS, repeat=len(contacts))
        if is_possible(contacts, motions) and is_balanced(contacts, motions, slope)
    }

# SPDX-License-Identifier: Apache-2.0
"""The parameter box of a certificate, as exact decimal numbers.

All values are `Fraction`s of the decimal text of the arguments: a certificate states 0.3, not the
nearest binary number. Angles are in degrees, as in the scene, since a whole number of degrees has
no exact value in radians. The slope is a tangent, since the conditions are linear in it.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from palmbots._types import SIDES

Ends = tuple[Fraction, Fraction]


def exact(value: Any) -> Fraction:
    """The decimal number that a float prints as."""
    return value if isinstance(value, Fraction) else Fraction(repr(float(value)))


def text(value: Fraction) -> str:
    """A fraction as decimal text where that is exact and short, as a quotient otherwise."""
    denominator = value.denominator
    for prime in (2, 5):
        while denominator % prime == 0:
            denominator //= prime
    if denominator != 1:
        return str(value)
    digits = 0
    while value.denominator != 1 and digits <= 30:
        digits += 1
        if (value * 10**digits).denominator == 1:
            break
    whole = abs(int(value * 10**digits))
    sign = "-" if value < 0 else ""
    if not digits:
        return f"{sign}{whole}"
    padded = str(whole).rjust(digits + 1, "0")
    return f"{sign}{padded[:-digits]}.{padded[-digits:]}"


@dataclass(frozen=True)
class ParameterBox:
    """Every uncertain quantity with its two ends; pairs are (left, right)."""

    com: tuple[tuple[Fraction, Fraction], ...]
    """Corners of the polygon in which the COM lies [m], in the object frame."""
    width: Ends
    friction: tuple[Ends, Ends]
    common: bool
    """Whether both palms have the same coefficient, anywhere in the interval."""
    shallow_deg: tuple[Ends, Ends]
    steep_deg: tuple[Ends, Ends]
    contacts: tuple[Ends, Ends]
    beyond: Fraction
    half_length: tuple[Ends, Ends]
    offset: tuple[Ends, Ends]
    slope: Ends
    """s, the tangent of the slope: specific force on the object towards −x."""
    outline: tuple[tuple[Fraction, Fraction, Fraction], ...]
    """All vertices (from left, from right, height), counter-clockwise, the left contact first.

    Over the width interval each palm sees the vertices at fixed distances from its own contact;
    only the other contact moves, to w."""
    right_contact: int
    """Index of the right contact vertex."""
    radius: tuple[Fraction, Fraction] = (Fraction(0), Fraction(0))
    """Of the arcs that round the contact vertices; 0: sharp. The file has them in its scene."""

    @property
    def rounded(self) -> bool:
        """Whether a contact vertex is rounded."""
        return any(self.radius)

    @property
    def com_is_upright(self) -> bool:
        """Whether the COMs are a rectangle along the axes, or a part of one."""
        xs, ys = ({corner[axis] for corner in self.com} for axis in (0, 1))
        return len(xs) <= 2 and len(ys) <= 2 and len(xs) * len(ys) == len({*self.com})

    def seen(self, side: int, w: Fraction) -> list[tuple[Fraction, Fraction]]:
        """The outline from one contact, the origin: (along the line of contacts, height)."""
        points = [(vertex[side], vertex[2]) for vertex in self.outline]
        points[self.right_contact if side == 0 else 0] = (w, Fraction(0))
        return points

    def as_dict(self) -> dict[str, Any]:
        """The box in the form that a certificate contains."""

        def ends(pair: Ends) -> list[str]:
            return [text(end) for end in pair]

        def sides(pair: tuple[Ends, Ends]) -> dict[str, list[str]]:
            return {side: ends(one) for side, one in zip(SIDES, pair, strict=True)}

        return {
            "com_m": [[text(x), text(y)] for x, y in self.com],
            "width_m": ends(self.width),
            "friction": sides(self.friction) | {"common": self.common},
            "shallow_deg": sides(self.shallow_deg),
            "steep_deg": sides(self.steep_deg),
            "contacts_m": sides(self.contacts),
            "beyond_m": text(self.beyond),
            "half_length_m": sides(self.half_length),
            "offset_m": sides(self.offset),
            "slope": ends(self.slope),
            "outline_m": [[text(v) for v in vertex] for vertex in self.outline],
            "right_contact": self.right_contact,
        }

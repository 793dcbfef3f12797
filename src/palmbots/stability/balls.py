"""Balls that certainly hold a value (Arb, through python-flint), and the object's angle in them."""

from fractions import Fraction
from typing import Any

from flint import arb, fmpq

from palmbots.stability.box import Box
from palmbots.stability.parts import Part

__all__ = ["ball", "least", "most", "object_tangents", "radians"]


def ball(value: Fraction) -> Any:
    """A ball around a number."""
    return arb(fmpq(value.numerator, value.denominator))


def radians(degrees: Fraction) -> Any:
    """A ball around an angle."""
    return ball(degrees) * arb.pi() / 180


def least(balls: list[Any]) -> Any:
    """A ball around the least of some."""
    found = balls[0]
    for one in balls[1:]:
        found = found.min(one)
    return found


def most(balls: list[Any]) -> Any:
    """A ball around the greatest of some."""
    found = balls[0]
    for one in balls[1:]:
        found = found.max(one)
    return found


def object_tangents(box: Box, part: Part) -> tuple[Any, Any] | None:
    """Balls around the least and the greatest tan ϑ of a part; None: it cannot reach."""
    heights: list[tuple[Any, Any]] = []
    for side in (0, 1):
        low, high = (radians(angle) for angle in part.angles[side])
        sines = (low.sin(), high.sin())
        cosines = [low.cos(), high.cos()]
        if part.angles[side][0] < 0 < part.angles[side][1]:
            cosines.append(arb(1))
        along = [ball(p) * s for p in part.contacts[side] for s in sines]
        across = [ball(o) * c for o in box.offset[side] for c in cosines]
        heights.append((least(along) + least(across), most(along) + most(across)))
    rise = (heights[1][0] - heights[0][1], heights[1][1] - heights[0][0])

    def tangent(z: Any, upward: bool) -> Any | None:
        outward = (z > 0) == upward
        w = ball(part.width[0] if outward else part.width[1])
        square = w * w - z * z
        return z / square.sqrt() if square > 0 else None

    found = tangent(rise[0], False), tangent(rise[1], True)
    return None if found[0] is None or found[1] is None else (found[0], found[1])

# SPDX-License-Identifier: Apache-2.0
"""Balls that certainly contain a value (Arb, through python-flint), and the object's angle."""

from fractions import Fraction
from typing import Any

from flint import arb, fmpq

from palmbots.stability.certificates.obligations import Subbox
from palmbots.stability.certificates.parameter_box import ParameterBox


def ball(value: Fraction) -> Any:
    """A ball around a number."""
    return arb(fmpq(value.numerator, value.denominator))


def radians(degrees: Fraction) -> Any:
    """A ball around an angle."""
    return ball(degrees) * arb.pi() / 180


def least(balls: list[Any]) -> Any:
    """A ball around the minimum."""
    result = balls[0]
    for other in balls[1:]:
        result = result.min(other)
    return result


def most(balls: list[Any]) -> Any:
    """A ball around the maximum."""
    result = balls[0]
    for other in balls[1:]:
        result = result.max(other)
    return result


def object_tangents(box: ParameterBox, part: Subbox) -> tuple[Any, Any] | None:
    """Balls around the smallest and largest tan ϑ of a part; None: the object cannot span it."""
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

    low, high = tangent(rise[0], False), tangent(rise[1], True)
    return None if low is None or high is None else (low, high)

# SPDX-License-Identifier: Apache-2.0
"""Which contact slides first, over intervals of everything that is not known exactly.

At a lean h the left contact slides at one squeeze, and so does the right one. With T = tan ϑ and a
horizontal specific force s, the squeeze of the left contact is the smaller one where G ≥ 0:

    G = h_R (c_x − c_y T) − h_L (w − c_x + c_y T) − h_L h_R w T
        + s (w − h_L (c_x T + c_y) − h_R (c_y − (w − c_x) T))

G is linear in each of c_x, c_y, T, h_L, h_R and s. Over a box of them, its extremes lie at the
corners. This holds where the denominators of the squeezes, w cos ϑ ∓ h z, are positive; elsewhere
the bounds here are infinite. Source: docs/theory/mechanics.md and docs/theory/probing.md.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Booleans: TypeAlias = NDArray[np.bool_]
Ends: TypeAlias = tuple[Any, Any]
"""Low and high: numbers, or arrays that broadcast against each other."""

UP, DOWN = 1, -1
"""The way of a contact that slides outward, while closing, and inward, while opening."""

_ROUNDING = 1e-12
"""More than the rounding of G, which is less than 10 m."""
_STEEPEST = math.radians(89)


@dataclass(frozen=True)
class Pose:
    """Palms and object at an instant, as intervals; pairs are (left, right)."""

    angles: tuple[Ends, Ends]
    """Of the palms [rad]."""
    tangent: Ends
    """T, of the object's angle."""


def leans(angle: Ends, friction_angle: Ends, way: int) -> Ends:
    """The tangents of angle ± friction angle [rad]; infinite where a contact may be wedged."""
    low, high = friction_angle if way == UP else (-friction_angle[1], -friction_angle[0])
    ends = angle[0] + low, angle[1] + high
    return tuple(  # ty: ignore[invalid-explicit-return]  # two of them
        np.where(np.abs(end) < _STEEPEST, np.tan(np.clip(end, -_STEEPEST, _STEEPEST)), np.inf)
        for end in ends
    )


def bounds(
    width: float, com_x: Ends, com_y: Ends, slope: Ends, tangent: Ends, left: Ends, right: Ends
) -> tuple[Floats, Floats]:
    """The smallest and the largest G for these intervals; `left` and `right` are leans h."""
    shape = np.broadcast(*com_x, *tangent, *left, *right).shape
    least, most = np.full(shape, np.inf), np.full(shape, -np.inf)
    with np.errstate(invalid="ignore"):
        for t in tangent:
            for rest, of_left, of_right in _linear(width, com_x, com_y, slope, t):
                for b in right:
                    of_a, others = of_left - b * (width * t), rest + b * of_right
                    for a in left:
                        value = a * of_a + others
                        np.minimum(least, value, out=least)
                        np.maximum(most, value, out=most)
    largest = np.maximum(
        np.maximum(np.abs(left[0]), np.abs(left[1])), np.maximum(np.abs(right[0]), np.abs(right[1]))
    )
    steepest = np.maximum(np.abs(tangent[0]), np.abs(tangent[1]))
    with np.errstate(invalid="ignore"):
        is_valid = largest * steepest < 1
    return np.where(is_valid, least - _ROUNDING, -np.inf), np.where(
        is_valid, most + _ROUNDING, np.inf
    )


def _linear(
    width: float, com_x: Ends, com_y: Ends, slope: Ends, t: Any
) -> Iterator[tuple[Any, Any, Any]]:
    """G + h_L h_R w T at its corners as a function of the leans: the constant part and what
    multiplies h_L and h_R.

    Without a specific force it depends on u = c_x − c_y T alone, so two corners are enough.
    """
    if slope[0] == slope[1] == 0:
        ups = com_y[0] * t, com_y[1] * t
        for u in (com_x[0] - np.maximum(*ups), com_x[1] - np.minimum(*ups)):
            yield 0.0, u - width, u
        return
    for x, y, s in itertools.product(com_x, com_y, slope):
        u, v = x - y * t, y + x * t
        yield s * width, u - width - s * v, u - s * (v - width * t)

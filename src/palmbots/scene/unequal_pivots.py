# SPDX-License-Identifier: Apache-2.0
"""Pivots at unequal heights, for the planar core, whose pivots are level.

Seen along the line between the pivots, a pair whose right pivot is higher stands on a slope: that
line rises towards +x by φ with sin φ = rise / distance. Relative to the line, the left palm rises
outward by φ more than relative to the floor, and the right palm by φ less. Nothing else changes, so
the core describes such a pair exactly at one distance. φ is that of the start; over a carry the
distance changes by a few percent, and φ with it (neglected).
"""

import math

import palmbots._core as _core

_ROUNDS = 20  # the distance depends on the tilt; each round has a small part of the last error


def tilt(spec: _core.Spec, angle: float) -> None:
    """Let the line between the pivots of a pair rise towards +x by a further angle [rad]."""
    spec.slope = math.tan(math.atan(spec.slope) + angle)
    left, right = spec.palms
    for palm, turn in ((left, angle), (right, -angle)):
        palm.steep += turn
        palm.shallow += turn
    spec.palms = (left, right)


def raise_right_pivot(spec: _core.Spec, rise_m: float) -> float:
    """Raise the right pivot of a pair over the left one, and return the tilt [rad]."""
    total = 0.0
    for _ in range(_ROUNDS if rise_m else 0):
        angle = math.asin(rise_m / _core.World(spec).separation) - total
        tilt(spec, angle)
        total += angle
    return total

# SPDX-License-Identifier: Apache-2.0
"""Mass properties and triangles of an extruded polygon, for MJCF and URDF.

A polygon in the (x, z) plane, counter-clockwise, stretched along y by ± depth / 2 [m].
"""

from collections.abc import Sequence
from dataclasses import dataclass

from palmbots._core import turn
from palmbots.scene.object_frame import Point


@dataclass(frozen=True)
class Gyration:
    """Squares of the radii of gyration about axes through the centroid [m²]."""

    xx: float
    """About x, ∫ (y² + z²) / area."""
    yy: float
    """About y, the axis of rotation in the side view."""
    zz: float
    xz: float
    """The product ∫ x z / area; the matrix of inertia has −m xz."""


def gyration(outline: Sequence[Point], depth: float) -> Gyration:
    """Second moments of the outline about its centroid (Green's theorem)."""
    area = mx = mz = sxx = szz = sxz = 0.0
    # From the first vertex, so that an outline far from the origin loses no digits.
    ox, oz = outline[0]
    points = [(x - ox, z - oz) for x, z in outline]
    for (ax, az), (bx, bz) in zip(points, (*points[1:], points[0]), strict=True):
        cross = ax * bz - bx * az
        area += cross / 2
        mx += cross * (ax + bx) / 6
        mz += cross * (az + bz) / 6
        sxx += cross * (ax * ax + ax * bx + bx * bx) / 12
        szz += cross * (az * az + az * bz + bz * bz) / 12
        sxz += cross * (2 * ax * az + ax * bz + bx * az + 2 * bx * bz) / 24
    cx, cz = mx / area, mz / area
    x2, z2, xz = sxx / area - cx * cx, szz / area - cz * cz, sxz / area - cx * cz
    y2 = depth * depth / 12
    return Gyration(xx=y2 + z2, yy=x2 + z2, zz=x2 + y2, xz=xz)


def triangles(outline: Sequence[Point]) -> list[tuple[int, int, int]]:
    """A triangulation of a simple counter-clockwise polygon (ear clipping)."""
    remaining = list(range(len(outline)))
    faces: list[tuple[int, int, int]] = []
    while len(remaining) > 3:
        for k in range(len(remaining)):
            i, j, n = remaining[k - 1], remaining[k], remaining[(k + 1) % len(remaining)]
            a, b, c = outline[i], outline[j], outline[n]
            if turn(a, b, c) <= 0:
                continue
            others = (outline[o] for o in remaining if o not in (i, j, n))
            if any(min(turn(a, b, p), turn(b, c, p), turn(c, a, p)) >= 0 for p in others):
                continue
            faces.append((i, j, n))
            remaining.pop(k)
            break
        else:  # only straight corners are left: triangles without area
            remaining.pop()
    return [*faces, (remaining[0], remaining[1], remaining[2])]

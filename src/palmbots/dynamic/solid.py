"""Mass properties and triangles of an extruded polygon, for MJCF and URDF.

A polygon in the (x, z) plane, counter-clockwise, stretched along y by ± depth / 2 [m].
"""

from collections.abc import Sequence
from dataclasses import dataclass

from palmbots.outline import Point, turn

__all__ = ["Gyration", "gyration", "triangles"]


@dataclass(frozen=True)
class Gyration:
    """Squares of the radii of gyration about axes through the centroid [m²]."""

    xx: float
    """About x, ∫ (y² + z²) / area."""
    yy: float
    """About y: the one that takes part in the side view."""
    zz: float
    xz: float
    """The product ∫ x z / area; the matrix of inertia has −m xz."""


def gyration(outline: Sequence[Point], depth: float) -> Gyration:
    """Second moments of the outline about its centroid, by Green's theorem."""
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
    """A simple counter-clockwise polygon cut into triangles, by clipping ears."""
    left = list(range(len(outline)))
    found: list[tuple[int, int, int]] = []
    while len(left) > 3:
        for k in range(len(left)):
            i, j, n = left[k - 1], left[k], left[(k + 1) % len(left)]
            a, b, c = outline[i], outline[j], outline[n]
            if turn(a, b, c) <= 0:
                continue
            others = (outline[o] for o in left if o not in (i, j, n))
            if any(min(turn(a, b, p), turn(b, c, p), turn(c, a, p)) >= 0 for p in others):
                continue
            found.append((i, j, n))
            left.pop(k)
            break
        else:  # nothing but straight corners is left: triangles without area
            left.pop()
    return [*found, (left[0], left[1], left[2])]

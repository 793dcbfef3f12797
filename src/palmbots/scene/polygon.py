# SPDX-License-Identifier: Apache-2.0
"""Simple polygons: simplicity, points inside, convex hull, supporting vertices, area.

A polygon is the list of its vertices, clockwise or counter-clockwise, without repetition of the
first one. A point is (x, y), finite, in any unit. Predicates are exact: the sign of a cross product
is computed in floating point where rounding cannot change it, and in rational numbers otherwise. No
tolerance decides whether an outline crosses itself.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction

Point = tuple[float, float]

# Three roundings in each product and one in their difference: 4 × 2⁻⁵³ of the sum of their sizes,
# doubled as a margin. The second number covers products that underflow.
_RELATIVE_ERROR = 1e-15
_UNDERFLOW = 1e-300


def _sign_of_cross(p: Point, q: Point, r: Point, s: Point) -> int:
    """Sign of (q − p) × (s − r), exactly."""
    one = (q[0] - p[0]) * (s[1] - r[1])
    two = (q[1] - p[1]) * (s[0] - r[0])
    cross = one - two
    if abs(cross) > _RELATIVE_ERROR * (abs(one) + abs(two)) + _UNDERFLOW:
        return 1 if cross > 0 else -1
    (px, py), (qx, qy), (rx, ry), (sx, sy) = ((Fraction(x), Fraction(y)) for x, y in (p, q, r, s))
    exact = (qx - px) * (sy - ry) - (qy - py) * (sx - rx)
    return (exact > 0) - (exact < 0)


def _sign_of_dot(p: Point, q: Point, r: Point, s: Point) -> int:
    """Sign of (q − p) · (s − r), exactly: a cross product with r and s turned by 90°."""
    return _sign_of_cross(p, q, (-r[1], r[0]), (-s[1], s[0]))


def turn(a: Point, b: Point, c: Point) -> int:
    """+1 where a → b → c turns left (counter-clockwise), −1 right, 0 on one line."""
    return _sign_of_cross(a, b, a, c)


def _on_segment(point: Point, a: Point, b: Point) -> bool:
    """Whether a point on the line through a and b lies on the closed segment a b."""
    return min(a[0], b[0]) <= point[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= point[1] <= max(
        a[1], b[1]
    )


def _edges(polygon: Sequence[Point]) -> Iterator[tuple[Point, Point]]:
    """The edges in order; edge k runs from vertex k to the next one."""
    return ((a, polygon[(k + 1) % len(polygon)]) for k, a in enumerate(polygon))


def _meet(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether the closed segments a b and c d have a point in common."""
    abc, abd, cda, cdb = turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)
    if abc != abd and cda != cdb and 0 not in (abc, abd, cda, cdb):
        return True
    return (
        (abc == 0 and _on_segment(c, a, b))
        or (abd == 0 and _on_segment(d, a, b))
        or (cda == 0 and _on_segment(a, c, d))
        or (cdb == 0 and _on_segment(b, c, d))
    )


def crossing_edges(polygon: Sequence[Point]) -> tuple[int, int] | None:
    """The first two edges that keep the polygon (3 vertices or more) from being simple, or None.

    Neighbouring edges may share their common vertex and nothing else. Edges that touch or fold back
    and an edge without length, returned as (k, k), are faults as well, so that a polygon without
    faults has an area.
    """
    edges = list(_edges(polygon))
    last = len(edges) - 1
    for k, (a, b) in enumerate(edges):
        if a == b:
            return (k, k)
    for i, (a, b) in enumerate(edges):
        for j in range(i + 1, len(edges)):
            c, d = edges[j]
            if j == i + 1:
                bad = turn(a, b, d) == 0 and _sign_of_dot(a, b, c, d) < 0
            elif i == 0 and j == last:
                bad = turn(c, d, b) == 0 and _sign_of_dot(c, d, a, b) < 0
            else:
                bad = _meet(a, b, c, d)
            if bad:
                return (i, j)
    return None


def winding(polygon: Sequence[Point]) -> int:
    """+1 for a simple polygon given counter-clockwise, −1 for one given clockwise."""
    k = min(range(len(polygon)), key=lambda i: polygon[i])  # a corner of the hull: it turns
    return turn(polygon[k - 1], polygon[k], polygon[(k + 1) % len(polygon)])


def area_and_centroid(polygon: Sequence[Point]) -> tuple[float, Point]:
    """The area of a simple polygon, and the centroid of a body of even thickness and density."""
    ox, oz = polygon[0]  # seen from the first vertex: a polygon far from the origin loses no digits
    area = mx = my = 0.0
    for (ax, ay), (bx, by) in _edges([(x - ox, y - oz) for x, y in polygon]):
        cross = ax * by - bx * ay
        area += cross / 2
        mx += cross * (ax + bx) / 6
        my += cross * (ay + by) / 6
    return abs(area), (ox + mx / area, oz + my / area)


def bottom_ends(polygon: Sequence[Point], tolerance: float) -> tuple[int, int] | None:
    """The leftmost and the rightmost of the lowest vertices, those at most `tolerance` above the
    lowest one; None where a single vertex is lowest."""
    low = min(y for _, y in polygon) + tolerance
    lowest = [k for k, (_, y) in enumerate(polygon) if y <= low]
    left = min(lowest, key=lambda k: polygon[k][0])
    right = max(lowest, key=lambda k: polygon[k][0])
    return None if left == right else (left, right)


def place_of_point(point: Point, polygon: Sequence[Point]) -> int:
    """+1 where the point lies inside the simple polygon, 0 on its boundary, −1 outside."""
    inside = False
    for a, b in _edges(polygon):
        side = turn(a, b, point)
        if side == 0 and _on_segment(point, a, b):
            return 0
        # Count the edges that a ray towards +x crosses; an end point belongs to the upper edge.
        if (a[1] > point[1]) != (b[1] > point[1]) and (side > 0) == (b[1] > a[1]):
            inside = not inside
    return 1 if inside else -1


def hull(points: Sequence[Point]) -> list[int]:
    """The corners of the convex hull as indices, counter-clockwise (Andrew's monotone chain).

    Points on a side of the hull are not corners. The points must not all lie on one line.
    """
    order = sorted(range(len(points)), key=lambda i: points[i])

    def chain(indices: Sequence[int]) -> list[int]:
        corners: list[int] = []
        for i in indices:
            while (
                len(corners) > 1 and turn(points[corners[-2]], points[corners[-1]], points[i]) <= 0
            ):
                corners.pop()
            corners.append(i)
        return corners[:-1]

    return chain(order) + chain(order[::-1])


def lower_vertices(polygon: Sequence[Point], left: int, right: int) -> frozenset[int]:
    """The vertices at which the polygon can rest on a level floor.

    The polygon is turned so that the vertices `left` and `right` are level, the first one on the
    left. The result contains the ends of all sides of its convex hull that face down.
    """
    corners = hull(polygon)
    ends: set[int] = set()
    for k, i in enumerate(corners):
        following = corners[(k + 1) % len(corners)]
        # Counter-clockwise, a side with the interior above it runs from left to right.
        if _sign_of_dot(polygon[i], polygon[following], polygon[left], polygon[right]) > 0:
            ends |= {i, following}
    return frozenset(ends)

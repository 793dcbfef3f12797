"""Simple polygons: which are, what lies inside, and what a polygon can stand on.

A polygon is its vertices in order, either way round, without repeating the first one at the end;
a point is (x, y), any unit, finite. Every answer is exact: the sign of a cross product is taken in
floating point where rounding cannot change it, and in rational numbers otherwise, so that no
tolerance decides whether an outline crosses itself.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction

__all__ = [
    "Point",
    "crossing_edges",
    "hull",
    "lower_vertices",
    "place_of_point",
    "turn",
    "winding",
]

Point = tuple[float, float]

# Three roundings go into each product and one into their difference: 4 × 2⁻⁵³ of the sum of their
# sizes, doubled to be safe; the second number covers products that underflow.
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
    """Is the point on the closed segment a b? Asked only of points on their common line."""
    return min(a[0], b[0]) <= point[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= point[1] <= max(
        a[1], b[1]
    )


def _edges(polygon: Sequence[Point]) -> Iterator[tuple[Point, Point]]:
    """The edges in order; edge k runs from vertex k to the next one."""
    return ((a, polygon[(k + 1) % len(polygon)]) for k, a in enumerate(polygon))


def _meet(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Do the closed segments a b and c d have a point in common?"""
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

    Edges may share the vertex between them and nothing else; so touching, folding back and an edge
    of no length (given as (k, k)) count as well, and a polygon that passes has an area.
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


def place_of_point(point: Point, polygon: Sequence[Point]) -> int:
    """+1 where the point lies inside the simple polygon, 0 on its boundary, −1 outside."""
    inside = False
    for a, b in _edges(polygon):
        side = turn(a, b, point)
        if side == 0 and _on_segment(point, a, b):
            return 0
        # Count the edges that a ray towards +x crosses; an end point belongs to the edge above it.
        if (a[1] > point[1]) != (b[1] > point[1]) and (side > 0) == (b[1] > a[1]):
            inside = not inside
    return 1 if inside else -1


def hull(points: Sequence[Point]) -> list[int]:
    """The corners of the convex hull as indices, counter-clockwise (Andrew's monotone chain).

    Points on a side of the hull are no corners. The points must not all lie on one line.
    """
    order = sorted(range(len(points)), key=lambda i: points[i])

    def chain(indices: Sequence[int]) -> list[int]:
        found: list[int] = []
        for i in indices:
            while len(found) > 1 and turn(points[found[-2]], points[found[-1]], points[i]) <= 0:
                found.pop()
            found.append(i)
        return found[:-1]

    return chain(order) + chain(order[::-1])


def lower_vertices(polygon: Sequence[Point], left: int, right: int) -> frozenset[int]:
    """The vertices the polygon can be supported at from below, when it is turned so that the one
    with index `left` and the one with index `right` are level, the first one on the left.

    These are the corners of its convex hull that end a side with the interior above it.
    """
    corners = hull(polygon)
    found: set[int] = set()
    for k, i in enumerate(corners):
        following = corners[(k + 1) % len(corners)]
        # Counter-clockwise, a side with the interior above it runs from left to right.
        if _sign_of_dot(polygon[i], polygon[following], polygon[left], polygon[right]) > 0:
            found |= {i, following}
    return frozenset(found)

# SPDX-License-Identifier: Apache-2.0
"""Whether the outline of a certificate is one simple polygon, in exact rational numbers.

A certificate states every vertex twice, as seen from either contact. Both must describe the same
object, and at every end of the width interval the outline must not cross or touch itself.
"""

from fractions import Fraction
from itertools import combinations

from palmbots.stability.certificates.checker.clearance_conditions import ObjectOutline
from palmbots.stability.certificates.checker.enclosures import Ends
from palmbots.stability.certificates.checker.property_conditions import LEFT, RIGHT, CheckFailed

Point = tuple[Fraction, Fraction]

ROUNDING = Fraction(1, 10**9)
"""Coordinates may be rounded by this part of the width: the frame contains a square root."""

_MOST_VERTICES = 100


def require_valid_outline(outline: ObjectOutline, width: Ends) -> None:
    """Raise `CheckFailed` unless the outline is a simple polygon of the stated width."""
    vertices, right = outline.outline, outline.right_contact
    if not 3 <= len(vertices) <= _MOST_VERTICES:
        raise CheckFailed(f"the outline does not have 3 to {_MOST_VERTICES} vertices")
    left_contact, right_contact = vertices[0], vertices[right]
    if left_contact[0] or left_contact[2] or right_contact[1] or right_contact[2]:
        raise CheckFailed("a contact vertex is not the origin of its coordinates")
    drawn = left_contact[1]
    rounding = drawn * ROUNDING
    if drawn <= 0 or abs(right_contact[0] - drawn) > rounding:
        raise CheckFailed("the contact vertices of the outline are at different distances")
    if any(abs(left + right - drawn) > rounding for left, right, _ in vertices):
        raise CheckFailed("the outline is not the same as seen from both contacts")
    if not width[0] - rounding <= drawn <= width[1] + rounding:
        raise CheckFailed(
            f"the outline is drawn {float(drawn):g} m wide, which is outside width_m, "
            f"{float(width[0]):g} to {float(width[1]):g} m"
        )
    for side in (LEFT, RIGHT):
        for w in {drawn, *width}:
            if crosses_itself(outline.seen(side, w)):
                raise CheckFailed(f"the outline crosses or touches itself at width {float(w):g} m")


def crosses_itself(points: list[Point]) -> bool:
    """Whether two edges have a point in common other than the vertex between them."""
    count = len(points)
    edges = [(points[k], points[(k + 1) % count]) for k in range(count)]
    for i, j in combinations(range(count), 2):
        if j == i + 1 or (i == 0 and j == count - 1):
            before, after = (i, j) if j == i + 1 else (j, i)
            if _folds_back(edges[before], edges[after]):
                return True
        elif _meet(*edges[i], *edges[j]):
            return True
    return False


def cross(a: Point, b: Point, c: Point) -> Fraction:
    """Twice the area of the triangle a, b, c; > 0: counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _folds_back(one: tuple[Point, Point], two: tuple[Point, Point]) -> bool:
    """Whether two edges in succession overlap, or one of them has no length."""
    (a, b), (_, c) = one, two
    if b in (a, c):
        return True
    forward = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1])
    return cross(a, b, c) == 0 and forward < 0


def _meet(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether two closed segments have a point in common."""
    c_side, d_side = cross(a, b, c), cross(a, b, d)
    a_side, b_side = cross(c, d, a), cross(c, d, b)
    if c_side * d_side < 0 and a_side * b_side < 0:
        return True
    touching = ((c_side, c, a, b), (d_side, d, a, b), (a_side, a, c, d), (b_side, b, c, d))
    return any(side == 0 and _between(point, p, q) for side, point, p, q in touching)


def _between(point: Point, a: Point, b: Point) -> bool:
    """Whether a point on the line through a and b lies between them."""
    return all(min(a[k], b[k]) <= point[k] <= max(a[k], b[k]) for k in (0, 1))

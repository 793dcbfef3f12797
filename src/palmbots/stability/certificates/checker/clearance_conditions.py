# SPDX-License-Identifier: Apache-2.0
"""The checker's conditions for the clearance from palms of finite length, in exact rationals.

Claim: the palm touches the outline in the contact vertex and nowhere else, for every
angle, width and contact in the certificate's box and for every palm length up to the greatest.

The origin is the contact vertex, x the line of contacts (from the left contact to the right one for
the left palm, from the right to the left for the right palm) and y up. The palm lies on the line

    through (0, 0) and (1 − t u, −(t + u)),  t = tan θ,  u = tan ϑ on the left, −tan ϑ on the right

from f = −(ℓ − p) cos θ cos ϑ to f = (ℓ + p) cos θ cos ϑ times that vector. A vertex (x, y) is above
the line iff x (t + u) + y (1 − t u) > 0. Sufficient for clearance is:

- the contact vertex is convex and both vertices next to it are above the line: then the palm leaves
  the object at the contact vertex on either side;
- no other edge meets the palm: its ends are both above the line, or both below it, or both ends of
  the palm are on the contact vertex's side of the edge.

Each of these forms is linear in each of t, u, f and the width w alone, so it has one sign on a
whole box if it has that sign at all corners. Where all vertices are above the line, palms of any
length are clear. The outline in the box is part of the claim.
"""

from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from palmbots.stability.certificates.checker.enclosures import Ends, cosine_of_degrees, root
from palmbots.stability.certificates.checker.property_conditions import (
    LEFT,
    CheckFailed,
    ObjectParams,
    ParameterBox,
    object_tangent,
    palm_tangents,
)

F = Fraction
Point = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class ObjectOutline:
    """The outline (from left, from right, height) and the half-lengths of the palms."""

    outline: tuple[tuple[Fraction, Fraction, Fraction], ...]
    right_contact: int
    half_length: tuple[Ends, Ends]

    def own(self, side: int) -> int:
        """The index of a palm's contact vertex."""
        return 0 if side == LEFT else self.right_contact

    def seen(self, side: int, w: Fraction) -> list[Point]:
        """The outline from a palm's contact, the other contact at w."""
        points = [(vertex[side], vertex[2]) for vertex in self.outline]
        points[self.own(1 - side)] = (w, F(0))
        return points


@dataclass(frozen=True)
class Line:
    """A palm's line in one corner of a box, and the palm's ends on it."""

    t: Fraction
    u: Fraction
    ends: tuple[Fraction, Fraction]  # of f

    def height(self, point: Point) -> Fraction:
        """> 0 above the line."""
        return point[0] * (self.t + self.u) + point[1] * (1 - self.t * self.u)

    def at(self, f: Fraction) -> Point:
        """A point of the palm."""
        return f * (1 - self.t * self.u), -f * (self.t + self.u)


def _side_of(a: Point, b: Point, point: Point) -> Fraction:
    """> 0 to the left of the line from a to b."""
    return (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])


def _lines(side: int, box: ParameterBox, given: ObjectParams, body: ObjectOutline) -> list[Line]:
    turn = object_tangent(box, given)
    u = turn if side == LEFT else (-turn[1], -turn[0])
    low, high = box.angles[side]
    cosine = F(1) if low < 0 < high else max(cosine_of_degrees(a)[1] for a in (low, high))
    flattest = max(turn[0], -turn[1], F(0))
    most = cosine / root(1 + flattest * flattest, upward=False)
    longest, p = body.half_length[side][1], box.contacts[side]
    ends = -most * max(longest - p[0], F(0)), most * max(longest + p[1], F(0))
    return [Line(*corner, ends) for corner in product(set(palm_tangents(box)[side]), set(u))]


def _convex(side: int, body: ObjectOutline, w: Fraction) -> bool:
    """Whether the counter-clockwise outline turns left at a palm's contact vertex."""
    points, own = body.seen(side, w), body.own(side)
    before, after = points[own - 1], points[(own + 1) % len(points)]
    turn = _side_of(before, (F(0), F(0)), after)
    return (turn if side == LEFT else -turn) > 0  # as seen from the right contact it is clockwise


def _area(points: list[Point]) -> Fraction:
    """Twice the area; > 0 where the points run counter-clockwise."""
    pairs = ((points[k - 1], points[k]) for k in range(len(points)))
    return sum((a[0] * b[1] - a[1] * b[0] for a, b in pairs), F(0))


def prove_clear(side: int, box: ParameterBox, given: ObjectParams, body: ObjectOutline) -> None:
    """Raise `CheckFailed` where the outline may touch a palm in a box."""
    lines = _lines(side, box, given, body)
    seen = [body.seen(side, w) for w in set(box.width)]
    own, count = body.own(side), len(body.outline)
    for w in box.width:
        area = _area(body.seen(side, w))
        if not (area if side == LEFT else -area) > 0 or not _convex(side, body, w):
            raise CheckFailed(
                "the outline is not counter-clockwise, or a contact lies in a notch of it"
            )

    def heights(k: int) -> list[Fraction]:
        return [line.height(outline[k]) for line in lines for outline in seen]

    for i in range(count):
        j = (i + 1) % count
        if own in (i, j):
            if not all(height > 0 for height in heights(i + j - own)):
                raise CheckFailed("the object may lie flat on a palm")
            continue
        ends = heights(i) + heights(j)
        if all(height > 0 for height in ends) or all(height < 0 for height in ends):
            continue
        sides = [
            _side_of(outline[i], outline[j], line.at(f))
            for line in lines
            for outline in seen
            for f in (F(0), *line.ends)
        ]
        if not (all(value > 0 for value in sides) or all(value < 0 for value in sides)):
            raise CheckFailed("the outline may touch a palm")


def prove_touching(
    side: int, edge: int, box: ParameterBox, given: ObjectParams, body: ObjectOutline
) -> None:
    """Raise `CheckFailed` unless a palm certainly touches this edge, at a single point."""
    (w, _), own = box.width, body.own(side)
    outline = body.seen(side, w)
    a, b = edge, (edge + 1) % len(outline)
    reach, p = body.half_length[side][0], box.contacts[side][0]
    if reach + p <= 0 or reach - p <= 0:
        raise CheckFailed("the contact of the witness is not inside its palm")
    turn = object_tangent(box, given)
    u = turn if side == LEFT else (-turn[1], -turn[0])
    # For a refutation the palm extends only as far as it certainly does.
    steepest = max(abs(turn[0]), abs(turn[1]))
    least = cosine_of_degrees(box.angles[side][0])[0] / root(1 + steepest**2, upward=True)
    ends = -least * (reach - p), least * (reach + p)
    lines = [Line(*corner, ends) for corner in product(set(palm_tangents(box)[side]), set(u))]
    if own in (a, b):
        other = outline[a + b - own]
        if not all(line.height(other) < 0 for line in lines):
            raise CheckFailed("the object does not certainly lie on the palm at the witness")
        return

    def apart(values: list[Fraction], others: list[Fraction]) -> bool:
        return (all(v > 0 for v in values) and all(v < 0 for v in others)) or (
            all(v < 0 for v in values) and all(v > 0 for v in others)
        )

    crosses = apart(
        [line.height(outline[a]) for line in lines], [line.height(outline[b]) for line in lines]
    )
    start = [_side_of(outline[a], outline[b], (F(0), F(0)))]
    reached = [
        [_side_of(outline[a], outline[b], line.at(line.ends[k])) for line in lines] for k in (0, 1)
    ]
    if not crosses or not any(apart(start, end) for end in reached):
        raise CheckFailed("the palm does not certainly touch that edge at the witness")

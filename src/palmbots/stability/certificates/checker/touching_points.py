# SPDX-License-Identifier: Apache-2.0
"""Where rounded contact vertices touch the palms, in exact rational intervals.

The claims about forces are about single states. The forces on an arc act at the point where it
touches its palm, within the cone of that palm, and the arc moves there as its material does. So
each state is one of a sharp object with its contact vertices at the touching points. A box with
arcs is proved as a box with sharp vertices that contains all of these objects: this module encloses
their width and their COM over a box.

With the direction (m, k) = (cos ϑ, sin ϑ) of the line from the left centre to the right one, its
length c, and the palm angles θ, the touching points are, seen from the left centre in a frame in
which that direction is the x-axis,

    left:  −r_L (m sin θ_L + k cos θ_L, m cos θ_L − k sin θ_L)
    right: (c, 0) + r_R (m sin θ_R − k cos θ_R, −(m cos θ_R + k sin θ_R))

and k c is the height of the right centre above the left one: p sin θ + (o + r) cos θ, right minus
left, with the offset o of the palm's surface. The squared distance of the touching points is

    c² + u² + v² + 2 c (m u + k v),  u = r_L sin θ_L + r_R sin θ_R,  v = r_L cos θ_L − r_R cos θ_R.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

from palmbots.stability.certificates.checker.clearance_conditions import ObjectOutline
from palmbots.stability.certificates.checker.enclosures import (
    Ends,
    cosine_of_degrees,
    down,
    root,
    sine_of_degrees,
    up,
)
from palmbots.stability.certificates.checker.property_conditions import (
    LEFT,
    RIGHT,
    CheckFailed,
    ObjectParams,
    ParameterBox,
)

F = Fraction
Coms = tuple[tuple[Fraction, Fraction], ...]


@dataclass(frozen=True)
class Interval:
    """All numbers from `low` to `high`; operations contain every result, rounded outward."""

    low: Fraction
    high: Fraction

    @classmethod
    def of(cls, *values: Fraction) -> Interval:
        """From the smallest to the largest value."""
        return cls(down(min(values)), up(max(values)))

    def __add__(self, other: Interval) -> Interval:
        return Interval(self.low + other.low, self.high + other.high)

    def __sub__(self, other: Interval) -> Interval:
        return Interval(self.low - other.high, self.high - other.low)

    def __mul__(self, other: Interval) -> Interval:
        ends = product((self.low, self.high), (other.low, other.high))
        return Interval.of(*(a * b for a, b in ends))

    def over(self, other: Interval) -> Interval:
        """The quotient by positive numbers."""
        if other.low <= 0:
            raise CheckFailed("the touching points cannot be enclosed")
        ends = product((self.low, self.high), (other.low, other.high))
        return Interval.of(*(a / b for a, b in ends))

    def square(self) -> Interval:
        """The squares, none of which is negative."""
        ends = self.low**2, self.high**2
        return Interval.of(*ends, *([F(0)] if self.low < 0 < self.high else []))

    def root(self) -> Interval:
        """The square roots."""
        if self.low < 0:
            raise CheckFailed("the touching points cannot be enclosed")
        return Interval(root(self.low, upward=False), root(self.high, upward=True))


def _point(value: Fraction) -> Interval:
    return Interval(value, value)


def _centre(outline: ObjectOutline, side: int, radius: Fraction) -> tuple[Interval, Interval]:
    """The centre of an arc (inward, up) from the vertex that it rounds."""
    own, count = outline.own(side), len(outline.outline)
    directions: list[tuple[Interval, Interval]] = []
    neighbours = [outline.outline[k] for k in (own - 1, (own + 1) % count)]
    for vertex in neighbours:
        x, y = vertex[side], vertex[2]
        length = _point(x * x + y * y).root()
        directions.append((_point(x).over(length), _point(y).over(length)))
    if side == RIGHT:  # seen from there, the outline is clockwise
        directions.reverse()
    (ax, ay), (bx, by) = directions
    opening = bx * ay - by * ax
    if opening.low <= 0:
        raise CheckFailed("a rounded contact vertex is not convex")
    size = _point(radius).over(opening)
    return size * (ax + bx), size * (ay + by)


@dataclass(frozen=True)
class ContactArcs:
    """The arcs that round the contact vertices: radii, and centres (inward, up) from a vertex."""

    radius: tuple[Fraction, Fraction]
    centre: tuple[tuple[Interval, Interval], tuple[Interval, Interval]]

    @classmethod
    def of(cls, outline: ObjectOutline, radius: tuple[Fraction, Fraction]) -> ContactArcs:
        """The arcs of an outline.

        Raises:
            CheckFailed: a rounded contact vertex is not convex.
        """
        return cls(
            radius, (_centre(outline, LEFT, radius[LEFT]), _centre(outline, RIGHT, radius[RIGHT]))
        )

    def touching(self, box: ParameterBox, given: ObjectParams) -> tuple[ParameterBox, ObjectParams]:
        """The box of the sharp objects that have their contact vertices at the touching points.

        Raises:
            CheckFailed: the object cannot span the palms everywhere in the box.
        """
        r = [_point(radius) for radius in self.radius]
        sines = [
            Interval.of(sine_of_degrees(low)[0], sine_of_degrees(high)[1])
            for low, high in box.angles
        ]
        cosines = [Interval.of(*_cosines(angle)) for angle in box.angles]
        heights = [
            Interval.of(*box.contacts[i]) * sines[i]
            + (Interval.of(*given.offset[i]) + r[i]) * cosines[i]
            for i in (LEFT, RIGHT)
        ]
        (left_in, left_up), (right_in, right_up) = self.centre
        run, step = Interval.of(*box.width) - left_in - right_in, right_up - left_up
        if run.low <= 0:
            raise CheckFailed("the arcs of the contact vertices overlap")
        c = (run.square() + step.square()).root()
        k = (heights[RIGHT] - heights[LEFT]).over(c)
        if max(-k.low, k.high) >= 1:
            raise CheckFailed("the object cannot span the palms everywhere in the parameter box")
        m = (_point(F(1)) - k.square()).root()
        u = r[LEFT] * sines[LEFT] + r[RIGHT] * sines[RIGHT]
        v = r[LEFT] * cosines[LEFT] - r[RIGHT] * cosines[RIGHT]
        square = c.square() + u.square() + v.square() + (c + c) * (m * u + k * v)
        distance = square.root()
        # The direction between the touching points, in the frame of the centres.
        along, across = (c + (m * u + k * v)).over(distance), (m * v - k * u).over(distance)
        arm_x = r[LEFT] * (m * sines[LEFT] + k * cosines[LEFT])
        arm_y = r[LEFT] * (m * cosines[LEFT] - k * sines[LEFT])

        def seen(com: tuple[Fraction, Fraction]) -> tuple[Interval, Interval]:
            """The COM from the left touching point."""
            right, above = _point(com[0]) - left_in, _point(com[1]) - left_up
            x = (run * right + step * above).over(c) + arm_x
            y = (run * above - step * right).over(c) + arm_y
            return along * x + across * y, along * y - across * x

        places = [seen(com) for com in given.com]
        coms = [(x, y) for xs, ys in places for x, y in product(_both(xs), _both(ys))]
        if _is_rectangle(given.com):
            coms = list(product(_extremes(coms, 0), _extremes(coms, 1)))
        return replace(box, width=_both(distance)), replace(given, com=tuple(coms))


def _both(values: Interval) -> Ends:
    return values.low, values.high


def _extremes(points: list[tuple[Fraction, Fraction]], axis: int) -> Ends:
    values = [point[axis] for point in points]
    return min(values), max(values)


def _cosines(angle: Ends) -> list[Fraction]:
    """Numbers between whose extremes all cosines of an interval of degrees lie."""
    values = [cosine for end in angle for cosine in cosine_of_degrees(end)]
    return [*values, F(1)] if angle[0] < 0 < angle[1] else values


def _is_rectangle(com: Coms) -> bool:
    """Whether the points are the corners of an upright rectangle, a segment or one point."""
    xs, ys = {x for x, _ in com}, {y for _, y in com}
    return len(xs) <= 2 and len(ys) <= 2 and len(set(com)) == len(xs) * len(ys)

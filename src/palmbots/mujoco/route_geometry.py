# SPDX-License-Identifier: Apache-2.0
"""The geometry of routes, seen from above: corners that are divided, and what the pair sweeps.

x and y as in the way points, metres; headings anticlockwise from x, radians.

A stage begins and ends where both robots are level with the object, on a straight stretch. A corner
that takes more than one stage is therefore divided: n corners turn by 1/n of its angle each, and
straight stretches of equal length ℓ between the way points join them. Their sum is as long as
ℓ sin((n − 1) τ / 2) / sin(τ / 2), where τ is the turn of each, and its heading bisects the corner.
So the first and the last of the n way points lie on the two lines, at the distance
½ ℓ sin((n − 1) τ / 2) / (sin(τ / 2) cos(n τ / 2)) from the corner.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from palmbots.mujoco.path_curve import Curve, Spot, corner_length
from palmbots.scene.path_section import Point
from palmbots.scene.robot_dimensions import BODY_GAP, BODY_SIZE, WHEEL_INSET, WHEEL_WIDTH

Wall = tuple[float, float, float, float]

_STEP_M = 0.02  # between two places at which the pair is compared with walls


def heading(one: Point, two: Point) -> float:
    """The heading from one point to another."""
    return math.atan2(two[1] - one[1], two[0] - one[0])


def turn_at(points: Sequence[Point], k: int) -> float:
    """By how much the way turns at a point, to the left."""
    after, before = heading(points[k], points[k + 1]), heading(points[k - 1], points[k])
    return math.remainder(after - before, 2 * math.pi)


def ahead(point: Point, way: float, distance: float, aside: float = 0.0) -> Point:
    """The point at a distance along a heading, and to the left of it."""
    cos, sin = math.cos(way), math.sin(way)
    return point[0] + distance * cos - aside * sin, point[1] + distance * sin + aside * cos


def seen_from(origin: Point, way: float, point: Point) -> Point:
    """A point in the frame with this origin, whose x points along this heading."""
    cos, sin = math.cos(way), math.sin(way)
    x, y = point[0] - origin[0], point[1] - origin[1]
    return cos * x + sin * y, cos * y - sin * x


def crossing(one: Point, way: float, other: Point, other_way: float) -> Point:
    """Where two lines cross, each given by a point and its heading."""
    dx, dy = other[0] - one[0], other[1] - one[1]
    across = math.sin(other_way - way)
    return ahead(one, way, (dx * math.sin(other_way) - dy * math.cos(other_way)) / across)


def divided(
    points: Sequence[Point], k: int, n: int, straight: float, radius: float, ease: float
) -> list[Point]:
    """The n way points in place of the corner k, with straight stretches of the length `straight`
    between their rounded corners."""
    turn, way = turn_at(points, k), heading(points[k - 1], points[k])
    each = turn / n
    side = straight + 2 * corner_length(each, radius, ease)
    whole = side * math.sin((n - 1) * each / 2) / math.sin(each / 2)
    found = [ahead(points[k], way, -0.5 * whole / math.cos(turn / 2))]
    for j in range(1, n):
        found.append(ahead(found[-1], way + j * each, side))
    return found


@dataclass(frozen=True)
class Rectangle:
    """A rectangle on the floor; x is along its heading, from the spot."""

    what: str
    spot: Spot
    low: float
    high: float
    half: float
    """Half of its width."""

    def corners(self) -> list[Point]:
        """The corners in their order."""
        at = self.spot.x, self.spot.y
        ends = ((self.low, -1), (self.high, -1), (self.high, 1), (self.low, 1))
        return [ahead(at, self.spot.heading, x, y * self.half) for x, y in ends]

    def meets(self, wall: Wall, clear: float) -> bool:
        """Whether a wall comes nearer than `clear`; at the corners, a little farther away."""
        cos, sin = math.cos(self.spot.heading), math.sin(self.spot.heading)
        first, last = (
            (cos * dx + sin * dy, cos * dy - sin * dx)
            for dx, dy in ((wall[i] - self.spot.x, wall[i + 1] - self.spot.y) for i in (0, 2))
        )
        enters, leaves = 0.0, 1.0  # shares of the wall
        for begin, end, low, high in (
            (first[0], last[0], self.low - clear, self.high + clear),
            (first[1], last[1], -self.half - clear, self.half + clear),
        ):
            if begin == end:
                if not low < begin < high:
                    return False
                continue
            near, far = sorted(((low - begin) / (end - begin), (high - begin) / (end - begin)))
            enters, leaves = max(enters, near), min(leaves, far)
        return enters < leaves


@dataclass(frozen=True)
class Footprint:
    """What a pair covers of the floor."""

    spread: float
    """Distance of the axles [m]."""
    axle: float
    """Distance of an axle outward of its pivot [m]."""
    ends: Point
    """How far the object reaches to both sides of the middle of its contacts, < 0 and > 0 [m]."""
    depth: float
    retreat: float
    """How far the robots drive away from an object on the floor [m]."""

    def swept(self, curve: Curve, begin: float, end: float) -> Iterator[tuple[float, Rectangle]]:
        """The rectangles of robots and object while the middle of the pair travels from one arc
        length to another, each with the arc length of the middle."""
        body = BODY_GAP + BODY_SIZE - self.axle
        half = BODY_SIZE / 2 + WHEEL_INSET + WHEEL_WIDTH / 2
        steps = max(1, math.ceil((end - begin) / _STEP_M))
        stops = [begin + (end - begin) * i / steps for i in range(steps + 1)]
        for s in stops:
            back, front = (curve.at(s + by * self.spread / 2) for by in (-1, 1))
            way = heading((back.x, back.y), (front.x, front.y))
            middle = Spot((back.x + front.x) / 2, (back.y + front.y) / 2, way, 0.0)
            yield s, Rectangle("the object", middle, *self.ends, self.depth / 2)
            yield s, Rectangle("the robot that follows", back, -body, 0.0, half)
            yield s, Rectangle("the robot that leads", front, 0.0, body, half)
        away = self.spread / 2 + self.retreat
        for s in (begin, end):
            for sense, what in ((-1, "follows"), (1, "leads")):
                spot, reach = curve.at(s + sense * away), sorted((0.0, sense * body))
                yield s, Rectangle(f"the robot that {what}", spot, reach[0], reach[1], half)


def first_touch(
    rectangles: Iterable[tuple[float, Rectangle]], walls: Sequence[Wall], clear: float
) -> tuple[float, str, int] | None:
    """The arc length at which a wall first comes nearer than `clear`, to what, and its number;
    None: none does."""
    for s, rectangle in rectangles:
        for k, wall in enumerate(walls):
            if rectangle.meets(wall, clear):
                return s, rectangle.what, k
    return None

# SPDX-License-Identifier: Apache-2.0
"""A certificate's box compared with a scene.

The outline of the box must be that of the scene, in the same place relative to the contacts. Every
other quantity of the scene may lie in its interval of the box or outside of it. The object's frame
is computed here again, in rational numbers: origin at the left contact vertex, x towards the right
one, y up.
"""

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any, Literal

from palmbots.scene.scene import Scene
from palmbots.stability.certificates.checker.claimed_box import ClaimedBox
from palmbots.stability.certificates.checker.enclosures import Ends, root
from palmbots.stability.certificates.checker.outline_validity import ROUNDING, Point, cross

F = Fraction
_SIDES: tuple[Literal["left"], Literal["right"]] = ("left", "right")


def _exact(value: float) -> Fraction:
    return F(repr(float(value)))


def _point(value: Any) -> Point:
    return _exact(value[0]), _exact(value[1])


class _Frame:
    """The object's frame of a scene."""

    def __init__(self, scene: Scene) -> None:
        body = scene.object
        self.vertices = [_point(vertex) for vertex in body.vertices_m]
        self.contacts = body.contacts
        self.left, self.right = (self.vertices[k] for k in body.contacts)
        square = (self.right[0] - self.left[0]) ** 2 + (self.right[1] - self.left[1]) ** 2
        self.width = root(square, upward=False)

    def place(self, point: Point) -> Point:
        """(x, y) of a point."""
        (lx, ly), (rx, ry) = self.left, self.right
        along = (point[0] - lx) * (rx - lx) + (point[1] - ly) * (ry - ly)
        return along / self.width, cross(self.left, self.right, point) / self.width

    def outline(self) -> tuple[list[Point], int]:
        """The vertices counter-clockwise from the left contact, and the right contact's index."""
        points = self.vertices
        area = sum(
            (
                a[0] * b[1] - a[1] * b[0]
                for a, b in zip(points, points[1:] + points[:1], strict=True)
            ),
            F(0),
        )
        step = 1 if area > 0 else -1
        order = [(self.contacts[0] + step * k) % len(points) for k in range(len(points))]
        return [self.place(points[k]) for k in order], order.index(self.contacts[1])


def contact_radii(scene: Scene) -> tuple[Fraction, Fraction]:
    """The radii of the arcs that round the contact vertices (left, right); 0: sharp."""
    radius, (left, right) = scene.object.edge_radius_m, scene.object.contacts
    if isinstance(radius, tuple):
        return _exact(radius[left]), _exact(radius[right])
    return _exact(radius), _exact(radius)


def has_outline_of(box: ClaimedBox, scene: Scene) -> bool:
    """Whether the box has the outline and the contact vertices of a scene."""
    frame = _Frame(scene)
    points, right = frame.outline()
    vertices = box.outline.outline
    if len(points) != len(vertices) or right != box.outline.right_contact:
        return False
    rounding = frame.width * ROUNDING
    return all(
        abs(vertex[0] - x) <= rounding
        and abs(vertex[1] - (frame.width - x)) <= rounding
        and abs(vertex[2] - y) <= rounding
        for vertex, (x, y) in zip(vertices, points, strict=True)
    )


def values_outside(box: ClaimedBox, scene: Scene) -> tuple[str, ...]:
    """The quantities of a scene that lie outside of the box, each as a phrase."""
    frame = _Frame(scene)
    rounding = frame.width * ROUNDING
    phrases = [
        f"{name} is {float(value):g}, but the parameter box has {_interval_text(ends)}"
        for name, value, ends, slack in _quantities(box, scene, frame)
        if not ends[0] - slack <= value <= ends[1] + slack
    ]
    com = frame.place(_point(scene.object.com_m))
    if not _in_hull(com, list(box.params.com), rounding):
        place = f"[{float(com[0]):g}, {float(com[1]):g}]"
        phrases.insert(0, f"the COM is at {place} m from the left contact, outside of the box's")
    if box.common_friction and scene.palm_of("left").friction != scene.palm_of("right").friction:
        phrases.append("the palms have different friction, but the parameter box has a common one")
    return tuple(phrases)


def _interval_text(ends: Ends) -> str:
    low, high = (f"{float(end):g}" for end in ends)
    return low if ends[0] == ends[1] else f"{low} to {high}"


def _quantities(
    box: ClaimedBox, scene: Scene, frame: _Frame
) -> Iterator[tuple[str, Fraction, Ends, Fraction]]:
    """(name, value in the scene, interval of the box, rounding)."""
    rounding = frame.width * ROUNDING
    yield "the distance of the contacts in m", frame.width, box.width, rounding
    sides = [_palm_quantities(box, scene, i) for i in (0, 1)]
    for (name, value, ends), other in zip(*sides, strict=True):
        if other == (name, value, ends):
            yield f"palm.{name}", value, ends, F(0)
            continue
        yield f"palm.left.{name}", value, ends, F(0)
        yield f"palm.right.{name}", *other[1:], F(0)
    towards = 1 if scene.task.direction == "forward" else -1
    slope = towards * _exact(math.tan(math.radians(scene.task.slope_deg)))
    yield "the tangent of task.slope_deg", slope, box.params.slope, ROUNDING


def _palm_quantities(box: ClaimedBox, scene: Scene, i: int) -> list[tuple[str, Fraction, Ends]]:
    """(key, value in the scene, interval of the box) of one palm."""
    palm, half = scene.palm_of(_SIDES[i]), box.outline.half_length[i]
    return [
        ("friction", _exact(palm.friction), box.friction[i]),
        ("shallow_deg", _exact(palm.shallow_deg), box.shallow_deg[i]),
        ("steep_deg", _exact(palm.steep_deg), box.steep_deg[i]),
        ("pivot_offset_m", _exact(palm.pivot_offset_m), box.params.offset[i]),
        ("length_m", _exact(palm.length_m), (2 * half[0], 2 * half[1])),
    ]


def _in_hull(point: Point, corners: list[Point], rounding: Fraction) -> bool:
    """Whether a point lies in the convex hull of some points, or no farther off than rounding."""
    hull = _hull(corners)
    low = [min(corner[k] for corner in hull) - rounding for k in (0, 1)]
    high = [max(corner[k] for corner in hull) + rounding for k in (0, 1)]
    if not all(low[k] <= point[k] <= high[k] for k in (0, 1)):
        return False
    if len(hull) == 1:
        return True
    # An edge and back again for a hull of two points.
    for a, b in zip(hull, hull[1:] + hull[:1], strict=True):
        length = root((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2, upward=True)
        if cross(a, b, point) < -rounding * length:
            return False
    return True


def _hull(corners: list[Point]) -> list[Point]:
    """The convex hull, counter-clockwise."""
    points = sorted(set(corners))
    if len(points) < 3:
        return points

    def half(ordered: list[Point]) -> list[Point]:
        chain: list[Point] = []
        for point in ordered:
            while len(chain) > 1 and cross(chain[-2], chain[-1], point) <= 0:
                chain.pop()
            chain.append(point)
        return chain[:-1]

    return half(points) + half(points[::-1])

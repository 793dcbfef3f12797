# SPDX-License-Identifier: Apache-2.0
"""Judges motions of the quasistatic world from outside; shares nothing with it.

The object is a set of circles (its corners; sharp ones have radius 0) and the straight lines
between them, a palm is a plate with a heel, the floor is y = 0, and walls and stands are rectangles
on it. From two poses a short time
apart follow the contacts that persist and how each of them moved. Forces in the corresponding edges
of their friction cones must balance the weight, as non-negative least squares decides.
"""

import cmath
import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import nnls

OUT = (-1.0, 1.0)
PLATE = 1e-3  # how deep a palm is solid: a thin one has no lower side [m]
FAR = 1e3  # [m]
TOUCHES = 2e-9  # gap of a contact at both ends of a motion [m]
BENT = 2e-6  # how far the middle of both poses may be from the motion [m]
SLIPS = 1e-3  # of the motion: more is slip, a tenth of it is none


def dot(a: Any, b: complex) -> Any:
    """Of vectors that are complex numbers."""
    return (a * b.conjugate()).real


def cross(a: complex, b: Any) -> Any:
    """The moment of a force b at a place a."""
    return (a.conjugate() * b).imag


@dataclass(frozen=True)
class Moment:
    """Where everything is: pivots [m], palm angles [rad], COM [m] and angle of the object [rad]."""

    pivots: tuple[tuple[float, float], tuple[float, float]]
    palms: tuple[float, float]
    pose: tuple[float, float, float]

    @classmethod
    def of(cls, world: Any) -> "Moment":
        return cls(world.pivots, world.palms, world.pose)

    def between(self, other: "Moment") -> "Moment":
        """The moment halfway to another one."""
        (ax, ay), (bx, by) = (
            (0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]))
            for p, q in zip(self.pivots, other.pivots, strict=True)
        )
        left, right = (0.5 * (p + q) for p, q in zip(self.palms, other.palms, strict=True))
        x, y, turn = (0.5 * (p + q) for p, q in zip(self.pose, other.pose, strict=True))
        return Moment(((ax, ay), (bx, by)), (left, right), (x, y, turn))


STILL = Moment(((0.0, 0.0), (0.0, 0.0)), (0.0, 0.0), (0.0, 0.0, 0.0))


class Face(NamedTuple):
    """A flat face of the palm of a side, or (2) of what stands still."""

    carrier: int
    start: complex
    along: complex
    length: float
    normal: complex
    friction: float
    solid: float  # how deep it is solid below [m]


class Tip(NamedTuple):
    """A corner of a palm or of a block that may touch the object."""

    carrier: int
    place: complex
    friction: float


class Edge(NamedTuple):
    """The straight line between two corners of the object, with its outward normal."""

    start: complex
    end: complex
    out: complex


class Touch(NamedTuple):
    """A contact: its point [m], its normal into the object, its gap [m], its friction."""

    carrier: int  # the side of the palm; 2: floor, walls and stands
    point: complex
    normal: complex
    gap: float
    friction: float


class Block(NamedTuple):
    """A rectangle on the floor; a wall is very long behind its face, and may be very high."""

    low: float
    high: float
    height: float
    friction: float


def _is_corner(before: Edge, after: Edge) -> bool:
    """Whether the outline is convex between two edges."""
    return cross(before.out, after.out) > 0


def _faces_out(way: complex, before: Edge, after: Edge) -> bool:
    """Whether a direction lies between the normals of two edges that meet in a convex corner."""
    slack = 1e-6
    return (
        _is_corner(before, after)
        and cross(before.out, way) > -slack
        and cross(way, after.out) > -slack
    )


class Oracle:
    """The object and the palms of a spec, over a floor or (None) without one. Vectors in the plane
    are complex numbers."""

    def __init__(
        self, spec: Any, floor_friction: float | None, blocks: Sequence[Block] = ()
    ) -> None:
        self.spec = spec
        self.slope = spec.slope
        self.floor = floor_friction
        self.blocks = tuple(blocks)
        com = complex(spec.com_left, spec.com_height)
        self.corners = [(complex(x, y) - com, r) for x, y, r in spec.corners]
        self.size = max(spec.width, *(r for _, r in self.corners))
        self.plates = [
            (palm.offset, palm.length / 2, palm.nose, palm.heel, palm.friction)
            for palm in spec.palms
        ]
        self.edges: list[Edge] = []
        for (a, r), (b, s) in pairwise([*self.corners, self.corners[0]]):
            # The line that touches both circles on the outside of an anticlockwise outline.
            if (long := abs(b - a)) < 1e-12:
                continue
            out = -1j * (b - a) / long * cmath.exp(1j * math.asin((r - s) / long))
            self.edges.append(Edge(a + r * out, b + s * out, out))

    def palm(self, at: Moment, side: int) -> tuple[complex, complex, complex]:
        """The pivot, and the directions along the palm and across it."""
        across = cmath.rect(1.0, OUT[side] * at.palms[side]) * 1j
        return complex(*at.pivots[side]), -1j * OUT[side] * across, across

    def faces(self, at: Moment) -> list[Face]:
        """Every flat face."""
        faces: list[Face] = []
        for side in (0, 1):
            pivot, along, across = self.palm(at, side)
            offset, half, nose, heel, friction = self.plates[side]
            top = pivot + offset * across
            inner, outer = top - half * along, top + half * along
            faces.append(Face(side, inner, along, 2 * half, across, friction, PLATE))
            if nose > 0:
                faces.append(Face(side, inner, -across, nose, -along, friction, PLATE))
            if heel > 0:
                faces.append(Face(side, outer, across, heel, -along, friction, PLATE))
        if self.floor is not None:
            faces.append(Face(2, complex(-FAR), 1 + 0j, 2 * FAR, 1j, self.floor, math.inf))
        for low, high, height, friction in self.blocks:
            wide, tall = high - low, FAR + height
            faces.append(Face(2, complex(low, height), 1 + 0j, wide, 1j, friction, math.inf))
            for x, out in ((low, -1 + 0j), (high, 1 + 0j)):
                faces.append(Face(2, complex(x, -FAR), 1j, tall, out, friction, wide / 2))
        return faces

    def tips(self, at: Moment) -> list[Tip]:
        """The corners of both palms and of the blocks that may touch the object."""
        tips = []
        for side in (0, 1):
            pivot, along, across = self.palm(at, side)
            offset, half, nose, heel, friction = self.plates[side]
            for x, y in ((-half, 0.0), (-half, -nose), (half, heel)):
                tips.append(Tip(side, pivot + x * along + (offset + y) * across, friction))
        for low, high, height, friction in self.blocks:
            tips.extend(Tip(2, complex(x, height), friction) for x in (low, high))
        return tips

    def placed(self, at: Moment) -> tuple[list[tuple[complex, float]], list[Edge]]:
        """The circles and the edges of the object."""
        com, turn = complex(*at.pose[:2]), cmath.rect(1.0, at.pose[2])
        return (
            [(com + turn * c, r) for c, r in self.corners],
            [Edge(com + turn * a, com + turn * b, turn * out) for a, b, out in self.edges],
        )

    def deepest(self, moments: Sequence[Moment]) -> np.ndarray:
        """How deep a palm, the floor or a block lies in the object at each moment [m]; negative:
        nowhere. Each surface is looked at in a frame in which it stands still."""
        poses = np.array([m.pose for m in moments])
        com, turn = poses[:, 0] + 1j * poses[:, 1], np.exp(1j * poses[:, 2])
        pivots = np.array([[complex(*p) for p in (*m.pivots, (0, 0))] for m in moments])
        spins = np.exp(1j * np.array([[*np.multiply(OUT, m.palms), 0.0] for m in moments]))
        depth = np.full(len(moments), -math.inf)
        for carrier, start, along, length, normal, _, solid in self.faces(STILL):
            for corner, radius in self.corners:
                centre = (com + corner * turn - pivots[:, carrier]) / spins[:, carrier] - start
                place, sunk = dot(centre, along), radius - dot(centre, normal)
                is_above = (place > 1e-3) & (place < length - 1e-3) & (sunk < solid)
                depth = np.maximum(depth, np.where(is_above, sunk, -math.inf))
        for carrier, tip, _ in self.tips(STILL):
            point = (pivots[:, carrier] + tip * spins[:, carrier] - com) / turn
            depth = np.maximum(depth, self._inside(point))
        return depth

    def _inside(self, points: np.ndarray) -> np.ndarray:
        """How deep points in the frame of the object lie in it; none do if it is not convex."""
        if not self.edges:
            (centre, radius), *_ = self.corners
            return radius - abs(points - centre)
        meeting = list(pairwise([self.edges[-1], *self.edges]))
        if not all(_is_corner(*edges) for edges in meeting):
            return np.full(len(points), -math.inf)
        depth = np.min([dot(e.start - points, e.out) for e in self.edges], axis=0)
        for (centre, radius), (before, after) in zip(self.corners, meeting, strict=True):
            if radius > 0:  # cut off by an arc: not inside the corner beyond it
                away = points - centre
                is_beyond = (cross(before.out, away) > 0) & (cross(after.out, away) < 0)
                depth = np.where(is_beyond, np.minimum(depth, radius - abs(away)), depth)
        return depth

    def touches(self, at: Moment, slack: float = 1e-7) -> dict[tuple[Any, ...], Touch]:
        """Pairs of features that are nearest points, by their names; `slack`: how far beyond the
        end of a face or an edge they may be [m]."""
        circles, edges = self.placed(at)
        found: dict[tuple[Any, ...], Touch] = {}
        for f, (carrier, start, along, length, normal, friction, _) in enumerate(self.faces(at)):
            for k, (centre, radius) in enumerate(circles):
                away = centre - start
                if not -slack <= dot(away, along) <= length + slack:
                    continue
                # The face's normal, reversed, must point out of the object at this corner.
                if edges and not _faces_out(-normal, edges[k - 1], edges[k]):
                    continue
                point, gap = centre - radius * normal, dot(away, normal) - radius
                found["face", f, k] = Touch(carrier, point, normal, gap, friction)
        for t, (carrier, tip, friction) in enumerate(self.tips(at)):
            for k, (a, b, out) in enumerate(edges):
                length = abs(b - a)
                if -slack <= dot(tip - a, b - a) / length <= length + slack:
                    gap = dot(tip - a, out)
                    found["tip", t, k] = Touch(carrier, tip, -out, gap, friction)
            for k, (centre, radius) in enumerate(circles):
                distance = abs(tip - centre)
                if radius == 0 or distance == 0:
                    continue
                out = (tip - centre) / distance
                if edges and not _faces_out(out, edges[k - 1], edges[k]):
                    continue
                found["arc", t, k] = Touch(carrier, tip, -out, distance - radius, friction)
        return found

    def imbalance(self, before: Moment, after: Moment) -> float | None:
        """How far the weight is from what those contacts can carry that persist from one moment to
        the other, moving as they did [weights]; None: nothing moved enough."""
        rays = self.rays(before, after)
        if not rays:
            return None if rays is None else math.inf
        wrenches = np.array([ray for _, ray in rays]).T
        return float(nnls(wrenches, np.array([self.slope, 1.0, 0.0]))[1])

    def rays(
        self, before: Moment, after: Moment, least: float = 1e-6
    ) -> list[tuple[int, list[float]]] | None:
        """Carrier and wrench (moment in sizes) of the edges of the cones in which these contacts
        push; None: nothing moved by at least this [m]."""
        at = before.between(after)
        first, last = self.touches(before), self.touches(after)
        com, turn = complex(*at.pose[:2]), after.pose[2] - before.pose[2]
        travel = complex(*after.pose[:2]) - complex(*before.pose[:2])
        moved = max(
            abs(travel) + abs(turn) * self.size,
            *(math.dist(a, b) for a, b in zip(before.pivots, after.pivots, strict=True)),
            *(abs(a - b) * self.size for a, b in zip(before.palms, after.palms, strict=True)),
        )
        if moved < least:
            return None
        rays: list[tuple[int, list[float]]] = []
        for name, touch in self.touches(at, BENT).items():
            ends = [where.get(name) for where in (first, last)]
            if any(one is None or abs(one.gap) > TOUCHES for one in ends):
                continue
            r, right = touch.point - com, -1j * touch.normal
            surface = 0j
            if (side := touch.carrier) < 2:
                (first_x, first_y), (last_x, last_y) = before.pivots[side], after.pivots[side]
                spin = OUT[side] * (after.palms[side] - before.palms[side])
                surface = complex(last_x - first_x, last_y - first_y)
                surface += spin * 1j * (touch.point - complex(*at.pivots[side]))
            slip = dot(travel + turn * 1j * r - surface, right) / max(moved, 1e-9)
            for sign in (-1.0, 1.0):
                if sign * slip > SLIPS:
                    continue  # friction opposes slip
                force = touch.normal + sign * touch.friction * right
                moment = cross(r, force) / self.size
                rays.append((touch.carrier, [force.real, force.imag, moment]))
        return rays


def slipperier(oracle: Oracle, by: float) -> Oracle:
    """The same with this share of the friction."""
    other = copy.copy(oracle)
    other.floor = None if oracle.floor is None else by * oracle.floor
    other.blocks = tuple(one._replace(friction=by * one.friction) for one in oracle.blocks)
    other.plates = [(*plate[:-1], by * plate[-1]) for plate in oracle.plates]
    return other

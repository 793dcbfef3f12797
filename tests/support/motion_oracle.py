# SPDX-License-Identifier: Apache-2.0
"""Judges motions of the quasistatic world from outside; shares nothing with it.

The object is a set of circles (its corners; sharp ones have radius 0) and the straight lines
between them, a palm is a plate with a heel, the floor is y = 0, and walls and stands are rectangles
on it. From two poses a short time
apart follow the contacts that persist and how each of them moved. Forces in the corresponding edges
of their friction cones must balance the weight, as non-negative least squares decides.
"""

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import nnls

Edge = tuple[np.ndarray, np.ndarray, np.ndarray]
OUT = (-1.0, 1.0)
PLATE = 1e-3  # how deep a palm is solid: a thin one has no lower side [m]
FAR = 1e3  # [m]
TOUCHES = 2e-9  # gap of a contact at both ends of a motion [m]
BENT = 2e-6  # how far the middle of both poses may be from the motion [m]
SLIPS = 1e-3  # of the motion: more is slip, a tenth of it is none


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


class Face(NamedTuple):
    """A flat face of the palm of a side, or (2) of what stands still."""

    carrier: int
    start: np.ndarray
    along: np.ndarray
    length: float
    normal: np.ndarray
    friction: float
    solid: float  # how deep it is solid below [m]


@dataclass(frozen=True)
class Touch:
    """A contact: its point [m], its normal into the object, its gap [m], its friction."""

    carrier: int  # the side of the palm; 2: floor, walls and stands
    point: np.ndarray
    normal: np.ndarray
    gap: float
    friction: float


class Block(NamedTuple):
    """A rectangle on the floor; a wall is very long behind its face, and may be very high."""

    low: float
    high: float
    height: float
    friction: float


class Oracle:
    """The object and the palms of a spec, over a floor or (None) without one."""

    def __init__(
        self, spec: Any, floor_friction: float | None, blocks: Sequence[Block] = ()
    ) -> None:
        self.spec = spec
        self.slope = spec.slope
        self.floor = floor_friction
        self.blocks = tuple(blocks)
        com = np.array([spec.com_left, spec.com_height])
        self.corners = [(np.array([x, y]) - com, r) for x, y, r in spec.corners]
        self.size = max(spec.width, *(r for _, r in self.corners))
        self.plates = [
            (palm.offset, palm.length / 2, palm.nose, palm.heel, palm.friction)
            for palm in spec.palms
        ]
        n = len(self.corners)
        self.edges: list[Edge] = []  # both ends, outward normal
        for k in range(n if n > 1 else 0):
            (a, r), (b, s) = self.corners[k], self.corners[(k + 1) % n]
            # The line that touches both circles on the outside of an anticlockwise outline.
            along = b - a
            long = float(np.hypot(*along))
            if long < 1e-12:
                continue
            turn = math.atan2(along[1], along[0]) - math.pi / 2 + math.asin((r - s) / long)
            out = np.array([math.cos(turn), math.sin(turn)])
            self.edges.append((a + r * out, b + s * out, out))

    def _palm(self, at: Moment, side: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The pivot, and the directions along the palm and across it."""
        t = at.palms[side]
        return (
            np.array(at.pivots[side]),
            np.array([OUT[side] * math.cos(t), math.sin(t)]),
            np.array([-OUT[side] * math.sin(t), math.cos(t)]),
        )

    def _faces(self, at: Moment) -> list[Face]:
        """Every flat face."""
        faces: list[Face] = []
        for side in (0, 1):
            pivot, along, across = self._palm(at, side)
            offset, half, nose, heel, friction = self.plates[side]
            top = pivot + offset * across
            inner, outer = top - half * along, top + half * along
            faces.append(Face(side, inner, along, 2 * half, across, friction, PLATE))
            if nose > 0:
                faces.append(Face(side, inner, -across, nose, -along, friction, PLATE))
            if heel > 0:
                faces.append(Face(side, outer, across, heel, -along, friction, PLATE))
        x, y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
        if self.floor is not None:
            faces.append(Face(2, -FAR * x, x, 2 * FAR, y, self.floor, math.inf))
        for low, high, height, friction in self.blocks:
            wide = high - low
            foot, tall = -FAR * y, FAR + height
            faces.append(Face(2, low * x + height * y, x, wide, y, friction, math.inf))
            faces.append(Face(2, low * x + foot, y, tall, -x, friction, wide / 2))
            faces.append(Face(2, high * x + foot, y, tall, x, friction, wide / 2))
        return faces

    def _tips(self, at: Moment) -> list[tuple[int, np.ndarray, float]]:
        """Carrier, place and friction of the corners of both palms and of the blocks that may touch
        the object."""
        tips = []
        for side in (0, 1):
            pivot, along, across = self._palm(at, side)
            offset, half, nose, heel, friction = self.plates[side]
            for x, y in ((-half, 0.0), (-half, -nose), (half, heel)):
                tips.append((side, pivot + x * along + (offset + y) * across, friction))
        for low, high, height, friction in self.blocks:
            tips.extend((2, np.array([x, height]), friction) for x in (low, high))
        return tips

    def _placed(self, at: Moment) -> tuple[list[tuple[np.ndarray, float]], list[Edge]]:
        x, y, turn = at.pose
        rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        com = np.array([x, y])
        return (
            [(com + rotation @ c, r) for c, r in self.corners],
            [(com + rotation @ a, com + rotation @ b, rotation @ n) for a, b, n in self.edges],
        )

    def deepest(self, at: Moment) -> float:
        """How deep a palm, the floor or a block lies in the object [m]; negative: nowhere."""
        circles, edges = self._placed(at)
        depth = -math.inf
        for _, start, along, length, normal, _, solid in self._faces(at):
            for centre, radius in circles:
                place, above = (centre - start) @ along, (centre - start) @ normal
                if 1e-3 < place < length - 1e-3 and radius - above < solid:
                    depth = max(depth, radius - above)
        if edges:
            for _, tip, _ in self._tips(at):
                inside = min((a - tip) @ n for a, _, n in edges)
                if self._is_convex and inside > 0:
                    # Cut off by an arc: not inside the straight lines' corner beyond it.
                    for centre, radius in circles:
                        away = tip - centre
                        if radius > 0 and self._is_beyond(away, centre, edges, circles):
                            inside = min(inside, radius - float(np.hypot(*away)))
                    depth = max(depth, inside)
        else:
            (centre, radius), *_ = circles
            for _, tip, _ in self._tips(at):
                depth = max(depth, radius - float(np.hypot(*(tip - centre))))
        return depth

    @property
    def _is_convex(self) -> bool:
        n = len(self.edges)
        return all(
            self.edges[k - 1][2][0] * self.edges[k][2][1]
            - self.edges[k - 1][2][1] * self.edges[k][2][0] > 0
            for k in range(n)
        )  # fmt: skip

    def _is_beyond(self, away: np.ndarray, centre: Any, edges: Any, circles: Any) -> bool:
        """Whether a point lies in the sector of a corner's arc."""
        k = next(i for i, (c, _) in enumerate(circles) if c is centre)
        before, after = edges[k - 1][2], edges[k][2]
        return (
            before[0] * away[1] - before[1] * away[0] > 0
            and away[0] * after[1] - away[1] * after[0] > 0
        )

    def touches(self, at: Moment, slack: float = 1e-7) -> dict[tuple[Any, ...], Touch]:
        """Pairs of features that are nearest points, by their names; `slack`: how far beyond the
        end of a face or an edge they may be [m]."""
        circles, edges = self._placed(at)
        found: dict[tuple[Any, ...], Touch] = {}
        for f, (carrier, start, along, length, normal, friction, _) in enumerate(self._faces(at)):
            for k, (centre, radius) in enumerate(circles):
                place, above = (centre - start) @ along, (centre - start) @ normal
                if not -slack <= place <= length + slack:
                    continue
                # The face's normal, reversed, must point out of the object at this corner.
                if edges and not self._faces_out(-normal, edges[k - 1][2], edges[k][2]):
                    continue
                found["face", f, k] = Touch(
                    carrier, centre - radius * normal, normal, float(above - radius), friction
                )
        for t, (carrier, tip, friction) in enumerate(self._tips(at)):
            for k, (a, b, out) in enumerate(edges):
                along = b - a
                length = float(np.hypot(*along))
                place = float((tip - a) @ along) / length
                if -slack <= place <= length + slack:
                    gap = float((tip - a) @ out)
                    found["tip", t, k] = Touch(carrier, tip, -out, gap, friction)
            for k, (centre, radius) in enumerate(circles):
                away = tip - centre
                distance = float(np.hypot(*away))
                if radius == 0 or distance == 0:
                    continue
                out = away / distance
                if edges and not self._faces_out(out, edges[k - 1][2], edges[k][2]):
                    continue
                found["arc", t, k] = Touch(carrier, tip, -out, distance - radius, friction)
        return found

    def _faces_out(self, way: np.ndarray, before: np.ndarray, after: np.ndarray) -> bool:
        slack = 1e-6
        if before[0] * after[1] - before[1] * after[0] <= 0:
            return False  # no convex corner
        return bool(
            before[0] * way[1] - before[1] * way[0] > -slack
            and way[0] * after[1] - way[1] * after[0] > -slack
        )

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
        com = np.array(at.pose[:2])
        twist = np.array(after.pose) - np.array(before.pose)
        moved = max(
            float(np.hypot(*twist[:2])) + abs(twist[2]) * self.size,
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
            r = touch.point - com
            tangent = np.array([touch.normal[1], -touch.normal[0]])
            body = twist[:2] + twist[2] * np.array([-r[1], r[0]])
            surface = np.zeros(2)
            if touch.carrier < 2:
                side = touch.carrier
                arm = touch.point - np.array(at.pivots[side])
                spin = OUT[side] * (after.palms[side] - before.palms[side])
                surface = np.subtract(after.pivots[side], before.pivots[side]) + spin * np.array(
                    [-arm[1], arm[0]]
                )
            slip = float((body - surface) @ tangent) / max(moved, 1e-9)
            for sign in (-1.0, 1.0):
                if sign * slip > SLIPS:
                    continue  # friction opposes slip
                force = touch.normal + sign * touch.friction * tangent
                moment = (r[0] * force[1] - r[1] * force[0]) / self.size
                rays.append((touch.carrier, [*force, moment]))
        return rays


def slipperier(oracle: Oracle, by: float) -> Oracle:
    """The same with this share of the friction."""
    other = copy.copy(oracle)
    other.floor = None if oracle.floor is None else by * oracle.floor
    other.blocks = tuple(one._replace(friction=by * one.friction) for one in oracle.blocks)
    other.plates = [(*plate[:-1], by * plate[-1]) for plate in oracle.plates]
    return other

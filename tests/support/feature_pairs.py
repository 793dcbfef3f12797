# SPDX-License-Identifier: Apache-2.0
"""Pairs of features that can touch: the object's corners and edges, the faces and tips of surfaces.

Plain geometry for the slow world (slow_world.py), over the shapes of its oracle.
"""

import math
from typing import Any, NamedTuple

from motion_oracle import STILL, Oracle

FLUSH = 1e-3  # an edge is flush with a face up to this angle [rad]
BEYOND = 1e-8  # how far past the end of an edge or a face a contact may be [m]

Vector = tuple[float, float]


class Contact(NamedTuple):
    """A pair of features: whether a contact would be within both, its gap [m], point and normal
    into the object."""

    within: bool
    gap: float
    point: Vector
    normal: Vector


class Sector(NamedTuple):
    """Between the outward normals of the edges at a corner; None: all around."""

    before: Vector | None
    after: Vector | None

    def has(self, x: float, y: float) -> bool:
        if self.before is None or self.after is None:
            return True
        (bx, by), (ax, ay) = self.before, self.after
        convex = bx * ay - by * ax > 0
        return convex and bx * y - by * x > -FLUSH and x * ay - y * ax > -FLUSH


class Tip(NamedTuple):
    """A corner of a carrier. Its normals have no part against these directions, in which the faces
    end there."""

    at: Vector
    ends: tuple[Vector, ...]

    def has(self, x: float, y: float) -> bool:
        return all(x * ex + y * ey > -FLUSH for ex, ey in self.ends)


class CornerOnFace(NamedTuple):
    carrier: int
    friction: float
    start: Vector
    along: Vector
    length: float
    normal: Vector
    centre: Vector
    radius: float
    sector: Sector

    def contact(self, frame: Any, body: Any) -> Contact:
        ox, oy, c, s = frame
        x, y, bc, bs = body
        (u, v), (au, av), (nu, nv), (px, py) = self.start, self.along, self.normal, self.centre
        nx, ny = c * nu - s * nv, s * nu + c * nv
        px, py = x + bc * px - bs * py, y + bs * px + bc * py
        dx, dy = px - (ox + c * u - s * v), py - (oy + s * u + c * v)
        place = dx * (c * au - s * av) + dy * (s * au + c * av)
        within = -BEYOND <= place <= self.length + BEYOND
        within = within and self.sector.has(-bc * nx - bs * ny, bs * nx - bc * ny)
        gap = dx * nx + dy * ny - self.radius
        point = px - self.radius * nx, py - self.radius * ny
        return Contact(within, gap, point, (nx, ny))


class TipOnEdge(NamedTuple):
    carrier: int
    friction: float
    tip: Tip
    start: Vector
    along: Vector
    length: float
    out: Vector

    def contact(self, frame: Any, body: Any) -> Contact:
        ox, oy, c, s = frame
        x, y, bc, bs = body
        (u, v), (ax, ay), (ex, ey), (nx, ny) = self.tip.at, self.start, self.along, self.out
        tx, ty = ox + c * u - s * v, oy + s * u + c * v
        dx, dy = tx - x, ty - y
        qx, qy = bc * dx + bs * dy - ax, bc * dy - bs * dx - ay
        place = qx * ex + qy * ey
        within = -BEYOND <= place <= self.length + BEYOND
        gap = qx * nx + qy * ny
        mx, my = bs * ny - bc * nx, -bs * nx - bc * ny
        within = within and self.tip.has(c * mx + s * my, c * my - s * mx)
        return Contact(within, gap, (tx, ty), (mx, my))


class TipOnArc(NamedTuple):
    carrier: int
    friction: float
    tip: Tip
    centre: Vector
    radius: float
    sector: Sector

    def contact(self, frame: Any, body: Any) -> Contact:
        ox, oy, c, s = frame
        x, y, bc, bs = body
        (u, v), (px, py) = self.tip.at, self.centre
        tx, ty = ox + c * u - s * v, oy + s * u + c * v
        dx, dy = tx - x, ty - y
        qx, qy = bc * dx + bs * dy - px, bc * dy - bs * dx - py
        away = math.hypot(qx, qy) or 1e-30
        nx, ny = qx / away, qy / away
        mx, my = bs * ny - bc * nx, -bs * nx - bc * ny
        within = self.sector.has(nx, ny) and self.tip.has(c * mx + s * my, c * my - s * mx)
        return Contact(within, away - self.radius, (tx, ty), (mx, my))


Pair = CornerOnFace | TipOnEdge | TipOnArc


def pairs_of(oracle: Oracle) -> list[Pair]:
    """All pairs of features, each in the frame of its carrier and of the object."""

    def vector(v: complex) -> Vector:
        return v.real, v.imag

    outs = [vector(out) for *_, out in oracle.edges]
    corners = [
        (vector(c), float(r), Sector(outs[k - 1], outs[k]) if outs else Sector(None, None))
        for k, (c, r) in enumerate(oracle.corners)
    ]
    found: list[Pair] = []
    ends: list[tuple[int, Vector, Vector]] = []
    for carrier, start, along, length, normal, friction, *_ in oracle.faces(STILL):
        face = vector(start), vector(along), float(length), vector(normal)
        found += [CornerOnFace(carrier, friction, *face, *corner) for corner in corners]
        ends += [(carrier, vector(start), vector(-along))]
        ends += [(carrier, vector(start + length * along), vector(along))]
    for carrier, point, friction in oracle.tips(STILL):
        place = vector(point)
        there = [way for c, end, way in ends if c == carrier and math.dist(end, place) < 1e-9]
        tip = Tip(place, tuple(there))
        for a, b, out in oracle.edges:
            long = abs(b - a)
            if long > 0:
                along = vector((b - a) / long)
                edge = vector(a), along, long, vector(out)
                found.append(TipOnEdge(carrier, friction, tip, *edge))
        arcs = [corner for corner in corners if corner[1] > 0]
        found += [TipOnArc(carrier, friction, tip, *arc) for arc in arcs]
    return found

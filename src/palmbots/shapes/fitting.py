# SPDX-License-Identifier: Apache-2.0
"""The polygon with rounded corners that replaces a dense outline within a tolerance.

An outline is an array of points [m], x to the right and y upwards, counter-clockwise, whose first
point is not repeated. Each edge of the polygon follows a chord of the outline. Two chords can be
neighbours if the outline between them is near their lines and an arc that touches both. The arc has
the radius of least deviation, 0 included; concave corners are sharp. A polygon with the fewest
corners is a shortest path from the longest chord around the outline. Least squares then move its
lines and arcs to the points of the outline.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from palmbots.shapes.point_arrays import Points
from palmbots.shapes.rounded_outline import (
    boundary,
    deviation_m,
    distance_of,
    from_segment,
    rounded,
    unit,
)

# Parts of the tolerance for the fit. First exact lines and arcs, as drawings have them; then what
# follows a scan with few corners: all of the tolerance, or less where errors add up.
_EXACT = 0.1
_SHARES = (_EXACT, 1.0, 0.7, 0.5, 0.35, 0.25)
_CHORDS = (0.25, 1.0)  # distances of chords from the outline, of these parts
_LEVEL = 0.15  # how far corners are moved to be level, of the tolerance

_SHARPEST = math.radians(150)  # turn of a corner that may have a radius
_FACET = 0.08  # distance of the middle of a facet from its arc, of the radius: 45° of the arc
_STRAIGHT = 1e-3  # distance of points that are left out within an edge, of the tolerance
_LEAST_RADIUS = 0.1  # of an arc, of the tolerance; smaller ones are noise


@dataclass(frozen=True)
class Fitted:
    """A polygon with rounded corners in place of an outline."""

    vertices: Points
    radii: Points
    """Of the corners [m]; 0: a sharp one."""
    deviation_m: float
    """Greatest distance between outline and polygon."""


class _Chord(NamedTuple):
    """A line from one point of an outline to a later one."""

    first: int
    last: int
    line: tuple[float, float]
    """Angle of the outward normal, and distance from the origin along it."""


class _Edge(NamedTuple):
    """An edge of a polygon, the radius of the corner at its end, and which points are near it."""

    line: tuple[float, float]
    radius: float
    points: Any


class _Corner:
    """Two lines, and an arc that touches both."""

    def __init__(self, one: Any, other: Any) -> None:
        (angle, offset), (next_angle, next_offset) = one, other
        self.turn = math.remainder(next_angle - angle, 2 * math.pi)
        self.side = math.copysign(1.0, self.turn)
        self.normals = np.array([unit(angle), unit(next_angle)])
        self.offsets = np.array([offset, next_offset])
        self.along = self.normals[:, ::-1] * (-1, 1)
        self.inverse = np.linalg.inv(self.normals)

    def centre(self, radius: float) -> Points:
        """Of the arc; of radius 0, the corner itself."""
        return self.inverse @ (self.offsets - radius)

    def distances(self, points: Points, radius: float) -> Points:
        """Distances of points, outside > 0. None falls if the radius grows."""
        off = points - self.centre(radius)
        is_arc = (self.side * off @ self.inverse > 0).all(axis=1)
        of_lines = self.side * (self.side * (points @ self.normals.T - self.offsets)).max(axis=1)
        return np.where(is_arc, self.side * np.hypot(*off.T) - radius, of_lines)

    def slopes(self, points: Points, radius: float) -> tuple[Points, Points, Any]:
        """Distances, how they change with both angles, both offsets and the radius, and of which
        points they are. The point nearest to a sharp corner is to be near both lines."""
        nearest = int(np.hypot(*(points - self.centre(0.0)).T).argmin())
        which = np.array([*range(len(points)), *[nearest][: int(radius == 0)]])
        points = points[which]
        off = points - self.centre(radius)
        far = np.hypot(*off.T)
        # Shares of both normals in the direction of the distance.
        shares = self.side * (off / np.maximum(far, 1e-300)[:, None]) @ self.inverse
        of_lines = points @ self.normals.T - self.offsets
        is_arc = (shares > 0).all(axis=1)
        is_other = self.side * of_lines[:, 1] > self.side * of_lines[:, 0]
        if radius == 0:
            is_arc[[nearest, -1]], is_other[[nearest, -1]] = False, (False, True)
        shares[~is_arc] = np.column_stack([~is_other, is_other])[~is_arc]
        feet = np.where(is_arc[:, None], points - off, points)
        turns = shares * (feet @ self.along.T)
        slopes = np.column_stack([turns, -shares, shares.sum(axis=1) - 1])
        lines = np.where(is_other, of_lines[:, 1], of_lines[:, 0])
        return np.where(is_arc, self.side * far - radius, lines), slopes, which

    def radius(
        self, ring: Points, which: Any, most: float, limit: float, coarsest: float
    ) -> float | None:
        """The radius up to `most` with the least greatest distance from some points of an outline;
        None: it is over the limit. The whole circle of an arc lies in the outline."""
        points = ring[which]

        def ends(radius: float) -> tuple[float, float]:
            found = self.distances(points, radius)
            return float(found.min()), float(found.max())

        low, high = 0.0, most if 0 < self.turn < _SHARPEST else 0.0
        inmost, outmost = ends(high)[0], ends(low)[1]
        while inmost >= -limit and outmost <= limit:
            if high - low <= 1e-3 * most:
                far = distance_of(self.centre(low), ring)
                is_inside = far >= low - _between(low, limit, coarsest)
                return low if is_inside else 0.0 if ends(0.0)[0] >= -limit else None
            middle = (low + high) / 2
            least, greatest = ends(middle)
            if least + greatest < 0:
                low, outmost = middle, greatest
            else:
                high, inmost = middle, least
        return None


def _between(radius: float, limit: float, coarsest: float) -> float:
    """Distance from an arc that is allowed between the points of an outline: that of a facet."""
    return max(limit, min(coarsest, _FACET * radius))


def polygon_of(outline: Points, tolerance_m: float, most: int) -> Fitted:
    """The polygon with few corners that deviates by at most the tolerance.

    A body stands on its lowest corners, so corners a little above the lowest one are made level
    with it. Errors of fit and levelling may add up; so the greatest deviation is measured, and the
    fit repeated with a smaller part of the tolerance until it keeps to all of it.

    Args:
        outline: dense points.
        tolerance_m: greatest deviation.
        most: corners that may be used to follow lines and arcs closely; beyond that, as few as the
            tolerance allows.
    """
    for share in _SHARES:
        limit = share * tolerance_m
        edges, ring = _fewest(
            outline, limit, tolerance_m, most if share == _EXACT else len(outline)
        )
        if len(edges) < 3:
            continue
        nearest = _nearest(_with_radii(_nearest(edges, ring), ring, tolerance_m), ring)
        for found in (nearest, edges):
            vertices = np.array([corner.centre(0.0) for corner in _corners_of(found)])
            radii = np.array([edge.radius for edge in found])
            vertices, radii = _finished(vertices, radii, tolerance_m)
            if (deviation := deviation_m(outline, boundary(vertices, radii))) <= tolerance_m:
                return Fitted(vertices, radii, deviation)
    vertices, radii = _finished(outline, np.zeros(len(outline)), 0.0)
    return Fitted(vertices, radii, deviation_m(outline, vertices))


def _fewest(ring: Points, limit: float, coarsest: float, most: int) -> tuple[list[_Edge], Points]:
    """The edges of a polygon with the fewest corners, and the outline from where the first begins.

    Args:
        ring: points of the outline.
        limit: greatest distance of a point from the polygon.
        coarsest: greatest distance of the middle between two points.
        most: corners; none are found if there are more.
    """
    ring = np.roll(ring, -_farthest_from(ring, 0), axis=0)  # no point within an edge
    ring = ring[sorted(chord.first for chord in _chords(ring, _STRAIGHT * coarsest))]
    size = len(ring)
    longest = max(
        _chords(ring, limit), key=lambda one: math.dist(ring[one.first], ring[one.last % size])
    )
    ring = np.roll(ring, -longest.first, axis=0)
    twice = np.vstack([ring, ring])
    chords = sorted({chord for part in _CHORDS for chord in _chords(ring, part * limit)})
    start = max(chord for chord in chords if chord.first == 0)
    goal = _Chord(size, size + start.last, start.line)
    nodes = [start, *(chord for chord in chords if chord.first >= start.last), goal]
    reaches = [_reach(chord, twice, limit) for chord in nodes]
    best: list[tuple[int, float, int, float]] = [(0, 0.0, -1, 0.0)] * len(nodes)
    known = np.zeros(len(nodes), bool)
    known[0] = True
    for k, one in enumerate(nodes[:-1]):
        corners, error = best[k][:2]
        for i in range(k + 1, len(nodes)) if known[k] and corners < most else ():
            other = nodes[i]
            turn = math.remainder(other.line[0] - one.line[0], 2 * math.pi)
            is_convex = int(turn > 0)
            if other.first < one.last or abs(math.sin(turn)) < 1e-9:
                continue
            if other.first > reaches[k][is_convex][1] or one.last < reaches[i][is_convex][0]:
                continue
            if known[i] and best[i][:2] <= (corners + 1, error):
                continue
            if found := _corner_between(one, other, twice, limit, coarsest):
                radius, off = found
                if not known[i] or (corners + 1, error + off) < best[i][:2]:
                    best[i], known[i] = (corners + 1, error + off, k, radius), True
    edges: list[_Edge] = []
    at = len(nodes) - 1 if known[-1] else 0
    while at:
        radius, before = best[at][3], best[at][2]
        edges.append(_Edge(nodes[before].line, radius, _span(nodes[before], nodes[at]) % size))
        at = before
    return edges[::-1], ring


def _farthest_from(ring: Points, k: int) -> int:
    return int(np.hypot(*(ring - ring[k]).T).argmax())


def _chords(ring: Points, limit: float) -> list[_Chord]:
    """Chords from which no point of a closed outline is off by more than a limit (Douglas and
    Peucker)."""
    closed = np.vstack([ring, ring[:1]])
    far = _farthest_from(ring, 0)
    spans, found = [(0, far), (far, len(ring))], []
    while spans:
        i, j = spans.pop()
        off = from_segment(closed[i : j + 1], closed[i], closed[j])
        if off.max() > limit and j - i > 1:
            k = i + int((off > off.max() - 0.1 * limit).argmax())  # the end of a parallel facet
            spans += [(i, k), (k, j)]
        else:
            dx, dy = closed[j] - closed[i]
            angle = math.atan2(-dx, dy)
            found.append(_Chord(i, j, (angle, float(closed[j] @ unit(angle)))))
    return found


def _reach(chord: _Chord, twice: Points, limit: float) -> list[tuple[int, int]]:
    """The first and the last point up to which the outline stays on one side of a chord's line:
    outside, as near a concave corner, and inside."""
    height = twice @ unit(chord.line[0]) - chord.line[1]
    found = []
    for beyond in (height < -limit, height > limit):
        before, after = np.flatnonzero(beyond[: chord.first]), np.flatnonzero(beyond[chord.last :])
        found.append((max(before, default=-1) + 1, chord.last + min(after, default=len(twice)) - 1))
    return found


def _span(one: _Chord, other: _Chord) -> Any:
    """The indices of the points from the middle of a chord to that of another one."""
    return np.arange((one.first + one.last + 1) // 2, (other.first + other.last) // 2 + 1)


def _corner_between(
    one: _Chord, other: _Chord, twice: Points, limit: float, coarsest: float
) -> tuple[float, float] | None:
    """The radius of the corner between two chords, and the greatest distance of a point from it;
    None: it is no corner of the outline. An arc takes no more than half of a chord."""
    corner = _Corner(one.line, other.line)
    vertex = corner.centre(0.0)
    to, back = (
        float(corner.along[k] @ (vertex - (twice[chord.first] + twice[chord.last]) / 2))
        for k, chord in enumerate((one, other))
    )
    room = min(to, -back)
    if room <= 0:
        return None
    span = _span(one, other)
    most = room / max(math.tan(corner.turn / 2), 1e-9)
    radius = corner.radius(twice, span, most, limit, coarsest)
    if radius is None:
        return None
    points = twice[span]
    middles = (points[1:] + points[:-1]) / 2
    if (abs(corner.distances(middles, radius)) > _between(radius, limit, coarsest)).any():
        return None
    return radius, float(abs(corner.distances(points, radius)).max())


def _nearest(edges: list[_Edge], ring: Points) -> list[_Edge]:
    """The edges with their lines and arcs moved so that the squares of the distances of the outline
    become least (Levenberg and Marquardt)."""
    count = len(edges)
    shift, size = ring.mean(axis=0), float(np.ptp(ring, axis=0).max())
    scaled = (ring - shift) / size
    lengths = np.hypot(*(np.roll(scaled, -1, axis=0) - scaled).T)
    weights = np.sqrt((lengths + np.roll(lengths, 1)) / 2)
    found = np.array(
        [(a, (offset - shift @ unit(a)) / size, r / size) for (a, offset), r, _ in edges]
    )
    most = 2 * found[:, 2]  # a radius that grows farther would be another arc
    is_free = np.column_stack([np.ones((count, 2)), found[:, 2] > 0]).astype(float)

    def system(values: Points) -> tuple[Points, Points]:
        rows, distances = [], []
        for k, edge in enumerate(edges):
            other = (k + 1) % count
            corner = _Corner(values[k, :2], values[other, :2])
            off, slopes, which = corner.slopes(scaled[edge.points], values[k, 2])
            row = np.zeros((len(off), count, 3))
            row[:, k, :2] += slopes[:, [0, 2]]
            row[:, other, :2] += slopes[:, [1, 3]]
            row[:, k, 2] = slopes[:, 4]
            weight = weights[edge.points[which]]
            rows.append(weight[:, None] * (row * is_free).reshape(len(off), -1))
            distances.append(weight * off)
        return np.vstack(rows), np.concatenate(distances)

    def sides(values: Points) -> list[float]:
        return list(np.sign(np.sin(np.roll(values[:, 0], -1) - values[:, 0])))

    rows, off = system(found)
    damping = 1e-6
    for _ in range(30):
        normal = rows.T @ rows + damping * np.eye(3 * count)
        tried = found - np.linalg.solve(normal, rows.T @ off).reshape(count, 3)
        tried[:, 2] = np.clip(tried[:, 2], 0.0, most)
        damping *= 10
        if sides(tried) == sides(found):
            new_rows, new_off = system(tried)
            if new_off @ new_off < off @ off:
                is_done = new_off @ new_off > (1 - 1e-9) * (off @ off)
                found, rows, off, damping = tried, new_rows, new_off, max(damping / 100, 1e-12)
                if is_done:
                    break
    return [
        _Edge((a, offset * size + float(shift @ unit(a))), r * size, edge.points)
        for (a, offset, r), edge in zip(found.tolist(), edges, strict=True)
    ]


def _corners_of(edges: list[_Edge]) -> list[_Corner]:
    return [
        _Corner(e.line, edges[k].line)
        for e, k in zip(edges, [*range(1, len(edges)), 0], strict=True)
    ]


def _with_radii(edges: list[_Edge], ring: Points, limit: float) -> list[_Edge]:
    """The edges with the best radii of those corners that had none beside the lines before."""
    corners = _corners_of(edges)
    vertices = np.array([corner.centre(0.0) for corner in corners])
    lengths = np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
    found = []
    for edge, corner, room in zip(
        edges, corners, np.minimum(lengths, np.roll(lengths, 1)), strict=True
    ):
        radius = edge.radius
        if radius == 0 and 0 < corner.turn < _SHARPEST:
            most = float(room) / 2 / math.tan(corner.turn / 2)
            radius = corner.radius(ring, edge.points, most, limit, limit) or 0.0
        found.append(edge._replace(radius=radius))
    return found


def _finished(vertices: Points, radii: Points, tolerance: float) -> tuple[Points, Points]:
    """The polygon in whole micrometres, the lowest corners level, without vertices within an edge,
    and with arcs that have room."""
    for _ in range(4):
        heights = np.array([points[:, 1].min() for points in rounded(vertices, radii)])
        rises = heights - heights.min()
        vertices = vertices - np.column_stack(
            [0 * rises, np.where(rises <= _LEVEL * tolerance, rises, 0.0)]
        )
    vertices = np.round(vertices, 6)
    while True:
        before, after = (
            vertices - np.roll(vertices, 1, axis=0),
            np.roll(vertices, -1, axis=0) - vertices,
        )
        cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        if len(vertices) < 4 or (np.abs(cross) > 1e-12).all():
            break
        gone = int(np.abs(cross).argmin())
        vertices, radii = np.delete(vertices, gone, axis=0), np.delete(radii, gone)
    turns = np.arctan2(cross, (before * after).sum(axis=1))
    radii = np.where((turns > 0) & (radii > _LEAST_RADIUS * tolerance), radii, 0.0)
    takes = np.tan(turns / 2)
    both = radii * takes + np.roll(radii * takes, -1)
    parts = np.minimum(1.0, np.hypot(*after.T) / np.maximum(both, 1e-300))
    fitting = np.minimum(parts, np.roll(parts, 1))
    return vertices, np.where(
        fitting < 1, np.floor(1e6 * fitting * radii), np.round(1e6 * radii)
    ) / 1e6

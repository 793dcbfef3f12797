# SPDX-License-Identifier: Apache-2.0
"""Lines and arcs that replace a dense outline within a tolerance, and the corners made of them.

An outline is an array of points [m], x to the right and y upwards, counter-clockwise, whose first
point is not repeated. The fit goes around it once, from where its longest edge begins. Each piece
is the longest line from where the last one ended, or an arc if it goes further than two lines. An
arc that rounds the corner between two lines becomes this corner, with a radius. The other corners
of the polygon are the ends of the pieces, and points on the remaining arcs whose chords keep to the
tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from palmbots.shapes.point_arrays import Points

# Parts of the tolerance for the fit, for chords, and for levelling. First exact lines and arcs, as
# drawings have them; then what follows a scan with few corners.
_SHARES = (1.0, 0.7, 0.5, 0.35, 0.25, 0.1)
_PARTS = ((0.1, 0.8, 0.15), *((one, one, level) for one in _SHARES for level in (0.5, 1.0)))

_SHARPEST = math.radians(150)  # turn of a corner that may have a radius
_SHORTEST = 1e-5  # edge beside it [m]


@dataclass(frozen=True)
class Piece:
    """A part of a fitted outline, from `start` to the start of the next one."""

    start: Points
    """[m]"""
    radius_m: float = 0.0
    """Of an arc; 0: a line."""
    centre: Points | None = None
    sweep_rad: float = 0.0
    """Angle of the arc, counter-clockwise > 0."""


@dataclass(frozen=True)
class Fitted:
    """A polygon with rounded corners in place of an outline."""

    vertices: Points
    radii: Points
    """Of the corners [m]; 0: a sharp one."""
    arc_ends: Points
    """The ends of the arcs that chords replace, two for each."""
    deviation_m: float
    """Greatest distance between outline and polygon."""


def boundary(vertices: Points, radii: Points) -> Points:
    """Points along a polygon with rounded corners, whose chords keep to 0.1 % of each radius."""
    found: list[Points] = []
    before, after = np.roll(vertices, 1, axis=0), np.roll(vertices, -1, axis=0)
    for corner, radius, *ends in zip(vertices, radii, before, after, strict=True):
        (ax, ay), (bx, by) = ((end - corner) / np.hypot(*(end - corner)) for end in ends)
        turn = math.atan2(bx * ay - by * ax, -(ax * bx + ay * by))
        if radius == 0 or turn <= 0:
            found.append(corner)
            continue
        centre = corner + radius / math.cos(turn / 2) * _unit(np.array([ax + bx, ay + by]))
        first = math.atan2(ax, -ay)  # of the outward normal of the edge that ends here
        angles = first + np.linspace(0, turn, 2 + math.ceil(turn / 0.09))
        found.append(centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]))
    return np.vstack(found)


def _unit(vector: Points) -> Points:
    return vector / np.hypot(*vector)


def polygon_of(outline: Points, tolerance_m: float, most: int) -> Fitted:
    """The polygon with few corners that deviates by at most the tolerance.

    A body stands on its lowest corners, so corners a little above the lowest one are made level
    with it. Errors of fit, chords and levelling may add up; so the greatest deviation is measured,
    and the fit repeated with a smaller part of the tolerance until it keeps to all of it.

    Args:
        outline: dense points.
        tolerance_m: greatest deviation.
        most: corners that may be used to follow lines and arcs closely; beyond that, as few as the
            tolerance allows.
    """
    for fit, chord, level in _PARTS:
        pieces = _pieces(outline, fit * tolerance_m)
        corners, arc_ends = _corners(pieces, chord * tolerance_m)
        corners = _level(corners, level * tolerance_m)
        vertices, radii = corners[:, :2], corners[:, 2]
        stands = (vertices[:, 1] == vertices[:, 1].min()).sum() > 1
        if len(vertices) < 3 or not stands or (fit < chord and len(vertices) > most):
            continue
        if (deviation := deviation_m(outline, boundary(vertices, radii))) <= tolerance_m:
            return Fitted(vertices, radii, arc_ends, deviation)
    vertices = _level(np.pad(outline, ((0, 0), (0, 1))), 0.0)[:, :2]
    sharp = np.zeros(len(vertices))
    return Fitted(vertices, sharp, np.empty((0, 2)), deviation_m(outline, vertices))


def deviation_m(one: Points, other: Points) -> float:
    """Greatest distance of a point of either outline from the other (Hausdorff distance)."""
    return max(_farthest(one, other), _farthest(other, one))


def _farthest(points: Points, outline: Points) -> float:
    steps = np.linspace(0, 1, 8, endpoint=False)[:, None, None]
    dense = (points + steps * (np.roll(points, -1, axis=0) - points)).reshape(-1, 2)
    nearest = np.full(len(dense), math.inf)
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        np.minimum(nearest, _from_segment(dense, start, end), out=nearest)
    return float(nearest.max())


def _from_segment(points: Points, start: Points, end: Points) -> Points:
    """Distances of points from a line between two points."""
    along = end - start
    square = float(along @ along)
    if square == 0.0:
        return np.hypot(*(points - start).T)
    share = np.clip((points - start) @ along / square, 0.0, 1.0)
    return np.hypot(*(points - start - share[:, None] * along).T)


def _pieces(outline: Points, tolerance: float) -> list[Piece]:
    ring = np.roll(outline, -_start_of_longest_edge(outline, tolerance), axis=0)
    ring = np.vstack([ring, ring[:1]])
    last, at = len(ring) - 1, 0
    pieces: list[Piece] = []

    def line(i: int, j: int) -> bool:
        return bool((_from_segment(ring[i : j + 1], ring[i], ring[j]) <= tolerance).all())

    def arc(i: int, j: int) -> bool:
        return j - i < 3 or _arc(ring[i : j + 1], tolerance) is not None

    while at < last:
        end = _furthest(line, at, last)
        beyond = _furthest(line, end, last) if end < last else last
        round_end = _furthest(arc, at, last) if end < last else at
        found = _arc(ring[at : round_end + 1], tolerance) if round_end > beyond else None
        pieces.append(found or Piece(ring[at]))
        at = round_end if found else end
    return pieces


def _furthest(fits: Callable[[int, int], bool], start: int, last: int) -> int:
    """The last point up to which a piece fits: by doubling steps, then by bisection."""
    good, step = start + 1, 1
    while good + step <= last and fits(start, good + step):
        good += step
        step *= 2
    bad = min(good + step, last + 1)
    while bad - good > 1:
        middle = (good + bad) // 2
        good, bad = (middle, bad) if fits(start, middle) else (good, middle)
    return good


def _arc(points: Points, tolerance: float) -> Piece | None:
    """The arc through the first, the middle and the last point, if the others are close to it."""
    if len(points) < 4:
        return None
    a, b, c = points[0], points[len(points) // 2], points[-1]
    (px, py), (qx, qy) = b - a, c - a
    double = 2 * (px * qy - py * qx)
    if abs(double) < 1e-12 * (px * px + py * py + qx * qx + qy * qy):
        return None
    p, q = px * px + py * py, qx * qx + qy * qy
    offset = np.array([qy * p - py * q, px * q - qx * p]) / double
    centre, radius = a + offset, float(np.hypot(*offset))
    middles = (points[1:] + points[:-1]) / 2  # else the corners of a rectangle would be an arc
    off = np.abs(np.hypot(*(np.vstack([points, middles]) - centre).T) - radius)
    if off.max() > tolerance:
        return None
    angles = np.unwrap(np.arctan2(*(points - centre).T[::-1]))
    sweep = float(angles[-1] - angles[0])
    if not tolerance < radius * abs(sweep) or abs(sweep) > 2 * math.pi - 0.1:
        return None
    return Piece(a, radius, centre, sweep)


def _start_of_longest_edge(outline: Points, tolerance: float) -> int:
    """The index of the point where the longest edge of the outline, without its details, begins."""
    kept = _without_details(outline, tolerance)
    edges = np.roll(outline[kept], -1, axis=0) - outline[kept]
    return int(kept[int(np.hypot(*edges.T).argmax())])


def _without_details(outline: Points, tolerance: float) -> Any:
    """The indices of the points that Douglas and Peucker's method keeps."""
    far = int(np.hypot(*(outline - outline[0]).T).argmax())
    ring = np.vstack([outline, outline[:1]])
    kept, spans = {0, far}, [(0, far), (far, len(outline))]
    while spans:
        i, j = spans.pop()
        if j - i < 2:
            continue
        off = _from_segment(ring[i + 1 : j], ring[i], ring[j])
        if off.max() > tolerance:
            k = i + 1 + int(off.argmax())
            kept.add(k)
            spans += [(i, k), (k, j)]
    return np.array(sorted(kept))


def _corners(pieces: list[Piece], tolerance: float) -> tuple[Points, Points]:
    """Rows of x, y and radius: rounded corners, the other ends of the pieces, and the points
    between the chords of the other arcs; and the ends of those."""
    corners: list[tuple[float, float, float]] = []
    arc_ends: list[Points] = []
    rounded = [_rounded_corner(pieces, k, tolerance) for k in range(len(pieces))]
    for k, piece in enumerate(pieces):
        if (corner := rounded[k]) is not None:
            corners.append((*corner, round(piece.radius_m, 6)))
            continue
        if rounded[k - 1] is None:
            corners.append((*piece.start, 0.0))
        if piece.centre is None:
            continue
        arc_ends += [piece.start, pieces[(k + 1) % len(pieces)].start]
        most = 2 * math.acos(max(0.0, 1 - tolerance / piece.radius_m))
        count = max(1, math.ceil(abs(piece.sweep_rad) / most - 1e-9))
        x, y = piece.start - piece.centre
        for step in range(1, count):
            turn = piece.sweep_rad * step / count
            c, s = math.cos(turn), math.sin(turn)
            corners.append((*(piece.centre + np.array([c * x - s * y, s * x + c * y])), 0.0))
    return np.array(corners), np.array(arc_ends).reshape(-1, 2)


def _rounded_corner(pieces: list[Piece], k: int, tolerance: float) -> Points | None:
    """Where the lines before and after an arc meet, if the arc rounds this convex corner."""
    arc, n = pieces[k], len(pieces)
    before, after, beyond = pieces[k - 1], pieces[(k + 1) % n], pieces[(k + 2) % n]
    if arc.centre is None or n < 4 or before.centre is not None or after.centre is not None:
        return None
    if not 0 < arc.sweep_rad < _SHARPEST:
        return None
    one, other = arc.start - before.start, beyond.start - after.start
    if min(np.hypot(*one), np.hypot(*other)) < _SHORTEST:
        return None
    one, other = _unit(one), _unit(other)
    turn = math.atan2(one[0] * other[1] - one[1] * other[0], one @ other)
    if not 0 < turn < _SHARPEST:
        return None
    gap_x, gap_y = after.start - arc.start
    corner = arc.start + one * (gap_x * other[1] - gap_y * other[0]) / math.sin(turn)
    # A line may go on along the arc within the tolerance; the arc is as exact as the drawing.
    of_arc = arc.centre - arc.radius_m / math.cos(turn / 2) * _unit(other - one)
    return of_arc if np.hypot(*(of_arc - corner)) <= tolerance else None


def _level(corners: Points, tolerance: float) -> Points:
    """The corners in whole micrometres, the lowest ones level, without those within an edge."""
    found = corners.copy()
    lowest = found[:, 1].min()
    found[found[:, 1] <= lowest + tolerance, 1] = lowest
    found = np.round(found, 6)
    while len(found) > 3:
        before, after = found - np.roll(found, 1, axis=0), np.roll(found, -1, axis=0) - found
        cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        is_corner = np.abs(cross) > 1e-12
        if is_corner.all():
            break
        found = np.delete(found, int(np.abs(cross).argmin()), axis=0)
    return found

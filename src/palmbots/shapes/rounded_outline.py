# SPDX-License-Identifier: Apache-2.0
"""The outline of a polygon with rounded corners, as points, and how far outlines are apart."""

from __future__ import annotations

import math

import numpy as np

from palmbots.shapes.point_arrays import Points


def boundary(vertices: Points, radii: Points) -> Points:
    """Points along a polygon with rounded corners, whose chords keep to 0.1 % of each radius."""
    return np.vstack(rounded(vertices, radii))


def rounded(vertices: Points, radii: Points) -> list[Points]:
    """The points of each corner, with the lowest and the outermost ones of its arc."""
    found: list[Points] = []
    before, after = np.roll(vertices, 1, axis=0), np.roll(vertices, -1, axis=0)
    for corner, radius, *ends in zip(vertices, radii, before, after, strict=True):
        (ax, ay), (bx, by) = ((end - corner) / np.hypot(*(end - corner)) for end in ends)
        turn = math.atan2(bx * ay - by * ax, -(ax * bx + ay * by))
        if radius == 0 or turn <= 0:
            found.append(corner[None])
            continue
        first = math.atan2(ax, -ay)  # of the outward normal of the edge that ends here
        middle = first + turn / 2
        centre = corner - radius / math.cos(turn / 2) * np.array(unit(middle))
        quarters = np.arange(math.ceil(first / (math.pi / 2)), 9) * (math.pi / 2)
        steps = first + np.linspace(0, turn, 2 + math.ceil(turn / 0.09))
        angles = np.sort(np.r_[steps, quarters[quarters < first + turn]])
        found.append(centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]))
    return found


def deviation_m(one: Points, other: Points) -> float:
    """Greatest distance of a point of either outline from the other (Hausdorff distance)."""
    return max(_farthest(one, other), _farthest(other, one))


def _farthest(points: Points, outline: Points) -> float:
    steps = np.linspace(0, 1, 8, endpoint=False)[:, None, None]
    dense = (points + steps * (np.roll(points, -1, axis=0) - points)).reshape(-1, 2)
    nearest = np.full(len(dense), math.inf)
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        np.minimum(nearest, from_segment(dense, start, end), out=nearest)
    return float(nearest.max())


def from_segment(points: Points, start: Points, end: Points) -> Points:
    """Distances of points from a line between two points."""
    along = end - start
    square = float(along @ along)
    if square == 0.0:
        return np.hypot(*(points - start).T)
    share = np.clip((points - start) @ along / square, 0.0, 1.0)
    return np.hypot(*(points - start - share[:, None] * along).T)


def distance_of(point: Points, outline: Points) -> float:
    """Distance of a point from a closed outline."""
    along = np.roll(outline, -1, axis=0) - outline
    squares = np.maximum((along**2).sum(axis=1), 1e-300)
    shares = np.clip(((point - outline) * along).sum(axis=1) / squares, 0.0, 1.0)
    return float(np.hypot(*(outline + shares[:, None] * along - point).T).min())


def unit(angle: float) -> tuple[float, float]:
    """The vector of length 1 at an angle."""
    return math.cos(angle), math.sin(angle)

# SPDX-License-Identifier: Apache-2.0
"""One closed outline from the lines of a file: pieces that meet are joined, the largest is taken.

A piece is an array of points [m], x to the right and y upwards. It is closed if its last point is
its first one.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from palmbots._util.optional_imports import require
from palmbots.errors import PalmbotsError
from palmbots.shapes.point_arrays import Points


@dataclass(frozen=True)
class Outline:
    """The outline of a body, seen from the side."""

    points: Points
    """Counter-clockwise; the first point is not repeated."""
    holes: int
    """Outlines within it, which are ignored."""
    others: int
    """Smaller outlines beside it, which are ignored."""


def joined(pieces: Iterable[Points], gap: float) -> tuple[list[Points], list[Points]]:
    """The closed outlines, and what remains open, if ends at most `gap` apart are joined."""
    closed: list[Points] = []
    rest: dict[int, Points] = {}
    ends: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for k, piece in enumerate(pieces):
        if _is_closed(piece, gap):
            closed.append(piece)
        elif len(piece) > 1 and np.ptp(piece, axis=0).max() > gap:
            rest[k] = piece
            for end in (0, -1):
                ends.setdefault(_cell(piece[end], gap), []).append((k, end))
    opened: list[Points] = []
    while rest:
        _, chain = rest.popitem()
        for _ in range(2):  # on from its end, and then, turned around, from its start
            while not _is_closed(chain, gap) and (found := _next(chain[-1], gap, ends, rest)):
                k, end = found
                piece = rest.pop(k)
                chain = np.vstack([chain, piece[1:] if end == 0 else piece[-2::-1]])
            chain = chain[::-1]
        (closed if _is_closed(chain, gap) else opened).append(chain)
    return closed, opened


def _cell(point: Points, gap: float) -> tuple[int, int]:
    return int(np.floor(point[0] / gap)), int(np.floor(point[1] / gap))


def _next(
    point: Points, gap: float, ends: dict[Any, list[tuple[int, int]]], rest: dict[int, Any]
) -> tuple[int, int] | None:
    """The nearest end of another piece."""
    x, y = _cell(point, gap)
    near = itertools.chain.from_iterable(
        ends.get((x + dx, y + dy), ()) for dx in (-1, 0, 1) for dy in (-1, 0, 1)
    )
    found = [(float(np.hypot(*(rest[k][end] - point))), k, end) for k, end in near if k in rest]
    return min(found)[1:] if found and min(found)[0] <= gap else None


def _is_closed(piece: Points, gap: float) -> bool:
    return (
        len(piece) > 3
        and float(np.hypot(*(piece[0] - piece[-1]))) <= gap
        and float(np.ptp(piece, axis=0).max()) > 2 * gap
    )


def outline_of(closed: Sequence[Points], what: str) -> Outline:
    """The largest outline. Outlines that overlap are united.

    Args:
        closed: closed pieces.
        what: the name of the file, in a refusal.

    Raises:
        PalmbotsError: an outline crosses itself.
    """
    shapely = require("shapely", "import")
    polygons = [shapely.Polygon(piece) for piece in closed]
    polygons = [polygon for polygon in polygons if polygon.area > 0 or not polygon.is_valid]
    for polygon in polygons:
        if not polygon.is_valid:
            reason = shapely.is_valid_reason(polygon)
            x, y = map(float, reason[reason.find("[") + 1 : -1].split())
            raise PalmbotsError(
                f"{what}: the outline crosses itself at x = {1000 * x:.4g} mm, y = {1000 * y:.4g} "
                "mm, y upwards; allowed: an outline whose lines only meet at their ends"
            )
    inner = sum(any(a is not b and b.contains(a) for b in polygons) for a in polygons)
    return _largest(shapely, shapely.union_all(polygons), inner)


def silhouette_of(triangles: Points) -> Outline:
    """The largest outline of triangles, an array of three points each, seen together."""
    shapely = require("shapely", "import")
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    seen = triangles[np.abs(area) > 1e-12 * np.ptp(triangles.reshape(-1, 2), axis=0).max() ** 2]
    united = shapely.union_all(shapely.polygons(seen))
    return _largest(shapely, united, 0)


def _largest(shapely: Any, united: Any, inner: int) -> Outline:
    parts = sorted(shapely.get_parts(united), key=lambda part: part.area, reverse=True)
    parts = [part for part in parts if part.area > 1e-5 * parts[0].area]
    ring = shapely.get_coordinates(shapely.geometry.polygon.orient(parts[0]).exterior)
    gaps = [shapely.Polygon(inside).area > 1e-5 * parts[0].area for inside in parts[0].interiors]
    return Outline(ring[:-1], inner + sum(gaps), len(parts) - 1)


def area_and_centroid(outline: Points) -> tuple[float, Points]:
    """Area and centroid of an outline."""
    shapely = require("shapely", "import")
    polygon = shapely.Polygon(outline)
    return float(polygon.area), np.array(polygon.centroid.coords[0])

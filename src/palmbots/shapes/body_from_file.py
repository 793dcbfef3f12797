# SPDX-License-Identifier: Apache-2.0
"""What a file says of a body, in metres: its outline from the side, its depth and its volume."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palmbots._util.text import millimetres
from palmbots.errors import PalmbotsError
from palmbots.shapes.drawings import Drawing
from palmbots.shapes.meshes import Mesh
from palmbots.shapes.outlines import Outline, joined, outline_of, silhouette_of
from palmbots.shapes.point_arrays import Points

UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254}
"""Metres of the units that a user can name."""

_LEAST_M, _MOST_M = 0.01, 3.0  # sizes that need no confirmation
_DEPTH_M = 0.1  # of a drawing
SEEN = math.radians(0.05)
"""A turn that is worth a remark."""
_MOST_TURN = math.radians(5)  # of a body that is nearly upright


@dataclass(frozen=True)
class Given:
    """What the user says of the file."""

    name: str
    """Of the file, for messages."""
    unit: str | None
    scale: float | None
    depth_m: float | None


@dataclass(frozen=True)
class Body:
    """What the file says, in metres."""

    name: str
    outline: Outline
    view: str
    metres: float
    """Of the unit of the file, the scale included."""
    depth_m: float
    volume_m3: float | None
    """None: that of the outline times the depth."""
    centre_m: Points | None
    """None: that of the outline."""
    remarks: tuple[str, ...]


def of_drawing(drawing: Drawing, up: str, given: Given) -> Body:
    """The body that a drawing shows from the side.

    Raises:
        PalmbotsError: the drawing has no unit or a strange size, or it shows no closed outline.
    """
    if not drawing.pieces:
        raise PalmbotsError(f"{given.name}: there are no lines in it")
    points = np.vstack(drawing.pieces)
    if not np.isfinite(points).all():
        raise PalmbotsError(f"{given.name}: a coordinate is not finite")
    metres = _metres(np.ptp(points, axis=0), drawing.metres, given)
    turn = {"y": ((1, 0), (0, 1)), "-y": ((-1, 0), (0, -1)), "x": ((0, -1), (1, 0))}
    turned = np.array(turn.get(up, ((0, 1), (-1, 0)))) * metres
    pieces = [piece @ turned.T for piece in drawing.pieces]
    outline = _joined(
        pieces, metres * float(np.ptp(points, axis=0).max()), given.name, is_mesh=False
    )
    depth = given.depth_m or _DEPTH_M
    remarks = _ignored(outline)
    if given.depth_m is None:
        remarks = (*remarks, f"Its depth is assumed: {millimetres(depth)}.")
    return Body(given.name, outline, "drawing", metres, depth, None, None, remarks)


def of_mesh(mesh: Mesh, file_m: float | None, given: Given, cut: float | None) -> Body:
    """The body that a mesh describes.

    Args:
        mesh: its triangles.
        file_m: metres of the unit of the file; None: it has none.
        given: what the user says.
        cut: where the plane of the section is, as a share of the depth; None: the silhouette.

    Raises:
        PalmbotsError: the mesh has no unit or a strange size, or its section is not closed.
    """
    size = np.ptp(mesh.vertices, axis=0)[:2]
    metres = _metres(size, file_m, given)
    if cut is None:
        outline, view = silhouette_of(metres * mesh.triangles[:, :, :2]), "silhouette"
    else:
        pieces = [metres * piece for piece in mesh.cut(cut)]
        outline = _joined(pieces, metres * float(size.max()), given.name, is_mesh=True)
        view = f"section at {100 * cut:.4g} % of the depth"
    depth, volume, centre = given.depth_m or metres * mesh.depth, None, None
    if not mesh.open_edges:
        volume, middle = mesh.volume_and_centre()
        volume, centre = volume * metres**3, metres * middle[:2]
    remarks = _ignored(outline)
    if volume is not None and (bodies := mesh.overlapping()):
        remarks = (*remarks, f"{bodies} bodies may overlap; what is in two of them weighs twice.")
    if mesh.aligned > SEEN:
        angle = math.degrees(mesh.aligned)
        remarks = (f"It is turned by {angle:.2g}° to be parallel to the axes.", *remarks)
    return Body(given.name, outline, view, metres, depth, volume, centre, remarks)


def _joined(pieces: Sequence[Points], size: float, name: str, *, is_mesh: bool) -> Outline:
    """The outline of pieces whose ends meet, or nearly meet where that is not enough."""
    closed, opened = joined(pieces, (1e-12 if is_mesh else 1e-6) * size)
    if opened:
        more, opened = joined(opened, 2e-3 * size)
        closed += more
    if not closed:
        if not opened:
            raise PalmbotsError(f"{name}: there is no outline in it")
        longest = max(opened, key=lambda chain: float(np.ptp(chain, axis=0).max()))
        gap, (x, y) = float(np.hypot(*(longest[0] - longest[-1]))), 1000 * longest[-1]
        raise PalmbotsError(
            f"{name}: the outline is not closed: {millimetres(gap)} are missing at "
            f"x = {x:.4g} mm, y = {y:.4g} mm, y upwards; allowed: "
            + ("a closed mesh, or --view silhouette" if is_mesh else "a closed outline")
        )
    return outline_of(closed, name)


def _ignored(outline: Outline) -> tuple[str, ...]:
    found = []
    if outline.holes:
        what = "hole is" if outline.holes == 1 else "holes are"
        found.append(f"{outline.holes} {what} ignored.")
    if outline.others:
        what = "outline is" if outline.others == 1 else "outlines are"
        found.append(f"{outline.others} smaller {what} ignored.")
    return tuple(found)


def _metres(size: Points, file_m: float | None, given: Given) -> float:
    """Metres of the unit of the file, the scale included.

    Raises:
        PalmbotsError: there is no unit, or it gives a size that is hardly meant.
    """
    scale = given.scale or 1.0
    metres = UNITS[given.unit] if given.unit else file_m
    likely = [
        f"--unit {unit} ({_extent(size, one * scale)})"
        for unit, one in UNITS.items()
        if _is_likely(size, one * scale)
    ]
    if metres is None:
        allowed = ", ".join(likely) or f"--unit {', '.join(UNITS)} with --scale FACTOR"
        width, height = size
        raise PalmbotsError(
            f"{given.name}: has no unit, and is {width:.4g} by {height:.4g}; allowed: {allowed}"
        )
    if given.scale is None and not _is_likely(size, metres):
        allowed = ", ".join([*likely, "--scale FACTOR, or --scale 1 if that is meant"])
        raise PalmbotsError(
            f"{given.name}: is {_extent(size, metres)}, which is hardly meant; allowed: {allowed}"
        )
    return metres * scale


def _is_likely(size: Points, metres: float) -> bool:
    return _LEAST_M <= metres * float(size.max()) <= _MOST_M


def _extent(size: Points, metres: float) -> str:
    return " by ".join(
        f"{one:.3g} m" if one >= 1 else f"{1000 * one:.3g} mm" for one in metres * size
    )


def settled(points: Points, centre: Points) -> tuple[Points, Points, float]:
    """Outline and centre of mass turned so that the body stands, as it would on a floor.

    Below the centre of mass is an edge of the convex hull. It becomes level if it nearly is: a scan
    or a drawing is seldom exactly upright. The angle is that of the turn, counter-clockwise > 0
    [rad].
    """
    order = points[np.lexsort((points[:, 1], points[:, 0]))]
    hull: list[Points] = []
    for point in order:
        while len(hull) > 1 and _cross(hull[-1] - hull[-2], point - hull[-1]) <= 0:
            hull.pop()
        hull.append(point)
    pairs = [(a, b) for a, b in itertools.pairwise(hull) if a[0] < centre[0] <= b[0]]
    if not pairs:
        return points, centre, 0.0
    dx, dy = pairs[0][1] - pairs[0][0]
    turn = -math.atan2(dy, dx)
    if not 1e-6 < abs(turn) <= _MOST_TURN:
        return points, centre, 0.0
    c, s = math.cos(turn), math.sin(turn)
    matrix = np.array([[c, s], [-s, c]])
    return points @ matrix, centre @ matrix, turn


def _cross(one: Points, other: Points) -> float:
    return float(one[0] * other[1] - one[1] * other[0])


def refuse_one_point(points: Points, tolerance_m: float, body: Body) -> None:
    """Refuse an outline that stands on one point, sharp or round: it would tip over or roll.

    The part of a flat lower side that is within a quarter of the tolerance is nearly as wide as the
    part within all of it. That of an arc is half as wide, that of a nose a quarter.

    Raises:
        PalmbotsError: it stands on one point.
    """
    lowest = points[:, 1].min()
    near, far = (_below(points, lowest + share * tolerance_m) for share in (0.25, 1.0))
    if near[1] - near[0] < 0.6 * (far[1] - far[0]):
        x = 1000 * float(sum(near) / 2 - points[:, 0].min())
        other = "another --up" if body.view == "drawing" else "--align or another --up"
        raise PalmbotsError(
            f"{body.name}: stands on one point, {x:.3g} mm from its left end, and would roll or "
            f"tip; allowed: a level lower side or two level feet, as with {other}"
        )


def _below(points: Points, height: float) -> tuple[float, float]:
    """The ends, left and right, of the part of an outline below a height."""
    after = np.roll(points, -1, axis=0)
    xs = list(points[points[:, 1] <= height, 0])
    crossing = (points[:, 1] <= height) != (after[:, 1] <= height)
    for (x, y), (u, v) in zip(points[crossing], after[crossing], strict=True):
        xs.append(x + (u - x) * (height - y) / (v - y))
    return float(min(xs)), float(max(xs))

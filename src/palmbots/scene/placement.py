# SPDX-License-Identifier: Apache-2.0
"""Placement: from the rows of a trace to points of robots and object in the world frame.

Frame: x forward (left robot → right robot), y up, metres, radians; the origin is halfway between
the two pivots at the start of the carry, at their height while they carry from palms to palms. Left
is index 0 and right is index 1.
Palm angles are positive where the palm rises outward, contact coordinates where they lie outward.

The animation and the solids of the log draw what this module places.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

import palmbots._core as _core
from palmbots._core import Spec

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

_OUTWARD = np.array([-1.0, 1.0])  # world x of "outward" for left and right
_PLATES = 11 + 2 * 7  # behind seven corners of each plate


@dataclass(frozen=True)
class Placement:
    """World positions for n rows of a trace; the last axis of every point is (x, y) in metres."""

    pivot: Array  #: (n, 2 sides, 2) pivots of the palms
    palm_inner: Array  #: (n, 2 sides, 2) inward end of each palm's surface
    palm_outer: Array  #: (n, 2 sides, 2) outward end of each palm's surface
    plate: Array  #: (n, 2 sides, 7, 2) corners of each palm's cross-section
    palm_turn: Array  #: (n, 2 sides) anticlockwise turn of each palm from level, radians
    contact: Array  #: (n, 2 sides, 2) contact points on the palms: the feet of the contact vertices
    origin: Array  #: (n, 2) origin of the object's frame: its left contact vertex
    outline: Array  #: (n, m, 2) points of the object's outline, in the order of `Spec.silhouette`
    com: Array  #: (n, 2) centre of mass of the object
    turn: Array  #: (n,) anticlockwise turn of the object, radians


def place(
    spec: Spec,
    *,
    separation: ArrayLike,
    midpoint: ArrayLike,
    palm: ArrayLike,
    contact: ArrayLike,
    turn: ArrayLike,
    lift: ArrayLike = 0.0,
    height: ArrayLike = 0.0,
) -> Placement:
    """Positions from separation (n), midpoint (n), palm angle (n, 2), contact (n, 2), turn (n),
    heights of the contact vertices above the palms (n, 2), and y of the pivots (n, 2)."""
    count = np.size(separation)
    rows = [
        np.broadcast_to(np.atleast_2d(np.asarray(one, float).T).T, (count, width))
        for one, width in zip(
            (separation, midpoint, palm, contact, turn, lift, height),
            (1, 1, 2, 2, 1, 2, 2),
            strict=True,
        )
    ]
    points = _core.places(spec, np.ascontiguousarray(np.concatenate(rows, axis=1)))
    return Placement(
        pivot=points[:, 0:2],
        palm_inner=points[:, 2:4],
        palm_outer=points[:, 4:6],
        contact=points[:, 6:8],
        com=points[:, 8],
        origin=points[:, 10],
        plate=points[:, 11:_PLATES].reshape(count, 2, -1, 2),
        outline=points[:, _PLATES:],
        palm_turn=_OUTWARD * rows[2],
        turn=rows[4][:, 0],
    )


def placements(spec: Spec, trace: "xr.Dataset", rows: slice | NDArray[np.integer]) -> Placement:
    """Positions at some rows of a carry's trace."""
    chosen = trace.isel(time=rows)
    height = 0.0
    if "pivot_height" in chosen:
        height = chosen["pivot_height"].transpose("time", "side") + floor_level(spec)
    return place(
        spec,
        separation=chosen["separation"],
        midpoint=chosen["midpoint"],
        palm=chosen["palm"].transpose("time", "side"),
        contact=chosen["contact"].transpose("time", "side"),
        turn=chosen["object"],
        lift=chosen["vertex_height"].transpose("time", "side"),
        height=height,
    )


def floor_level(spec: Spec) -> float:
    """World y of the floor to draw: low enough for the robots and for any object."""
    return _core.floor_level(spec)

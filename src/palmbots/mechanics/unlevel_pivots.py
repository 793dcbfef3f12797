# SPDX-License-Identifier: Apache-2.0
"""Do properties 0, 1 and 2 hold while the pivots are at different heights?

Near the floor they are, because each palm keeps its inner end on the floor: a palm at the angle θ
has its pivot ℓ sin θ above the nose's lower edge. In the air two arms differ by their errors. Seen
along the line between the pivots, such a pair stands on a slope (`palmbots.scene.unequal_pivots`),
whose angle τ depends on where the contacts are: sin τ = rise / distance of the pivots. Each state
of a grid of contacts has its own τ; this is a sample, not a proof. A property also demands that the
object touches the palms, as if they were infinitely long, nowhere else (clearance).
Source: docs/theory/lifting.md.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots.mechanics.acting_object import acting_object
from palmbots.mechanics.contact_modes import contact_modes_batch
from palmbots.scene.spec import contact_radii

Array = NDArray[np.float64]

PROPERTIES = (0, 1, 2)
_CONTACTS = 5  # places on each palm
_TURNS = 4  # angles of a palm that turns
_ROUNDS = 6  # the distance depends on τ; each round has a small part of the last error
_HALVINGS = 12
_STEEPEST = math.radians(89)
_TOUCH = 1e-6  # m; what is deeper than that below a palm's line touches it
_UP = {"left": 3, "right": 1}  # index of the contact mode in which only this contact slides up
_DOWN = {"left": 6, "right": 2}


@dataclass(frozen=True)
class _Poses:
    """Poses of the palms with all their contacts, one column for each state."""

    number: Array
    closing: Array
    """The contact mode that has to occur on closing; −1: any."""
    opening: Array
    theta: Array
    p: Array


class PivotRises:
    """The properties of a scene's palms for a rise of the right pivot over the left one.

    `share`: of the usable palm, on whose inner part the contacts are.
    """

    def __init__(self, spec: _core.Spec, share: float = 1.0) -> None:
        self._spec = spec
        columns = [np.concatenate(part, axis=-1) for part in zip(*_poses(spec, share), strict=True)]
        self._poses = poses = _Poses(*columns)
        palms = spec.palms
        heights = [
            np.array([palm.lowest_pivot(float(angle)) for angle in row])
            for palm, row in zip(palms, poses.theta, strict=True)
        ]
        self._on_floor = heights[1] - heights[0]

    def on_floor(self, more_m: float = 0.0, clear: bool = True) -> frozenset[int]:
        """The properties that hold with both inner ends on the floor, and the right pivot higher by
        a further length. `clear`: they demand clearance."""
        return self._holding(self._on_floor + more_m, clear)

    def in_air(self, rise_m: float = 0.0, clear: bool = True) -> frozenset[int]:
        """The properties that hold with the right pivot this much higher."""
        return self._holding(np.full_like(self._on_floor, rise_m), clear)

    def permitted_m(self, on_floor: bool = False, clear: bool = True) -> float:
        """The largest further height difference, of either sign, with which all properties hold;
        0: they do not hold without one."""
        holding = self.on_floor if on_floor else self.in_air

        def holds(size: float) -> bool:
            return all(len(holding(sense * size, clear)) == len(PROPERTIES) for sense in (1, -1))

        if not holds(0.0):
            return 0.0
        low, high = 0.0, 0.5 * self._spec.width
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if holds(middle) else (low, middle)
        return low

    def _holding(self, rise: Array, clear: bool) -> frozenset[int]:
        spec, poses = self._spec, self._poses
        left, right = spec.palms
        p, tilt = poses.p, np.zeros_like(rise)
        for _ in range(_ROUNDS):
            theta = np.stack([poses.theta[0] + tilt, poses.theta[1] - tilt])
            theta = np.clip(theta, -_STEEPEST, _STEEPEST)  # such a pair holds nothing
            acting = acting_object(spec, theta, p)
            out = [
                place * np.cos(angle) - palm.offset * np.sin(angle)
                for palm, place, angle in zip((left, right), p, theta, strict=True)
            ]
            with np.errstate(invalid="ignore", divide="ignore"):
                tilt = np.arcsin(np.clip(rise / (acting.dx - out[0] - out[1]), -1.0, 1.0))
            tilt = np.nan_to_num(tilt)
        spans = np.isfinite(acting.dx)
        own = {
            name: np.where(spans, values, 1.0)
            for name, values in (
                ("width", acting.width),
                ("com_x", acting.com_left),
                ("com_y", acting.com_height),
            )
        }
        modes = contact_modes_batch(
            **own, theta_left=theta[0], theta_right=theta[1], p_left=p[0], p_right=p[1],
            friction_left=left.friction, friction_right=right.friction,
            offset_left=left.offset, offset_right=right.offset,
            slope=np.tan(math.atan(spec.slope) + tilt),
        )  # fmt: skip
        right_way = [
            (wanted < 0) | (found == wanted)
            for wanted, found in ((poses.closing, modes.closing), (poses.opening, modes.opening))
        ]
        good = spans & modes.feasible[:, 0] & right_way[0] & right_way[1]
        if clear:
            good &= self._is_clear(theta)
        return frozenset(n for n in PROPERTIES if bool(good[poses.number == n].all()))

    def _is_clear(self, theta: Array) -> NDArray[np.bool_]:
        """Whether the outline is above the lines of both palms, seen along the line of pivots."""
        spec, p = self._spec, self._poses.p
        acting = acting_object(spec, theta, p)
        normals = [
            np.stack([s * np.sin(t), np.cos(t)]) for s, t in zip((1, -1), theta, strict=True)
        ]
        dx, dy = (np.where(np.isfinite(one), one, 1.0) for one in (acting.dx, acting.dy))
        touching = [np.zeros((2, dx.size)), np.stack([dx, dy])]
        radii = contact_radii(spec)
        centres = [at + r * n for at, r, n in zip(touching, radii, normals, strict=True)]
        x, y = centres[1] - centres[0]
        cos, sin = x / np.hypot(x, y), y / np.hypot(x, y)
        u, v = (np.array(axis)[:, np.newaxis] for axis in zip(*spec.silhouette, strict=True))
        points = centres[0][0] + u * cos - v * sin, centres[0][1] + u * sin + v * cos
        clear = np.ones(dx.size, bool)
        for at, n in zip(touching, normals, strict=True):
            above = (points[0] - at[0]) * n[0] + (points[1] - at[1]) * n[1]
            clear &= above.min(axis=0) >= -_TOUCH
        return clear


def _poses(spec: _core.Spec, share: float) -> Iterator[tuple[Array, ...]]:
    reaches = [0.5 * share * palm.usable for palm in spec.palms]
    ends = [(-reach, reach) for reach in reaches]
    angles = [(palm.shallow, palm.steep) for palm in spec.palms]
    for k, side in enumerate(SIDES):
        pair = _pair(angles, k, angles[k][0])
        inward = [(low, 0.0) if i == k else (low, high) for i, (low, high) in enumerate(ends)]
        outward = [(0.0, high) if i != k else (low, high) for i, (low, high) in enumerate(ends)]
        other: Side = SIDES[1 - k]
        yield _grid(1, pair, inward, closing=_UP[side])
        yield _grid(2, pair, outward, opening=_DOWN[other])
        for step in range(_TURNS + 1):
            share = step / _TURNS
            pair = _pair(angles, k, angles[k][0] + share * (angles[k][1] - angles[k][0]))
            # Palms turn where property 1 or 2 applies, before it or after it.
            yield _grid(0, pair, inward)
            yield _grid(0, pair, outward)
    yield _grid(0, (angles[0][0], angles[1][0]), ends)
    yield _grid(0, (angles[0][1], angles[1][1]), ends)


def _pair(angles: list[tuple[float, float]], side: int, own: float) -> tuple[float, float]:
    return (own, angles[1][1]) if side == 0 else (angles[0][1], own)


def _grid(
    number: int,
    pair: tuple[float, float],
    ends: list[tuple[float, float]],
    closing: int = -1,
    opening: int = -1,
) -> tuple[Array, ...]:
    places = np.meshgrid(*(np.linspace(*one, _CONTACTS) for one in ends), indexing="ij")
    p = np.stack([axis.ravel() for axis in places])
    n = p.shape[1]
    theta = np.stack([np.full(n, angle) for angle in pair])
    return np.full(n, number), np.full(n, closing), np.full(n, opening), theta, p

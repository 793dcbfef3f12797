# SPDX-License-Identifier: Apache-2.0
"""Lateral slip of an object on two palms with a yaw misalignment: statics seen from above.

Frame: x from the left palm to the right one, y to the left of it, metres, radians, forces in
weights. On a path with curvature κ > 0 (to the left), two palms at a distance d are turned by ∓β
against the object, sin β = κ d / 2, so both slope towards the outside of the curve by tan θ sin β.
Contacts that stick do not slip. For a sliding contact:

- its friction points along the palm and its weight pulls down the lateral slope, both outward;
- palms at different angles require different roll angles of the object: it stands on a diagonal,
  and the squeeze H at both ends turns it outward too.

With θ_k, friction angle φ_k and load V_k of each palm, H is the smaller upper end V tan(θ + φ) of
the squeeze intervals on closing, the larger lower end V tan(θ − φ) on opening (docs/mechanics), and
N_k = V_k cos θ_k + H sin θ_k. On each palm the two ends of the edge share the load. They differ in
height by a warp h = 2 c (tan θ_R − tan θ_L) sin β, where c is half the supported length. With
contacts that are compressed by δ under their share of the weight, the centres of pressure lie
± c h / (4 δ) from that of the object, at most at the ends. Given these forces, the quasistatic
motion is that of least power (Peshkin and Sanderson 1989): friction μ N |slip| plus weight V times
the height gained, minimised over the object's velocity (v_x, v_y, ω) with the palms driven together
or apart.

The model has no fitted parameter. It neglects the distance of the contacts from the pivots, and the
height of the COM except for its shift by the roll.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

_SMOOTH = 1e-3  # fraction of the driving speed over which friction changes its sign
_ROUNDS, _ENOUGH = 400, 1e-5


@dataclass(frozen=True)
class Pair:
    """Two palms and their load; pairs are (left, right)."""

    friction: tuple[float, float]
    load: tuple[float, float]
    """Fractions of the weight."""
    apart: float
    """Distance of the two contacts [m]."""
    half: float
    """Half the length of the edge that lies on a palm [m]."""
    com_height: float
    """Height of the COM above the contacts [m]."""
    give: float
    """Compression of a contact under its share of the weight [m]."""


@dataclass(frozen=True)
class Slip:
    """The slip while the palms are driven together or apart by one metre; the last axis is (left,
    right)."""

    along: Array
    """Slide of each contact along its palm, outward [m]."""
    across: Array
    """Lateral slip of each contact, towards the centre of the curve [m]."""

    @property
    def rate(self) -> Array:
        """Lateral slip for each metre of sliding, over both contacts."""
        return self.across.sum(-1) / np.maximum(1e-9, np.abs(self.along).sum(-1))


def slip(
    pair: Pair,
    angles: tuple[ArrayLike, ArrayLike],
    beta: ArrayLike,
    closing: ArrayLike,
    aside: ArrayLike = 0.0,
) -> Slip:
    """The slip at palm angles θ and a misalignment β ≥ 0 [rad]; arguments are broadcast.

    `aside` is the offset of the object from the middle of its palms [m], > 0 towards the centre of
    the curve.
    """
    left, right, beta, closing, aside = np.broadcast_arrays(*angles, beta, closing, aside)
    theta = np.stack([left, right], axis=-1).astype(float)
    beta, aside = beta.astype(float), aside.astype(float)
    sense = np.where(closing, 1.0, -1.0)
    out, load, friction = np.array([-1.0, 1.0]), np.array(pair.load), np.array(pair.friction)
    tangent = np.tan(theta)

    ends = load * np.tan(theta + sense[..., None] * np.arctan(friction))
    squeeze = np.where(closing, ends.min(-1), ends.max(-1))[..., None]
    normal = np.maximum(0.0, load * np.cos(theta) + squeeze * np.sin(theta))
    roll = 0.5 * tangent.sum(-1) * np.sin(beta)
    warp = (tangent[..., 1] - tangent[..., 0]) * np.sin(beta) * 2 * pair.half
    middle = aside - pair.com_height * roll
    room = np.maximum(0.0, pair.half - np.abs(middle))
    apart = np.clip(pair.half * warp / (4 * pair.give), -room, room)
    pressure = np.clip((middle[..., None] + out * apart[..., None]) / pair.half, -1, 1)

    # For both ends of the edge on both palms; axes: …, palm, end, x and y.
    cos, sin = np.cos(beta)[..., None], np.sin(beta)[..., None] * out
    along = np.stack([cos + 0 * sin, sin], axis=-1)
    left_of = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    arm = pair.half * left_of[..., None, :] * out[:, None]
    place = arm + np.stack([out * pair.apart / 2, 0 * out], axis=-1)[:, None]
    share = 0.5 * (1 + pressure[..., None] * out)
    bound = (friction * normal)[..., None] * share
    slope = (load * out * tangent)[..., None, None] * share[..., None] * along[..., None, :]
    # The left palm moves along its heading and turns with its path.
    turn = (2 * np.sin(beta) / pair.apart)[..., None, None, None]
    turned = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
    drive = sense[..., None, None, None] * (along[..., None, :] + turn * turned)
    drive = drive * np.array([1.0, 0.0])[:, None, None]

    axes = np.stack([along / np.cos(theta)[..., None], left_of], axis=-2)
    v = _least_power(place, drive, axes, bound, slope, pair.apart / 2)
    moved = np.einsum("...kij,...kej->...kei", axes, v).mean(axis=-2)
    return Slip(along=out * moved[..., 0], across=moved[..., 1])


def _least_power(
    place: Array, drive: Array, axes: Array, bound: Array, slope: Array, scale: float
) -> Array:
    """The slips v of all contacts (…, palm, end, x and y) with the least power.

    The power is the sum of bound |A v| and slope · v, minimised over the object's velocity by
    iteratively reweighted least squares with weights bound / |A v|; each iteration lowers it.
    """
    one, none = np.ones_like(bound), np.zeros_like(bound)
    # v = J q − drive, where q is v_x, v_y and the turning speed times `scale`.
    jacobian = np.stack(
        [
            np.stack([one, none, -place[..., 1] / scale], axis=-1),
            np.stack([none, one, place[..., 0] / scale], axis=-1),
        ],
        axis=-2,
    )
    seen = np.einsum("...kij,...kejq->...keiq", axes, jacobian)
    driven = np.einsum("...kij,...kej->...kei", axes, drive)
    pull = np.einsum("...kejq,...kej->...q", jacobian, slope)
    q = np.zeros((*bound.shape[:-2], 3))
    for _ in range(_ROUNDS):
        u = np.einsum("...keiq,...q->...kei", seen, q) - driven
        weight = bound / np.sqrt((u * u).sum(-1) + _SMOOTH**2)
        matrix = np.einsum("...ke,...keiq,...keip->...qp", weight, seen, seen)
        wanted = np.einsum("...ke,...keiq,...kei->...q", weight, seen, driven) - pull
        before, q = q, np.linalg.solve(matrix, wanted[..., None])[..., 0]
        if np.abs(q - before).max() < _ENOUGH:
            break
    return np.einsum("...kejq,...q->...kej", jacobian, q) - drive

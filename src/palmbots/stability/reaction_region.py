# SPDX-License-Identifier: Apache-2.0
"""The operating region that a scene's numbers imply: how far outward the contacts move.

A sensor detects an error when the contact leaves the zero zone. Until the correction begins, the
contact drifts with the relative speed of the robots. The reaction time is that of the distributed
algorithm (Table 2): a robot with a negative contact turns its own palm first. A robot with a
positive contact asks its partner and waits, in the worst case until the partner has finished a
correction of its own. A turning palm moves the contacts as well. The drift is assumed to be the
sum of both biases and three standard deviations of the combined noise of both robots.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palmbots._types import SIDES
from palmbots.control.dead_band import overrun_m, zero_zone_edges_m
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

_SIGMAS = 3.0
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reaction:
    """Reaction times and reach at palm angles (shallow, steep) [rad]; arrays broadcast."""

    own_s: Array
    """Time from leaving the zero zone to moving, with a negative contact, case (d)."""
    asked_s: Array
    """The same with a positive contact, case (a), and a partner that is not correcting."""
    reach_m: Array
    """Largest distance of a contact from the pivot in the worst case, on either palm."""
    beyond_m: float
    """How far a correction continues past p = 0."""


def reaction(scene: Scene, shallow: ArrayLike, steep: ArrayLike) -> Reaction:
    """Reaction times of a scene and the region of contacts that they imply."""
    shallow, steep = np.asarray(shallow, float), np.asarray(steep, float)
    turn = np.abs(steep - shallow)
    rate = min(math.radians(scene.palm_of(side).rate_deg_s) for side in SIDES)
    period = scene.control.period_s
    # A message is read at the first tick after its latency.
    message = to_spec(scene, unrolled=True).longest_delay + period
    own = period + turn / rate
    asked = period + 2 * message + turn / rate

    robots = [scene.robot_of(side) for side in SIDES]
    lasting = sum(abs(r.bias_m_s) + abs(r.gain - 1) * r.speed_m_s for r in robots)
    random = math.hypot(*(x for r in robots for x in (r.noise_m_s, r.gain_sd * r.speed_m_s)))
    white = math.hypot(*(r.white_noise_m_per_sqrt_s for r in robots)) / np.sqrt(own)
    drift = lasting + _SIGMAS * np.hypot(random, white)
    low, high = zero_zone_edges_m(scene)
    half = max(palm.reach_m for palm in map(scene.palm_of, SIDES))
    edge = min(max(-low, high), half)
    offset = max(abs(scene.palm_of(side).pivot_offset_m) for side in SIDES)
    speed = max(min(r.correction_m_s for r in robots), 1e-9)

    negative = edge + drift * own
    busy = (
        own + negative / speed + turn / rate
    )  # the partner's correction, and its palm turning back
    positive = edge + drift * (asked + busy)
    reach = np.maximum(negative, positive)
    # While a palm turns by Δθ, its surface carries a contact at p by about (p sin θ + o cos θ) Δθ.
    reach = reach + (reach * np.abs(np.sin(steep)) + offset) * turn
    return Reaction(own, asked, reach, max(0.0, overrun_m(scene, "distributed") - edge))


def implied_reach_m(scene: Scene) -> float:
    """The reach of the contacts at the scene's own angles, at most that of the palms [m]."""
    palms = [scene.palm_of(side) for side in SIDES]
    angles = [(math.radians(palm.shallow_deg), math.radians(palm.steep_deg)) for palm in palms]
    reach = reaction(scene, *(np.array(ends) for ends in zip(*angles, strict=True))).reach_m
    return min(float(reach.max()), *(palm.reach_m for palm in palms))

"""How far out the contacts get: the operating region that a scene's own numbers imply.

A contact is seen to be off when it leaves the zero zone, at its edge. Until it is corrected it
drifts on with the relative speed of the robots, for as long as the distributed algorithm takes
(Table 2): a robot with a negative contact turns its own palm first; one with a positive contact
asks its partner and waits, in the worst case until the partner has finished a correction of its
own. The turning palm itself moves the contacts, too. Assumed: the drift is both biases and three
standard deviations of both robots' noise together.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palmbots.deadband import overrun_m, zero_zone_edges_m
from palmbots.scene import Scene
from palmbots.sections import SIDES

__all__ = ["Reaction", "reaction"]

_SIGMAS = 3.0
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reaction:
    """What the scene implies at palm angles (shallow, steep) [rad]; arrays broadcast."""

    own_s: Array
    """From leaving the zero zone to moving, with a negative contact, case (d)."""
    asked_s: Array
    """The same with a positive contact, case (a), with a partner that is free."""
    reach_m: Array
    """How far out a contact may get in the worst case, on either palm."""
    beyond_m: float
    """How far past p = 0 a correction runs on."""


def reaction(scene: Scene, shallow: ArrayLike, steep: ArrayLike) -> Reaction:
    """Reaction times and the region of contacts they imply."""
    shallow, steep = np.asarray(shallow, float), np.asarray(steep, float)
    turn = np.abs(steep - shallow)
    rate = min(math.radians(scene.palm_of(side).rate_deg_s) for side in SIDES)
    period = scene.control.period_s
    # A letter takes its way and is read at the next tick.
    letter = scene.radio.latency_s + scene.radio.jitter_s + period
    own = period + turn / rate
    asked = period + 2 * letter + turn / rate

    robots = [scene.robot_of(side) for side in SIDES]
    drift = sum(abs(r.bias_m_s) for r in robots) + _SIGMAS * math.hypot(
        *(r.noise_m_s for r in robots)
    )
    low, high = zero_zone_edges_m(scene)
    half = max(palm.length_m for palm in map(scene.palm_of, SIDES)) / 2
    edge = min(max(-low, high), half)
    offset = max(abs(scene.palm_of(side).pivot_offset_m) for side in SIDES)
    speed = max(min(r.correction_m_s for r in robots), 1e-9)

    negative = edge + drift * own
    busy = own + negative / speed + turn / rate  # the partner's own correction, and its palm back
    positive = edge + drift * (asked + busy)
    reach = np.maximum(negative, positive)
    # While a palm turns by Δθ, its surface carries a contact at p by about (p sin θ + o cos θ) Δθ.
    reach = reach + (reach * np.abs(np.sin(steep)) + offset) * turn
    return Reaction(own, asked, reach, max(0.0, overrun_m(scene, "distributed") - edge))

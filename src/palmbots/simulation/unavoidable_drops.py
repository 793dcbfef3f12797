# SPDX-License-Identifier: Apache-2.0
"""Whether braking could have prevented a drop.

A sensor reports nothing as long as a contact is in the zero zone. The earliest instant at which a
controller can know of an error is therefore the first control step after the contact has left the
zone for the last time. From then on both robots can brake the contact with their accelerations and
no more. A drop is *unavoidable* if that could not have stopped it before the end of the palm. The
test uses scene and trace alone, and the true contact, not what the sensor reads: a sensor that
flickers or is stuck does not make a drop unavoidable.
"""

import math

import numpy as np

from palmbots._types import SIDES
from palmbots.control.dead_band import zero_zone_edges_m
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.simulation.result import Carry


def largest_acceleration_m_s2(scene: Scene) -> float:
    """The largest acceleration of a contact along its palm, by both robots together [m/s²].

    The steepest palm turns a distance along the floor into the longest distance along a palm.
    """
    palms = [scene.palm_of(side) for side in SIDES]
    steepest = max(abs(angle) for palm in palms for angle in (palm.steep_deg, palm.shallow_deg))
    robots = sum(scene.robot_of(side).acceleration_m_s2 for side in SIDES)
    return robots / math.cos(math.radians(steepest))


def is_unavoidable(carry: Carry) -> bool:
    """Whether full braking could not have kept the contact on its palm, if it began in the first
    control step after the contact left the zero zone for the last time.

    Drops for any other reason than a contact off its palm count as avoidable.

    Raises `PalmbotsError` for a carry that was not dropped, or has no trace.
    """
    if carry.outcome != "dropped" or carry.trace is None:
        raise PalmbotsError("carry: it was not dropped, or has no trace")
    if carry.reason != "off-palm":
        return False
    contacts = carry.trace["contact"].to_numpy()
    return left_palm_unavoidably(carry.scene, carry.trace["time"].to_numpy(), contacts)


def left_palm_unavoidably(scene: Scene, times: np.ndarray, contacts: np.ndarray) -> bool:
    """The same for a carry that ended because a contact left its palm.

    Args:
        scene: the scene.
        times: of the last ticks [s]; shape (ticks,).
        contacts: the contact coordinates [m]; shape (ticks, 2).
    """
    halves = [scene.palm_of(side).reach_m for side in SIDES]
    side = int(np.argmax(np.abs(contacts[-1]) - halves))
    contact = contacts[:, side]

    low, high = zero_zone_edges_m(scene)
    in_zone = np.nonzero((contact >= low) & (contact <= high))[0]
    left_zone_s = times[in_zone[-1]] if in_zone.size else times[0]
    braking_s = times[-1] - left_zone_s - scene.control.period_s
    if braking_s <= 0 or len(times) < 2:
        return True
    # With full braking from then on the contact would be this far from the end of the palm now,
    # and this fast.
    acceleration = largest_acceleration_m_s2(scene)
    spare_m = acceleration * braking_s**2 / 2
    outward_m_s = abs(contact[-1] - contact[-2]) / (times[-1] - times[-2])
    speed = outward_m_s - acceleration * braking_s
    return bool(speed > 0 and speed**2 / (2 * acceleration) > spare_m)

# SPDX-License-Identifier: Apache-2.0
"""Whether any controller with this radio could have prevented a drop.

A contact that runs off its palm left the zero zone some time before. If that time is shorter than
the longest response time of the resilient algorithm, the drop was *unavoidable*; otherwise the
algorithm is at fault. The test uses scene and trace alone, independently of every controller.
"""

import numpy as np

from palmbots._types import SIDES
from palmbots.control.resilient_timing import bounds_of
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.simulation.result import Carry

__all__ = ["is_unavoidable", "response_s"]


def response_s(scene: Scene) -> float:
    """The longest time until the response to a contact off its zero zone has begun [s].

    The partner may have to stop waiting for a robot that it no longer hears (a lease), lower its
    palm (a hold and a turn), turn it up again for its own contact and down once more, and two
    messages must each make a round trip.
    """
    bounds = bounds_of(scene)
    palms = [scene.palm_of(side) for side in SIDES]
    turn = max((palm.steep_deg - palm.shallow_deg) / palm.rate_deg_s for palm in palms)
    round_trip = 2 * (bounds.delay_s + bounds.beacon_s)
    return bounds.lease_s + bounds.hold_s + 3 * turn + 2 * round_trip


def is_unavoidable(carry: Carry) -> bool:
    """Whether a contact of a dropped carry went from the zero zone to the end of its palm in less
    than the response time. Drops for any other reason are avoidable.

    Raises `PalmbotsError` for a carry that was not dropped, or has no trace.
    """
    if carry.outcome != "dropped" or carry.trace is None:
        raise PalmbotsError("drops: the carry was not dropped, or has no trace")
    if carry.reason != "off-palm":
        return False
    contacts = np.abs(carry.trace["contact"].to_numpy())
    halves = [carry.scene.palm_of(side).length_m / 2 for side in SIDES]
    side = int(np.argmax(contacts[-1] - halves))
    times = carry.trace["time"].to_numpy()
    zero = carry.trace["sign"].to_numpy()[:, side] == 0
    left_zone = times[np.nonzero(zero)[0][-1]] if zero.any() else times[0]
    return bool(times[-1] - left_zone < response_s(carry.scene))

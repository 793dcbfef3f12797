"""Whether a drop could have been prevented by any controller that is as far away as the radio is.

A contact that runs off its palm left the zero zone some time before. If that was less than the time
in which the resilient algorithm answers at the latest, the drop was *forced*; otherwise it is the
algorithm's fault. Worked out from scene and trace alone, apart from every controller.
"""

import numpy as np

from palmbots.bounds import bounds_of
from palmbots.errors import PalmbotsError
from palmbots.result import Carry
from palmbots.scene import Scene
from palmbots.sections import SIDES

__all__ = ["is_forced", "response_s"]


def response_s(scene: Scene) -> float:
    """The time after which an answer to a contact that is off must have begun [s].

    The partner may have to give up somebody it no longer hears (a lease), lower its palm (a hold
    and a turn), turn it up again for its own contact and down once more, and two letters must each
    make a round trip.
    """
    bounds = bounds_of(scene)
    palms = [scene.palm_of(side) for side in SIDES]
    turn = max((palm.steep_deg - palm.shallow_deg) / palm.rate_deg_s for palm in palms)
    round_trip = 2 * (bounds.delay_s + bounds.beacon_s)
    return bounds.lease_s + bounds.hold_s + 3 * turn + 2 * round_trip


def is_forced(carry: Carry) -> bool:
    """Whether a dropped carry's contact went from the zero zone to the end of the palm in less than
    the bounded response time. Drops for any other reason are not forced.

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

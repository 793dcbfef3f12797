"""The room between the palms: under a narrow object they would run into each other.

Frame and symbols as in MECHANICS section 1. No world here lets one palm push the other, so a scene
in which they stand in the same place is carried all the same; that has to be said.
"""

import math

from palmbots.frame import object_frame
from palmbots.geometry import SIDES
from palmbots.scene import Scene

__all__ = ["overlap_m"]


def overlap_m(scene: Scene) -> float:
    """How far the palms reach past each other at the start, steep [m]; negative: the gap.

    From its contact a palm reaches inward by half its length, and by p more.
    """
    thing = scene.object
    w = object_frame(thing.vertices_m, thing.contacts, thing.com_m).width
    reach, rise = 0.0, []
    for side, p in zip(SIDES, (scene.start.left_m, scene.start.right_m), strict=True):
        palm = scene.palm_of(side)
        angle = math.radians(palm.steep_deg)
        reach += (p + 0.5 * palm.length_m) * math.cos(angle)
        rise.append(p * math.sin(angle) + palm.pivot_offset_m * math.cos(angle))
    z = rise[1] - rise[0]
    return reach - math.sqrt(max(w * w - z * z, 0.0))

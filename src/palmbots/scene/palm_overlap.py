# SPDX-License-Identifier: Apache-2.0
"""The gap between the palms, which would collide under a narrow object.

No simulator models contact between the palms. If they would overlap, the simulation continues and
`carry` prints a warning.
"""

import math

from palmbots._types import SIDES
from palmbots.scene.object_frame import object_frame
from palmbots.scene.scene import Scene


def overlap_m(scene: Scene) -> float:
    """Overlap of the palms at the start, both steep [m]; negative: the gap between them.

    A palm extends inward from its contact by half its length plus the contact coordinate p.
    """
    item = scene.object
    w = object_frame(item.vertices_m, item.contacts, item.com_m).width
    reach, rise = 0.0, []
    for side, p in zip(SIDES, (scene.start.left_m, scene.start.right_m), strict=True):
        palm = scene.palm_of(side)
        angle = math.radians(palm.steep_deg)
        reach += (p + 0.5 * palm.length_m) * math.cos(angle)
        rise.append(p * math.sin(angle) + palm.pivot_offset_m * math.cos(angle))
    z = rise[1] - rise[0]
    return reach - math.sqrt(max(w * w - z * z, 0.0))

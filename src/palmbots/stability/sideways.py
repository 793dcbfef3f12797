"""The third dimension: does the object tip over the side of the palms?

Each contact is a line across the palm, as long as palm and object overlap. The object is
carried with its middle over the palms' middle; the lines' four ends span the support polygon (a
trapezoid seen from above), and the COM projects into it.
"""

import math
from dataclasses import dataclass

from palmbots.frame import object_frame
from palmbots.scene import Scene

__all__ = ["Sideways", "sideways_of"]


@dataclass(frozen=True)
class Sideways:
    """Support across the direction of travel."""

    support_m: tuple[tuple[float, float], ...]
    """Corners of the support polygon, (along the object from its left contact, across)."""
    margin_m: float
    """Distance of the COM from the nearer side of the polygon, seen from above."""
    tilt_rad: float
    """The sideways tilt of floor or robots at which the object tips."""
    acceleration_g: float
    """The sideways acceleration, in g, at which it tips."""


def sideways_of(scene: Scene) -> Sideways:
    """The support polygon of a level object and its margin."""
    thing = scene.object
    frame = object_frame(thing.vertices_m, thing.contacts, thing.com_m)
    left, right = (
        0.5 * min(thing.depth_m, scene.palm_of(side).width_m) for side in ("left", "right")
    )
    corners = ((0.0, -left), (frame.width, -right), (frame.width, right), (0.0, left))
    share = frame.com.from_left / frame.width
    across = left + (right - left) * share
    margin = across * math.cos(math.atan2(right - left, frame.width))
    ratio = margin / frame.com.height
    return Sideways(corners, margin, math.atan(ratio), ratio)

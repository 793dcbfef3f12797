# SPDX-License-Identifier: Apache-2.0
"""Lateral tipping: whether the object tips over the side of the palms.

Each contact is a line across the palm, as long as palm and object overlap. The object is centred
on the palms. The four ends of the lines span the support polygon, a trapezoid seen from above,
and the COM projects into it.
"""

import math
from dataclasses import dataclass

from palmbots._types import SIDES
from palmbots.scene.object_frame import object_frame
from palmbots.scene.scene import Scene


@dataclass(frozen=True)
class Sideways:
    """Support across the direction of travel."""

    support_m: tuple[tuple[float, float], ...]
    """Corners of the support polygon, (along the object from its left contact, across)."""
    margin_m: float
    """Distance of the COM from the nearer side of the polygon, in plan view."""
    tilt_rad: float
    """Lateral tilt of the floor at which the object tips."""
    acceleration_g: float
    """Lateral acceleration at which the object tips, in g."""


def sideways_of(scene: Scene) -> Sideways:
    """The support polygon of a level object and its margin."""
    body = scene.object
    frame = object_frame(body.vertices_m, body.contacts, body.com_m)
    left, right = (0.5 * min(body.depth_m, scene.palm_of(side).width_m) for side in SIDES)
    corners = ((0.0, -left), (frame.width, -right), (frame.width, right), (0.0, left))
    share = frame.com.from_left / frame.width
    across = left + (right - left) * share
    margin = across * math.cos(math.atan2(right - left, frame.width))
    ratio = margin / frame.com.height
    return Sideways(corners, margin, math.atan(ratio), ratio)

# SPDX-License-Identifier: Apache-2.0
"""The object frame: coordinates of the object relative to its two contact vertices.

Frame: origin at the left contact vertex, x towards the right one, y up, metres.
Every coordinate along x is given twice, from the left and from the right contact, by the same
formula. A mirrored object therefore has the same numbers, swapped, to the last bit. For the same
reason a height is the mean of the heights above both contacts. Only + − × ÷ √ are used, whose
results IEEE 754 defines exactly.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from palmbots.scene.polygon import Point, winding


@dataclass(frozen=True)
class Corner:
    """A point of the object [m]; `from_left` + `from_right` is the width, up to rounding."""

    from_left: float
    from_right: float
    height: float


@dataclass(frozen=True)
class ObjectFrame:
    """The object in its own frame [m].

    `outline` is counter-clockwise and starts at the left contact vertex; `contact_right` is the
    index of the right one in it.
    """

    width: float
    com: Corner
    outline: tuple[Corner, ...]
    contact_right: int


def object_frame(vertices: Sequence[Point], contacts: tuple[int, int], com: Point) -> ObjectFrame:
    """The frame of a simple polygon that rests on the vertices `contacts` (left, right)."""
    left, right = (vertices[i] for i in contacts)
    dx = right[0] - left[0]
    dy = right[1] - left[1]
    width = math.sqrt(dx * dx + dy * dy)
    ex, ey = dx / width, dy / width

    def corner(point: Point) -> Corner:
        lx, ly = point[0] - left[0], point[1] - left[1]
        rx, ry = right[0] - point[0], right[1] - point[1]
        # Adding 0.0 turns −0.0 into 0.0; a mirrored object could differ in this bit only.
        return Corner(
            from_left=(lx * ex + ly * ey) + 0.0,
            from_right=(rx * ex + ry * ey) + 0.0,
            height=0.5 * ((ly * ex - lx * ey) + (rx * ey - ry * ex)) + 0.0,
        )

    count = len(vertices)
    step = winding(vertices)
    order = [(contacts[0] + step * k) % count for k in range(count)]
    contact_right = order.index(contacts[1])
    outline = [corner(vertices[i]) for i in order]
    outline[0] = Corner(0.0, width, 0.0)  # exact, whatever the rounding above
    outline[contact_right] = Corner(width, 0.0, 0.0)
    return ObjectFrame(width, corner(com), tuple(outline), contact_right)

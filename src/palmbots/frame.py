"""The object frame: the object as the mechanics see it, from its two contact vertices.

Origin at the left contact vertex, x towards the right one, y up (MECHANICS.md section 1), metres.
Along x everything is given twice, from the left contact and from the right one, each by the same
formula: a mirrored object then has the same numbers, swapped, to the last bit. Where a
height needs a contact as its origin, it is the mean of the heights above either one.
Only + − × ÷ √ are used, which IEEE 754 fixes to the bit on every machine.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from palmbots.outline import Point, winding

__all__ = ["Corner", "ObjectFrame", "object_frame"]


@dataclass(frozen=True)
class Corner:
    """A point of the object [m]; `from_left` + `from_right` is the width but for rounding."""

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
    """The frame of a simple polygon that stands on the vertices `contacts` (left, right)."""
    left, right = (vertices[i] for i in contacts)
    dx = right[0] - left[0]
    dy = right[1] - left[1]
    width = math.sqrt(dx * dx + dy * dy)
    ex, ey = dx / width, dy / width

    def corner(point: Point) -> Corner:
        lx, ly = point[0] - left[0], point[1] - left[1]
        rx, ry = right[0] - point[0], right[1] - point[1]
        # Adding 0.0 makes −0.0 a plain zero, the only bit that the mirror could change.
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

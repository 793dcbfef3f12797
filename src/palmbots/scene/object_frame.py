# SPDX-License-Identifier: Apache-2.0
"""The object frame: coordinates of the object relative to its two contact vertices.

Frame: origin at the left contact vertex, x towards the right one, y up, metres. Every coordinate
along x is given twice, from the left and from the right contact, so that a mirrored object has the
same numbers, swapped, to the last bit (``include/palmbots/sim/object_frame.hpp``).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import palmbots._core as _core

Point = tuple[float, float]


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
    width, centre, outline, contact_right = _core.object_frame(vertices, contacts, com)
    return ObjectFrame(
        width, Corner(*centre), tuple(Corner(*vertex) for vertex in outline), contact_right
    )

# SPDX-License-Identifier: Apache-2.0
"""Proof or refutation for a part that the robots do not jam, at its corners, in ball arithmetic.

Closing raises the squeeze until a contact slides up, and opening lowers it until one slides down.
This presumes that the object presses on both palms without any squeeze: that its COM lies between
the contacts. If it lies beyond one of them, the other contact pulls, and an edge that is not wedged
need not bound the squeeze. A contact whose edge is wedged does not slide. The robots jam where the
edges of both contacts are wedged. Let (a, b) and (c, d) be these edges (lateral, vertical) of the
left and the right contact, and T the tangent of the object's angle. They are wedged if

    b − a T ≤ 0    and    d + c T ≤ 0.

If a, c > 0, then c times the first plus a times the second is a d + b c ≤ 0. So, where the COM lies
between the contacts, each of these proves that a part has no jam (on opening with the opposite sign
of a, c and a d + b c):

- the left edge is not wedged anywhere in it;
- the right edge is not wedged anywhere in it;
- a > 0, c > 0 and a d + b c > 0 everywhere in it.

All these forms are linear in each of tan θ, μ and T alone, and the condition on the COM also in
COM, width and slope, so the corners suffice.
Source: docs/theory/mechanics.md, "The balance leaves one unknown".
"""

from dataclasses import replace
from typing import Any

from palmbots.stability.certificates.obligations import Obligation, Subbox
from palmbots.stability.certificates.parameter_box import ParameterBox
from palmbots.stability.certificates.property_proof import Corner, corners, points, witness

_SLIDE = {1: 1, 2: -1}  # up on closing, down on opening


_LIFT = {"lift_left": 0, "lift_right": 1}  # the palm beyond whose contact the COM may not lie


def _edge_corners(box: ParameterBox, part: Subbox) -> list[Corner] | None:
    """The corners, without those that differ in COM or slope only, on which no edge depends."""
    return corners(replace(box, com=box.com[:1], slope=(box.slope[0],) * 2), part)


def _meeting(corner: Corner, slide: int) -> tuple[Any, Any, Any]:
    """a, c and a d + b c, with the opposite sign on opening."""
    (a, b), (c, d) = corner.edge(0, slide), corner.edge(1, slide)
    return slide * a, slide * c, slide * (a * d + b * c)


def proved(box: ParameterBox, obligation: Obligation, part: Subbox) -> bool:
    """Whether the corners of a part prove that the robots jam nowhere in it."""
    everywhere, at = corners(box, part), _edge_corners(box, part)
    if everywhere is None or at is None:
        return False
    if not all(corner.lift(side) > 0 for corner in everywhere for side in _LIFT.values()):
        return False
    slide = _SLIDE[obligation.number]
    if any(all(corner.bounds(side, slide) > 0 for corner in at) for side in (0, 1)):
        return True
    return all(form > 0 for corner in at for form in _meeting(corner, slide))


def refuted(box: ParameterBox, obligation: Obligation, part: Subbox) -> dict[str, Any] | None:
    """A corner of the part at which both contacts are certainly wedged, or the COM is outside."""
    slide = _SLIDE[obligation.number]
    for point, exactly in points(box, part):
        at = corners(exactly, point)
        for name, side in _LIFT.items() if at else ():
            if all(corner.lift(side) < 0 for corner in at or ()):
                return witness(obligation, name, point, exactly)
        if at and all(corner.bounds(side, slide) < 0 for corner in at for side in (0, 1)):
            return witness(obligation, "wedged", point, exactly)
    return None

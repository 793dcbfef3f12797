# SPDX-License-Identifier: Apache-2.0
"""The checker's conditions for "no jam": forms at the corners of a box, in exact rationals.

Claim: everywhere in the certificate's box the object presses on both palms without any squeeze,
since its COM lies between the contacts, and nowhere are both contacts wedged, on closing with their
up edges, on opening with their down edges. With the forms of `property_conditions`, the left
contact is wedged where b − a T ≤ 0 and the right one where d + c T ≤ 0, with the edges (a, b) and
(c, d).

An edge that is nowhere wedged excludes a jam. So does a d + b c > 0 with a > 0 and c > 0: the sum
c (b − a T) + a (d + c T) = a d + b c would be at most 0 in a jam. With a < 0 and c < 0, as on
opening with much friction, a d + b c < 0 excludes it. T cancels, so the third case holds for every
angle of the object. Each form is linear in each of t, μ and T alone.
"""

from palmbots.stability.certificates.checker.property_conditions import (
    LEFT,
    RIGHT,
    CheckFailed,
    Corner,
)

_UP, _DOWN = 1, -1
_PALMS = {"lift_left": LEFT, "lift_right": RIGHT}
_DIRECTION = {1: _UP, 2: _DOWN}  # by the number of the obligation: closing, opening


def prove_no_jam(number: int, at: list[Corner]) -> None:
    """Raise `CheckFailed` unless the corners of a box prove that the robots do not jam in it."""
    if not all(corner.pressed(side) > 0 for corner in at for side in (LEFT, RIGHT)):
        raise CheckFailed("the COM may lie beyond a contact")
    slide = _DIRECTION[number]
    for side in (LEFT, RIGHT):
        if all(corner.bounded(side, slide) > 0 for corner in at):
            return
    for corner in at:
        (a, b), (c, d) = corner.edge(LEFT, slide), corner.edge(RIGHT, slide)
        if not (slide * a > 0 and slide * c > 0 and slide * (a * d + b * c) > 0):
            raise CheckFailed("both contacts may be wedged")


def refute_no_jam(number: int, what: str, at: list[Corner]) -> None:
    """Raise `CheckFailed` unless the claim fails at all corners around a point: both contacts are
    wedged, or the object does not press on a palm."""
    if what in _PALMS:
        if not all(corner.pressed(_PALMS[what]) < 0 for corner in at):
            raise CheckFailed("the COM is not certainly beyond a contact at the witness")
        return
    if what != "wedged":
        raise CheckFailed('the condition of "no jam" is "wedged", "lift_left" or "lift_right"')
    slide = _DIRECTION[number]
    if not all(corner.bounded(side, slide) < 0 for corner in at for side in (LEFT, RIGHT)):
        raise CheckFailed("the contacts are not certainly wedged at the witness")

"""Does the outline touch a palm anywhere in the operating region?

`clearance` counts the palms as endless, which is exact for objects that are flat below and safe for
all. Where a part of the outline hangs below the line of a palm but beyond its end, palms as long
as they are decide: `touching` looks at a grid of contacts, corners included, in every pose. What
it finds is certain, what it does not find is not.
"""

from dataclasses import dataclass
from itertools import product

from palmbots import _core
from palmbots.sections import SIDES
from palmbots.stability.situation import Pair, Situation

__all__ = ["Touch", "clearance", "touching"]

_STEPS = 7
_INSET = 1e-9  # a contact at the very end of its palm would be found to touch that end


@dataclass(frozen=True)
class Touch:
    """A state in which the outline touches a palm beside its contact."""

    kind: str
    """flush: an edge or a further vertex on a palm; tip: a palm's end on an edge."""
    angles_rad: Pair
    contacts_m: Pair


def clearance(at: Situation) -> float:
    """How far object or palm may turn until an edge lies on the line of a palm [rad]."""
    return at.envelope().clearance(at.angles)


def touching(at: Situation) -> Touch | None:
    """The first state of the region that touches; None: none of those looked at."""
    looks: list[tuple[Pair, tuple[Pair, Pair]]] = []
    for side in SIDES:
        alike = list(at.poses(0, side))[:2]
        turning = list(at.poses(0, side))[2:]
        if side == "left":  # both steep, both shallow: the same from either side
            looks += [(pose.angles, at.contacts) for pose in alike]
        looks += [(pose.angles, at.region(number, side)) for pose in turning for number in (1, 2)]
    for angles, ends in looks:
        shares = [_INSET + (1 - 2 * _INSET) * i / (_STEPS - 1) for i in range(_STEPS)]
        grid = [[low + (high - low) * share for share in shares] for low, high in ends]
        for contacts in product(grid[0], grid[1]):
            kind = _core.touching(at.spec, angles, contacts)
            if kind:
                return Touch(kind, angles, contacts)
    return None

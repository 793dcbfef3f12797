"""What happens where the outline first touches a palm: equilibrium with further contacts there.

`clearance` names the state of least margin. From it the palm in question is turned alone, contacts
and the other palm staying, until the outline just touches (or, where it lies in the palm, just no
longer does): the contacts of that state, whether they hold the object, and what happens when the
robots drive on, are what the world goes on with there. Source: MECHANICS section 5.
"""

import math
from dataclasses import asdict, dataclass
from typing import Any

from palmbots import _core
from palmbots.errors import PalmbotsError
from palmbots.lowering import lower
from palmbots.palm_state import PalmState, placed
from palmbots.scene import Scene
from palmbots.sections import SIDES
from palmbots.stability.clearance import Nearest
from palmbots.stability.situation import Pair
from palmbots.touching import Contact, Motions, touching

__all__ = ["FirstTouch", "first_touch"]

_HALVINGS = 60


@dataclass(frozen=True)
class FirstTouch:
    """The state in which a further contact is just closed."""

    angles_rad: Pair
    contacts_m: Pair
    contacts: tuple[Contact, ...]
    held: bool
    """Whether friction can hold the object with every contact sticking."""
    closing: tuple[Motions, ...]
    """What may happen when the palms are driven together; none: nothing balances."""
    opening: tuple[Motions, ...]

    def summary(self) -> dict[str, Any]:
        """What ``palmbots analyze --json`` prints."""
        return asdict(self) | {"contacts": [contact.summary() for contact in self.contacts]}


def first_touch(scene: Scene, nearest: Nearest) -> FirstTouch | None:
    """The touch nearest to a state, by turning the palm in question alone; None: there is none."""
    side = SIDES.index(nearest.side)
    farthest = 1.5 * abs(nearest.margin) + math.radians(1)
    spec = lower(scene)

    def state(turn: float) -> PalmState:
        degrees = [math.degrees(angle) for angle in nearest.angles_rad]
        degrees[side] += math.degrees(turn)
        return placed(scene, spec, nearest.contacts_m, (degrees[0], degrees[1]))

    def clear(turn: float) -> bool:
        at = state(turn)
        sunk = _core.contacts(at.spec, at.theta_rad, at.p_m)[2]
        return max(sunk) <= 0

    found: list[float] = []
    for sense in (1.0, -1.0):
        try:
            turn = _boundary(clear, sense * farthest)
        except PalmbotsError:  # the object cannot span the palms so far round
            continue
        if turn is not None:
            found.append(turn)
    if not found:
        return None
    at = state(min(found, key=abs))
    there = touching(at)
    if not there.several:
        return None
    return FirstTouch(
        at.theta_rad, at.p_m, there.contacts, there.held, there.closing(), there.opening()
    )


def _boundary(clear: Any, far: float) -> float | None:
    """The last turn between 0 and `far` that is still clear, next to one that is not."""
    ends = {clear(0.0): 0.0, clear(far): far}
    if len(ends) == 1:
        return None
    for _ in range(_HALVINGS):
        middle = 0.5 * (ends[True] + ends[False])
        ends[clear(middle)] = middle
    return ends[True]

# SPDX-License-Identifier: Apache-2.0
"""The state in which the outline first touches a palm, and the motions that are possible there.

`clearance` names the state of the smallest margin. From it one palm is turned, while the contacts
and the other palm stay, until the outline just touches that palm, or, where the outline overlaps
it, until it no longer does. Reported are the contacts of that state, whether friction holds the
object on them, and what happens when the robots drive. Source: docs/theory/stability.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from palmbots._types import SIDES
from palmbots._util.plain_values import derived
from palmbots.errors import PalmbotsError
from palmbots.mechanics.contact_points import Contact, Motions, is_clear, touching
from palmbots.mechanics.state import PalmState, placed
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.stability.clearance import ClosestState
from palmbots.stability.problem import Pair

MOTION_NAMES = {
    "ST": "sticks",
    "SL": "slides left",
    "SR": "slides right",
    "BR": "breaks (leaves the palm)",
}
"""What a contact does, by the abbreviation in `Motions`."""

_HALVINGS = 60


def motions_text(contacts: Sequence[Contact], motions: Motions) -> str:
    """One outcome in words: what every contact does, such as ``left vertex sticks``."""
    phrases = [
        f"{contact.side} {contact.kind} {MOTION_NAMES[motion]}"
        for contact, motion in zip(contacts, motions, strict=True)
    ]
    return ", ".join(dict.fromkeys(phrases))  # both ends of a flush edge mostly do the same


@dataclass(frozen=True)
class FirstTouch:
    """The state in which a further contact just closes."""

    angles_rad: Pair
    contacts_m: Pair
    contacts: tuple[Contact, ...]
    held: bool
    """Whether friction can hold the object with every contact sticking."""
    closing: tuple[Motions, ...]
    """The possible outcomes when the palms are driven together; none: no motion balances."""
    opening: tuple[Motions, ...]
    """The same when they are driven apart."""

    def outcomes_text(self, outcomes: Sequence[Motions]) -> str:
        """Possible outcomes in words."""
        texts = [motions_text(self.contacts, motions) for motions in outcomes]
        return "; or ".join(texts) or "no motion balances"

    @derived
    def motion_names(self) -> dict[str, str]:
        """What the motions mean."""
        return MOTION_NAMES


def first_touch(scene: Scene, closest: ClosestState) -> FirstTouch | None:
    """The nearest state with a further contact, found by turning one palm; None: there is none."""
    side = SIDES.index(closest.side)
    farthest = 1.5 * abs(closest.margin) + math.radians(1)
    spec = to_spec(scene)

    def state(turn: float) -> PalmState:
        degrees = [math.degrees(angle) for angle in closest.angles_rad]
        degrees[side] += math.degrees(turn)
        return placed(scene, spec, closest.contacts_m, (degrees[0], degrees[1]))

    turns: list[float] = []
    for direction in (1.0, -1.0):
        try:
            turn = _boundary(lambda turn: is_clear(state(turn)), direction * farthest)
        except PalmbotsError:  # the object cannot span the palms at such an angle
            continue
        if turn is not None:
            turns.append(turn)
    if not turns:
        return None
    palms = state(min(turns, key=abs))
    touch = touching(palms)
    if not touch.several:
        return None
    return FirstTouch(
        palms.theta_rad,
        palms.p_m,
        touch.contacts,
        touch.held,
        touch.closing(),
        touch.opening(),
    )


def _boundary(is_clear: Callable[[float], bool], far: float) -> float | None:
    """The last turn between 0 and `far` that is still clear, next to one that is not."""
    ends = {is_clear(0.0): 0.0, is_clear(far): far}
    if len(ends) == 1:
        return None
    for _ in range(_HALVINGS):
        middle = 0.5 * (ends[True] + ends[False])
        ends[is_clear(middle)] = middle
    return ends[True]

# SPDX-License-Identifier: Apache-2.0
"""The contact motions that follow from the two properties of the palm angles (paper, section 2).

1. Closing slides the contact on the shallow palm up; the one on the steep palm sticks.
2. Opening slides the contact on the steep palm down; the one on the shallow palm sticks.

Where both palms are alike, or one is turning, neither speaks and either contact may slide. No
friction, no geometry: what is derived from this holds for every object with the two properties.
Signs stand for contact coordinates; a sensor stops a contact at 0 before it is past it.
"""

from collections.abc import Iterator
from typing import Literal

from palmbots.derivation.global_policy import Direction, Move, Signs

Palm = Literal["steep", "shallow", "turning"]
Palms = tuple[Palm, Palm]


def sliders(palms: Palms, direction: Direction) -> frozenset[int]:
    """The contacts that may slide in a motion; if there are several, any of them may slide."""
    wanted = "shallow" if direction == "closer" else "steep"
    if sorted(palms) == ["shallow", "steep"]:
        return frozenset({palms.index(wanted)})
    return frozenset({0, 1})


def why(palms: Palms, direction: Direction) -> str:
    """The reason for the result of `sliders`, in words."""
    contacts = sliders(palms, direction)
    if len(contacts) > 1:
        return "either may slide"
    (contact,) = contacts
    number = 1 if direction == "closer" else 2
    return f"property {number} moves only p_{'LR'[contact]}"


def up(direction: Direction) -> int:
    """The sign of the change of a sliding contact coordinate: closing moves it outward."""
    return 1 if direction == "closer" else -1


def improves(signs: Signs, palms: Palms, direction: Direction) -> bool:
    """Whether each contact that may slide is not at its nominal position and moves towards it."""
    return all(signs[contact] == -up(direction) for contact in sliders(palms, direction))


def _moved(signs: Signs, palms: Palms, direction: Direction) -> Iterator[Signs]:
    for contact in sliders(palms, direction):
        sign = signs[contact]
        for after in {sign, 0} if sign == -up(direction) else {up(direction)}:
            yield (after, signs[1]) if contact == 0 else (signs[0], after)


def passed_through(
    entry: frozenset[Signs], palms: Palms, move: Move
) -> tuple[frozenset[Signs], frozenset[Signs]]:
    """The signs during a move that starts at any of `entry`, and the signs at which it ends."""
    during: set[Signs] = set()
    ends: set[Signs] = set()
    queue = list(entry)
    while queue:
        signs = queue.pop()
        if signs in during or signs in ends:
            continue
        if move.over(signs):
            ends.add(signs)
            continue
        during.add(signs)
        queue += _moved(signs, palms, move.direction)
    return frozenset(during), frozenset(ends)

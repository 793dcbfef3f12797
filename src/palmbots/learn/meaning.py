"""What a robot sees and does, as the numbers that learning libraries want.

An observation has the entries of `OBSERVATION`, an action those of `ACTION`; where the robots may
not talk, both end before the letters. Left and right robots have the same numbers in the outward
frame: "away" is away from the partner. Nothing else is known to a robot: no contact coordinate, no
speed or place of its partner, not even the time.
"""

from itertools import product
from typing import Any

import numpy as np

from palmbots.controllers import Letter, Move, Palm

__all__ = [
    "ACTION",
    "LETTERS",
    "MOVES",
    "OBSERVATION",
    "PALMS",
    "Do",
    "Seen",
    "action",
    "action_sizes",
    "observation",
    "observation_size",
    "orders",
]

Seen = tuple[int, bool, int, bool, bool]
"""Sign, palm turned, letter that is there, program runs, it has just begun anew; of one robot in
the tick to come, in the numbers of the core."""
Do = tuple[int, int, int]
"""Palm, move and letter to send: places in the lists below."""

PALMS: tuple[Palm, ...] = ("steep", "shallow")
MOVES: tuple[Move, ...] = ("hold", "away", "closer")
"""Nominal speed, or that and the scene's correction speed away from or towards the partner."""
LETTERS: tuple[Letter | None, ...] = (None, "TiltUp", "TiltDown", "Ack")
"""Nothing, or one of three symbols; only the paper's algorithm gives them their names' meaning."""

ACTION = ("palm", "move", "send")
"""Places in `PALMS`, `MOVES` and `LETTERS`."""
OBSERVATION = ("sign", "palm", "turned", "move", "TiltUp", "TiltDown", "Ack")
"""`sign` of the contact: -1, 0 or 1, outward is positive. `palm` is 1 shallow, -1 steep, as
told last, `turned` 1 once it has got there, else 0; `move` is 1 away, -1 closer, 0 hold, as told
last. The others are 1 where that letter has come in, else 0; at most one of them is 1."""

_SILENT = 4  # entries of an observation without letters
_TILTED = (-1.0, 1.0)
_MOVED = (0.0, 1.0, -1.0)
_HEARD = tuple(tuple(float(k == letter) for k in (1, 2, 3)) for letter in range(4))


def observation_size(messages: bool) -> int:
    """How many entries an observation has."""
    return len(OBSERVATION) if messages else _SILENT


def action_sizes(messages: bool) -> list[int]:
    """How many values each entry of an action has."""
    sizes = [len(PALMS), len(MOVES), len(LETTERS)]
    return sizes if messages else sizes[:-1]


def orders(messages: bool) -> dict[tuple[int, ...], Do]:
    """What each legal action tells a robot."""
    palms, moves, letters = action_sizes(True)
    every = product(range(palms), range(moves), range(letters if messages else 1))
    return {do if messages else do[:2]: do for do in every}


def observation(seen: Seen, told: Do, messages: bool) -> Any:
    """What a robot knows, as an array of float32."""
    return _KNOWN[messages][seen[0], told[0], seen[1], told[1], seen[2]].copy()


def _known(messages: bool) -> dict[tuple[int, int, bool, int, int], Any]:
    """All observations there are: to copy one takes less time than to make it."""
    every = product((-1, 0, 1), range(2), (False, True), range(3), range(4))
    return {
        key: np.array((key[0], _TILTED[key[1]], key[2], _MOVED[key[3]], *_HEARD[key[4]]))
        .astype(np.float32)[: observation_size(messages)]
        .copy()
        for key in every
    }


_KNOWN = {messages: _known(messages) for messages in (False, True)}


def action(palm: Palm, move: Move, send: Letter | None = None, *, messages: bool = True) -> Any:
    """The action of these names."""
    codes = [PALMS.index(palm), MOVES.index(move), LETTERS.index(send)]
    return np.array(codes if messages else codes[:-1], np.int64)

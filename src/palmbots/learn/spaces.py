# SPDX-License-Identifier: Apache-2.0
"""The observation and action spaces of a robot, in numbers.

An observation has the entries of `OBSERVATION`, and an action those of `ACTION`. Without messages
both end before the entries of messages. Both robots use the same numbers in the outward frame:
"away" is away from the partner. A robot knows nothing else: no contact coordinate, no speed or
position of its partner, and no time.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from palmbots.control.interface import MESSAGE_KINDS, MOVES, PALMS, MessageKind, Move, Palm

RobotObservation = tuple[int, bool, int, bool, bool]
"""Of one robot in the coming tick, in the numbers of the core: sign, palm at its target, message
received, program runs, program has just restarted."""
RobotAction = tuple[int, int, int]
"""Palm, move and message to send: indices of the lists below."""

# MOVES: nominal speed, or nominal speed plus the correction speed of the scene, away from or
# towards the partner.
MESSAGES = MESSAGE_KINDS
"""Nothing, or one of three symbols. Only the paper's algorithm gives them the meaning of their
names."""

ACTION = ("palm", "move", "send")
"""Indices of `PALMS`, `MOVES` and `MESSAGES`."""
OBSERVATION = ("sign", "palm", "turned", "move", *(kind for kind in MESSAGES if kind))
"""`sign` of the contact coordinate: -1, 0 or 1; outward is positive. `palm` as last commanded: 1
shallow, -1 steep. `turned` is 1 once the palm is at its target, else 0. `move` as last commanded: 1
away, -1 closer, 0 hold. The others are 1 if that message was received, else 0; at most one of them
is 1."""

_SIZE_WITHOUT_MESSAGES = 4
_PALM_VALUES = (-1.0, 1.0)
_MOVE_VALUES = (0.0, 1.0, -1.0)
_MESSAGE_VALUES = tuple(tuple(float(k == message) for k in (1, 2, 3)) for message in range(4))


def observation_size(messages: bool) -> int:
    """Number of entries of an observation."""
    return len(OBSERVATION) if messages else _SIZE_WITHOUT_MESSAGES


def action_sizes(messages: bool) -> list[int]:
    """Number of values of each entry of an action."""
    sizes = [len(PALMS), len(MOVES), len(MESSAGES)]
    return sizes if messages else sizes[:-1]


def legal_actions(messages: bool) -> dict[tuple[int, ...], RobotAction]:
    """The action of the core for each legal action of an agent."""
    palms, moves, kinds = action_sizes(True)
    actions = product(range(palms), range(moves), range(kinds if messages else 1))
    return {one if messages else one[:2]: one for one in actions}


def observation(seen: RobotObservation, last: RobotAction, messages: bool) -> Any:
    """The observation of a robot whose last action was `last`, as an array of float32."""
    return _OBSERVATIONS[messages][seen[0], last[0], seen[1], last[1], seen[2]].copy()


def _all_observations(messages: bool) -> dict[tuple[int, int, bool, int, int], Any]:
    """Every possible observation: copying one is faster than making it."""
    keys = product((-1, 0, 1), range(2), (False, True), range(3), range(4))
    return {
        (sign, palm, turned, move, message): np.array(
            (sign, _PALM_VALUES[palm], turned, _MOVE_VALUES[move], *_MESSAGE_VALUES[message])
        )
        .astype(np.float32)[: observation_size(messages)]
        .copy()
        for sign, palm, turned, move, message in keys
    }


_OBSERVATIONS = {messages: _all_observations(messages) for messages in (False, True)}


def action(
    palm: Palm, move: Move, send: MessageKind | None = None, *, messages: bool = True
) -> Any:
    """The action with these names, as an array."""
    codes = [PALMS.index(palm), MOVES.index(move), MESSAGES.index(send)]
    return np.array(codes if messages else codes[:-1], np.int64)

# SPDX-License-Identifier: Apache-2.0
"""Environments of short carries, and episodes of one action, for the tests of palmbots.learn."""

from typing import Any

from palmbots.control.interface import Move
from palmbots.learn import carry_v0
from palmbots.learn.spaces import action

SHORT = {"task.distance_m": 0.1}


def short(**keys: Any) -> Any:
    return carry_v0.parallel_env("paper", overrides=SHORT, **keys)


def ended(env: Any, seed: int, move: Move = "hold") -> tuple[Any, ...]:
    env.reset(seed=seed)
    last: tuple[Any, ...] = ()
    while env.agents:
        order = action("steep", move)
        last = env.step(dict.fromkeys(env.agents, order))
    return last

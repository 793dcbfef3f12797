# SPDX-License-Identifier: Apache-2.0
"""The controllers `standing` and `creeping`: references whose robots stand in unfavourable noise.

A robot that stands has no noise in the simulated world. A controller that reads the noise can
therefore wait until it is small or even helps. `standing` drives at the usual speeds meanwhile.
`creeping` lets noise alone move the robots, a tick at a time, and needs more time.
They show why `palmbots bound` holds for robots that keep driving only
(`optimum/standing_team.hpp`).
"""

from __future__ import annotations

from typing import Any

from palmbots.control.registry import ControllerEntry
from palmbots.optimum.opening import StandingFeedback


def _entry(name: str, description: str, *, creeps: bool) -> ControllerEntry:
    maker: Any = lambda spec: StandingFeedback(creeps)  # noqa: E731
    return ControllerEntry(
        name,
        f"reference that reads the noise: {description}",
        uses_radio=False,
        policy_maker=maker,
    )


STANDING = _entry("standing", "robots stand while it is unfavourable", creeps=False)
CREEPING = _entry("creeping", "noise alone moves the robots, when it helps", creeps=True)

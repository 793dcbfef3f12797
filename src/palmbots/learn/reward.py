# SPDX-License-Identifier: Apache-2.0
"""The reward. Both robots get the same one, computed from the full state.

For a step of length Δt in which the pair advances by Δx it is

    progress · Δx / distance  −  centring · (Δt / T) · mean of (p / ℓ)²  −  message · messages sent

plus, at the end, + delivered or − dropped. T is the time that the distance takes at nominal speed,
and ℓ is half the length of a palm. With the default weights an episode returns at most 2, for a
delivery with both contacts at their pivots all the time, and at worst about −1. A carry that never
moves returns about 0.
"""

from dataclasses import dataclass, fields
from math import inf

from palmbots._types import SIDES
from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene


@dataclass(frozen=True)
class RewardWeights:
    """The weights of the terms of the reward; all at least 0."""

    progress: float = 1.0
    centring: float = 1.0
    delivered: float = 1.0
    dropped: float = 1.0
    message: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if (
                isinstance(value, bool)
                or not isinstance(value, int | float)
                or not 0 <= value < inf
            ):
                raise PalmbotsError(
                    f"rewards.{field.name}: value is {show(value)}; allowed: at least 0"
                )


class RewardTerms:
    """The terms of the reward in a scene."""

    def __init__(self, rewards: RewardWeights, scene: Scene) -> None:
        speed = sum(scene.robot_of(side).speed_m_s for side in SIDES) / 2
        distance, period = scene.task.distance_m, scene.control.period_s
        left, right = (scene.palm_of(side).reach_m for side in SIDES)
        sense = 1.0 if scene.task.direction == "forward" else -1.0
        self._progress = rewards.progress * sense / distance
        per_tick = rewards.centring * period * speed / distance
        self._left, self._right = per_tick / 2 / left**2, per_tick / 2 / right**2
        self._message = rewards.message
        self._end = {"delivered": rewards.delivered, "dropped": -rewards.dropped}

    def step(
        self, advance: float, ticks: int, p: tuple[float, float], messages: int, outcome: str
    ) -> float:
        """The reward of a step.

        Args:
            advance: displacement of the pair towards +x [m].
            ticks: number of control periods.
            p: contact coordinates (left, right) at the end of the step [m].
            messages: number of messages sent.
            outcome: ``running``, or how the carry ended.
        """
        reward = self._progress * advance - self._message * messages
        reward -= ticks * (self._left * p[0] * p[0] + self._right * p[1] * p[1])
        return reward + self._end.get(outcome, 0.0)

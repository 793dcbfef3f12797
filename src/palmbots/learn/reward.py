"""What the team is paid: both robots get the same, from what no robot sees.

Over a step of length Δt in which the pair advances by Δx,

    progress · Δx / distance  −  centring · (Δt / T) · mean of (p / ℓ)²  −  letter · letters sent

and at the end + delivered or − dropped. T is the time that the way takes at nominal speed, ℓ half
of a palm's length. So by default an episode gives at most 2, for a delivery with both contacts at
their pivots throughout, and at worst about −1; a carry that stands still for ever gets near 0.
"""

from dataclasses import dataclass, fields
from math import inf

from palmbots.errors import PalmbotsError, show
from palmbots.geometry import SIDES
from palmbots.scene import Scene

__all__ = ["Rewards", "Scale"]


@dataclass(frozen=True)
class Rewards:
    """The weights of the terms above; all at least 0."""

    progress: float = 1.0
    centring: float = 1.0
    delivered: float = 1.0
    dropped: float = 1.0
    letter: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if (
                isinstance(value, bool)
                or not isinstance(value, int | float)
                or not 0 <= value < inf
            ):
                raise PalmbotsError(
                    f"rewards: {field.name} is {show(value)}; allowed: a number of at least 0"
                )


class Scale:
    """What a scene makes of the weights."""

    def __init__(self, rewards: Rewards, scene: Scene) -> None:
        speed = sum(scene.robot_of(side).speed_m_s for side in SIDES) / 2
        distance, period = scene.task.distance_m, scene.control.period_s
        left, right = (scene.palm_of(side).length_m / 2 for side in SIDES)
        sense = 1.0 if scene.task.direction == "forward" else -1.0
        self._way = rewards.progress * sense / distance
        per_tick = rewards.centring * period * speed / distance
        self._left, self._right = per_tick / 2 / left**2, per_tick / 2 / right**2
        self._letter = rewards.letter
        self._end = {"delivered": rewards.delivered, "dropped": -rewards.dropped}

    def step(
        self, advance: float, ticks: int, p: tuple[float, float], letters: int, outcome: str
    ) -> float:
        """For an advance towards +x [m], contacts p [m] at the end of so many ticks, letters sent,
        and ``running`` or how the carry ended."""
        paid = self._way * advance - self._letter * letters
        paid -= ticks * (self._left * p[0] * p[0] + self._right * p[1] * p[1])
        return paid + self._end.get(outcome, 0.0)

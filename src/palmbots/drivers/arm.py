# SPDX-License-Identifier: Apache-2.0
"""The arm of a real robot, in a job on the floor or at a stand: a servo that raises the pivot of
the palm.

The arm is where it was commanded; nothing measures it. `firmware/app/arm.hpp` is the same for
boards.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

FOLLOWS, REACHES, HOLDS, RISES, SINKS = range(5)
"""What an arm does (`palmbots.drivers.driver.Drive.arm`)."""
ARM_WORDS = ("on the floor", "reaches", "holds", "rises", "sinks")
"""The same in words."""
LONGEST_MOVE_S = 0.05
"""After a longer time without a command an arm moves by as much as in this time, because it must
not be faster than its rate."""
_ROUNDING = 1e-9


class StoredArm(NamedTuple):
    """What a robot remembers of its arm over a boot: heights of the pivot over the floor [m]."""

    pivot_m: float = 0.0
    """Height at which the arm goes on: the end of its present step from which it came. The
    partner's arm is at most a step from there."""
    touched_m: float = 0.0
    """Height at which the palm touched an object on a stand; before that, where the job begins."""


NEW_ARM = StoredArm()
"""An arm that was never commanded is where the job begins."""


@dataclass(frozen=True)
class ArmShape:
    """What the job of a scene asks of an arm."""

    floors_m: tuple[float, float]
    """Heights of the pivot at which the nose of the steep and of the shallow palm is on the
    floor."""
    top_m: float
    """Height of the pivot while the pair carries."""
    rate_m_s: float
    """Speed of the pivot."""
    step_m: float
    """A step of the table (`control/lifting.hpp`)."""
    ends: tuple[str, str]
    """What the object is on before and after the job: palms, floor or stand."""
    lows_m: tuple[float, float]
    """Lowest heights at the beginning and at the end of the job, from which the table counts steps:
    with the nose on the floor at the first angle of the palm, or below an object on a stand."""
    clear_m: float = 0.0
    """At which the palm touches an object on the first stand at the latest."""


def arm_shape(scene: Scene, side: Side) -> ArmShape:
    """What the job of a scene asks of the arm of one side."""
    spec = to_spec(scene, unrolled=True)
    k = SIDES.index(side)
    palm, arm = spec.palms[k], scene.arm.of(side)
    steep, shallow = (
        math.radians(getattr(scene.palm_of(side), f"{which}_deg")) for which in ("steep", "shallow")
    )
    floor_m = palm.lowest_pivot(_core.first_angle(spec, k))
    (first_m, clear_m), (last_m, _) = (
        _core.stand_heights(spec, k, _core.standing_level(spec, moved))
        if on == "stand"
        else (floor_m, floor_m)
        for on, moved in zip(scene.task.ends, (0.0, spec.direction * spec.distance), strict=True)
    )
    return ArmShape(
        (palm.lowest_pivot(steep), palm.lowest_pivot(shallow)),
        arm.carry_height_m,
        arm.rate_m_per_s,
        _core.runtime.arm_step_m(spec),
        scene.task.ends,
        (first_m, last_m),
        clear_m,
    )


class ArmMotion:
    """Where an arm is commanded to, tick by tick.

    Args:
        shape: of the job.
        stored: before the boot.
    """

    def __init__(self, shape: ArmShape, stored: StoredArm = NEW_ARM) -> None:
        self._shape = shape
        if stored == NEW_ARM:
            begin_m = shape.top_m if shape.ends[0] == "palms" else shape.lows_m[0]
            stored = StoredArm(begin_m, shape.lows_m[0])
        self.pivot_m = min(stored.pivot_m, shape.top_m)
        """Height of the pivot over the floor."""
        # Where the palm touched the object. What was stored may be of another job.
        low_m, high_m = shape.lows_m[0], max(shape.lows_m[0], shape.clear_m)
        self._lifted_from_m = min(max(stored.touched_m, low_m), high_m)
        self.stored = StoredArm(self.pivot_m, self._lifted_from_m)
        """To be stored. It seldom changes while the arm moves, and never while the arm holds."""
        self._ends = self._is_there = False
        self._rises = self.pivot_m == shape.top_m  # it has moved upward last

    def move(
        self, arm: int, palm: int, elapsed_s: float, *, ends: bool = False, touches: bool = False
    ) -> None:
        """What the arm does from now on.

        Args:
            arm: as `palmbots.drivers.driver.Drive.arm`.
            palm: at its steep (0) or shallow angle (1).
            elapsed_s: since the last command.
            ends: the lowest height is that at the end of the job.
            touches: something presses the palm, so an arm that reaches for the object stops.
        """
        shape = self._shape
        floor = shape.floors_m[palm]
        most = shape.rate_m_s * elapsed_s
        self._ends, self._is_there = ends, True
        bottom = max(shape.lows_m[ends], floor) if self._is_at_stand else floor
        if arm == FOLLOWS:
            nearer = max(self.pivot_m - most, min(self.pivot_m + most, bottom))
            self.pivot_m = nearer if self._is_at_stand else floor
        elif arm == REACHES:
            if not touches:
                self.pivot_m = max(self.pivot_m, min(self.pivot_m + most, shape.clear_m))
            self._lifted_from_m = self.pivot_m
        elif arm == RISES:
            self.pivot_m = min(self.pivot_m + most, shape.top_m)
            self._is_there = self.pivot_m == shape.top_m
            self._rises = True
        elif arm == SINKS:
            self.pivot_m = min(self.pivot_m, max(self.pivot_m - most, bottom))
            self._is_there = self.pivot_m <= bottom
            self._rises = False
        self.pivot_m = max(self.pivot_m, floor)
        if arm != REACHES:
            self._store(arm, bottom)

    def is_there(self, has_turned: bool) -> bool:
        """The arm has reached the height last commanded. The floor is at the height for the angle
        to which the palm turns, so an arm that sinks is down once the palm has turned."""
        return self._is_there and (has_turned or self._rises or self._is_at_stand)

    @property
    def steps(self) -> int:
        """How many steps the arm is above its height on the floor, at which its palm touched the
        object, or to which it sinks."""
        return math.floor(self._above + _ROUNDING)

    def _store(self, arm: int, bottom: float) -> None:
        before_m, touched_m = self.stored
        if arm == FOLLOWS:
            at_m = bottom
        elif arm == HOLDS:
            at_m = before_m if touched_m == self._lifted_from_m else self.pivot_m
        elif not self._rises:
            at_m = self._edge_m(math.ceil(self._above - _ROUNDING))
        elif self.pivot_m == self._shape.top_m:
            at_m = self.pivot_m
        else:
            at_m = before_m if self.pivot_m < self._zero_m else self._edge_m(self.steps)
        self.stored = StoredArm(at_m, self._lifted_from_m)

    def _edge_m(self, steps: int) -> float:
        return min(self._zero_m + steps * self._shape.step_m, self._shape.top_m)

    @property
    def _zero_m(self) -> float:
        """From where steps count."""
        return self._shape.lows_m[1] if self._ends else self._lifted_from_m

    @property
    def _above(self) -> float:
        """How far it is above that height [steps]."""
        return max(self.pivot_m - self._zero_m, 0.0) / self._shape.step_m

    @property
    def _is_at_stand(self) -> bool:
        return self._shape.ends[self._ends] == "stand"

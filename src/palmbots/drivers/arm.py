# SPDX-License-Identifier: Apache-2.0
"""The arm of a real robot, in a job on the floor: a servo that raises the pivot of the palm.

The arm is where it was commanded; nothing measures it. `firmware/app/arm.hpp` is the same for
boards.
"""

import math
from dataclasses import dataclass

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots.errors import SceneError
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

FOLLOWS, REACHES, HOLDS, RISES, SINKS = range(5)
"""What an arm does (`palmbots.drivers.driver.Drive.arm`)."""
ARM_WORDS = ("on the floor", "reaches", "holds", "rises", "sinks")
"""The same in words."""
LONGEST_MOVE_S = 0.05
"""After a longer time without a command an arm moves by as much as in this time, because it must
not be faster than its rate."""


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
    lows_m: tuple[float, float] = (0.0, 0.0)
    """Lowest heights at the beginning and at the end of the job, from which the table counts steps:
    with the nose on the floor at the first angle of the palm, or below an object on a stand."""
    clear_m: float = 0.0
    """At which the palm touches an object on the first stand at the latest."""

    @property
    def top_edge(self) -> int:
        """`ArmMotion.edge` of an arm that is up."""
        return math.ceil((self.top_m - self.floors_m[0]) / self.step_m)


def arm_shape(scene: Scene, side: Side, *, at_stands: bool = False) -> ArmShape:
    """What the job of a scene asks of the arm of one side.

    Args:
        scene: the scene.
        side: of the robot.
        at_stands: the job may begin or end on a stand.

    Raises:
        SceneError: it does although it may not.
    """
    if not at_stands:
        refuse_stands(scene)
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
        (first_m, last_m),
        clear_m,
    )


def refuse_stands(scene: Scene) -> None:
    """Raise `SceneError` for a job that begins or ends on a stand: no driver of real robots knows
    its heights and how far the robot has driven below it."""
    for key in ("from", "to"):
        if getattr(scene.task, key) == "stand":
            raise SceneError(
                f'task.{key}: "stand" is for simulated robots and boards; allowed for others: '
                "floor or palms"
            )


class ArmMotion:
    """Where an arm is commanded to, tick by tick.

    Args:
        shape: of the job.
        edge: `ArmMotion.edge` before the boot; 0: the arm is low.
    """

    def __init__(self, shape: ArmShape, edge: int = 0) -> None:
        self._shape = shape
        self._top_m = shape.top_m - shape.floors_m[0]
        self._height_m = min(edge * shape.step_m, self._top_m)
        self.rises = self._height_m == self._top_m
        """The arm has moved upward last."""
        self.is_there = False
        """The arm has reached the height last commanded; down, once the palm has turned."""

    def move(self, arm: int, palm: int, elapsed_s: float) -> None:
        """What the arm does from now on, with the palm at its steep (0) or shallow angle (1)."""
        floor = self._shape.floors_m[palm] - self._shape.floors_m[0]
        most = self._shape.rate_m_s * elapsed_s
        self.is_there = True
        if arm == FOLLOWS:
            self._height_m = floor
        elif arm == RISES:
            self._height_m = min(self._height_m + most, self._top_m)
            self.is_there = self._height_m == self._top_m
            self.rises = True
        elif arm == SINKS:
            self._height_m = max(self._height_m - most, floor)
            self.is_there = self._height_m == floor
            self.rises = False
        self._height_m = max(self._height_m, floor)

    @property
    def pivot_m(self) -> float:
        """Height of the pivot over the floor."""
        return self._height_m + self._shape.floors_m[0]

    @property
    def steps(self) -> int:
        """How many steps the arm is above its height on the floor."""
        return math.floor(max(self._height_m, 0.0) / self._shape.step_m)

    @property
    def edge(self) -> int:
        """The end of the present step from which the arm has come: there it goes on after a boot.
        The partner's arm is at most a step from there. An arm that is up goes on at the top."""
        is_below = self.rises and self._height_m != self._top_m
        return self.steps + (0 if is_below or self._height_m <= 0 else 1)

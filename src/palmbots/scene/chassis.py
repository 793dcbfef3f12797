# SPDX-License-Identifier: Apache-2.0
"""Where a robot's wheels, caster, arm and masses are: for statics and for the MuJoCo model.

Outward is away from the partner. On a straight path the wheels are outward of the middle of the
body and the caster is inward, below the load. The paper states the size of its robots only; all
else is assumed (`palmbots.scene.robot_dimensions`, section `mujoco` of the scene).
"""

from dataclasses import dataclass

import palmbots._core as _core
from palmbots.scene.robot_dimensions import (
    BODY_GAP,
    BODY_SIZE,
    GROUND_CLEARANCE,
    SHOULDER_INSET,
    WHEEL_INSET,
)
from palmbots.scene.scene import Scene
from palmbots.scene.section import as_given


@dataclass(frozen=True)
class Chassis:
    """Positions relative to the middle of the body on the floor [m]; x outward, z up."""

    axle: float
    caster: float
    track: float
    com: tuple[float, float]
    shoulder: tuple[float, float]
    pivot: tuple[float, float]
    """The wrist, where the palm turns."""

    @property
    def arm(self) -> tuple[float, float]:
        """From shoulder to wrist."""
        return self.pivot[0] - self.shoulder[0], self.pivot[1] - self.shoulder[1]


def axle_out(scene: Scene) -> float:
    """Distance of the wheels outward of the pivot [m]."""
    return _core.axle_out(as_given(scene), scene.task.path.is_curved)


def shoulder(floor: float) -> tuple[float, float]:
    """Where the arm begins: outward of the pivot, and above it [m]. `floor`: height of the floor
    above the pivot."""
    return BODY_GAP + SHOULDER_INSET, floor + GROUND_CLEARANCE + BODY_SIZE - SHOULDER_INSET


def chassis(height: float, axle: float = _core.USUAL_AXLE) -> Chassis:
    """The positions on a robot whose pivot is `height` above the floor [m].

    The wheels are `axle` outward of the pivot [m], the caster is on the other side of the COM.
    """
    wheels, caster, com, begins, pivot = _core.chassis(height, axle)
    return Chassis(wheels, caster, BODY_SIZE + 2 * WHEEL_INSET, com, begins, pivot)


def wheel_kg(scene: Scene) -> float:
    """Mass of one wheel, a part of the mass of the body."""
    return _core.wheel_kg(scene.mujoco.body_kg)

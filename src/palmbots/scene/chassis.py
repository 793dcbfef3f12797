# SPDX-License-Identifier: Apache-2.0
"""Where a robot's wheels, caster, arm and masses are: for statics and for the MuJoCo model.

Outward is away from the partner. On a straight path the wheels are outward of the middle of the
body and the caster is inward, below the load. The paper states the size of its robots only; all
else is assumed (`palmbots.scene.robot_dimensions`, section `mujoco` of the scene).
"""

from dataclasses import dataclass

from palmbots.scene.robot_dimensions import (
    BODY_GAP,
    BODY_SIZE,
    GROUND_CLEARANCE,
    SHOULDER_INSET,
    WHEEL_INSET,
)
from palmbots.scene.scene import Scene

_WHEEL_KG = 0.05
_AXLE = 0.2  # m, outward of the pivot, if the scene does not state it; assumed


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
    if scene.mujoco.axle_m is not None:
        return scene.mujoco.axle_m
    return 0.0 if scene.task.path.is_curved else _AXLE


def shoulder(floor: float) -> tuple[float, float]:
    """Where the arm begins: outward of the pivot, and above it [m]. `floor`: height of the floor
    above the pivot."""
    return BODY_GAP + SHOULDER_INSET, floor + GROUND_CLEARANCE + BODY_SIZE - SHOULDER_INSET


def chassis(height: float, axle: float = _AXLE) -> Chassis:
    """The positions on a robot whose pivot is `height` above the floor [m].

    The wheels are `axle` outward of the pivot [m], the caster is on the other side of the COM.
    """
    low, middle = GROUND_CLEARANCE, BODY_GAP + BODY_SIZE / 2
    x, z = shoulder(-height)
    return Chassis(
        axle=0.05 if axle == _AXLE else axle - middle,
        caster=-0.07 if axle > middle + 0.02 else 0.07,
        track=BODY_SIZE + 2 * WHEEL_INSET,
        com=(0.02, low + 0.06),
        shoulder=(x - middle, z + height),
        pivot=(-BODY_GAP - BODY_SIZE / 2, height),
    )


def wheel_kg(scene: Scene) -> float:
    """Mass of one wheel, a part of the mass of the body."""
    return min(_WHEEL_KG, 0.1 * scene.mujoco.body_kg)

# SPDX-License-Identifier: Apache-2.0
"""The section `mujoco` of a scene: masses, wheels, floor and switches of the MuJoCo world.

The paper states the size of its robots ("approximately the size of a 20 cm cube"). All numbers here
are assumed.
"""

from typing import Annotated, Self

from pydantic import BeforeValidator, model_validator

from palmbots.scene.fields import Friction, Mass, Place, Range, Size, field_error, from_list
from palmbots.scene.section import Section

Force = Annotated[float, BeforeValidator(Range("N", least=0, most=1000))]
Debounce = Annotated[float, BeforeValidator(Range("s", least=0, most=1))]
Height = Annotated[float, BeforeValidator(Range("m", least=0.0001, most=0.05))]
Torque = Annotated[float, BeforeValidator(Range("N m", least=0.001, most=1000))]
Pull = Annotated[float, BeforeValidator(Range("N", least=0.01, most=10000))]
Step = Annotated[float, BeforeValidator(Range("s", least=0.0001, most=0.005))]
Axle = Annotated[float, BeforeValidator(Range("m", least=0, most=0.25))]
Mismatch = Annotated[float, BeforeValidator(Range(least=-0.2, most=0.2))]


PALM_TORQUE = 0.43
"""Of the default servo [N m]."""


class Ridge(Section):
    """A rounded ridge across the floor. All wheels cross it, one after the other."""

    at_m: Place
    """Distance from the midpoint of the pivots at the start, in the direction of travel."""
    height_m: Height
    length_m: Size = 0.05
    """Length along the direction of travel."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.length_m < 2 * self.height_m:
            raise field_error(
                self.length_m,
                f"is less than twice height_m, which is {self.height_m:g}",
                f"a number in m, from {2 * self.height_m:g} to 10 (a flat arc)",
                "length_m",
            )
        return self


Ridges = Annotated[
    tuple[Ridge, ...],
    BeforeValidator(from_list("a list of at most 32 tables {at_m, height_m, length_m}", 0, 32)),
]


class MujocoParameters(Section):
    """[mujoco] What only the MuJoCo world and the check of the load use."""

    body_kg: Mass = 3.0
    """MuJoCo world: mass of a robot without arm and palm."""
    arm_kg: Mass = 0.2
    """MuJoCo world: mass of an arm."""
    palm_kg: Mass = 0.1
    """MuJoCo world: mass of a palm."""
    wheel_radius_m: Size = 0.04
    """MuJoCo world: radius of the two driven wheels."""
    wheel_radius_mismatch: Mismatch = 0.0
    """MuJoCo world: fraction by which a robot's left wheel is larger than its right one. The
    heading controller has to compensate for it."""
    axle_m: Axle | None = None
    """MuJoCo world: distance of the wheels outward of the palm's pivot. Not set: 0.2 on a straight
    path. On a curved path 0, because the axle follows the path and must be below the palm."""
    floor_friction: Friction = 0.8
    """MuJoCo world: Coulomb coefficient between wheels and floor."""
    palm_torque_n_m: Torque = PALM_TORQUE
    """MuJoCo world: torque with which a palm's servo still holds the palm within a quarter of a
    degree of its commanded angle. Under more, a robot waits for a palm that does not arrive."""
    drive_force_n: Pull | None = None
    """MuJoCo world: largest force of both wheels of a robot together on the floor. Not set: as much
    as the floor's friction allows."""
    ridges: Ridges = ()
    """MuJoCo world: ridges across the floor, a list of tables {at_m, height_m, length_m}."""
    switch_force_n: Force = 0.1
    """MuJoCo world: smallest force that closes a switch of the tactile sensor."""
    switch_debounce_s: Debounce = 0.05
    """MuJoCo world: a switch opens when nothing has pressed it for this time."""
    step_s: Step = 0.002
    """MuJoCo world: integration step. It is shortened so that a control period is a whole number of
    steps."""

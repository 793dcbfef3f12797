# SPDX-License-Identifier: Apache-2.0
"""The section `mujoco` of a scene: masses, wheels, floor and switches of the MuJoCo world.

The paper states the size of its robots ("approximately the size of a 20 cm cube"). All numbers here
are assumed.
"""

from typing import Annotated

from pydantic import BeforeValidator

from palmbots.scene.core_keys import ROWS, key, records
from palmbots.scene.fields import Range
from palmbots.scene.section import Section

Force = Annotated[float, BeforeValidator(Range("N", least=0, most=1000))]
Debounce = Annotated[float, BeforeValidator(Range("s", least=0, most=1))]
Step = Annotated[float, BeforeValidator(Range("s", least=0.0001, most=0.005))]
Mismatch = Annotated[float, BeforeValidator(Range(least=-0.2, most=0.2))]


PALM_TORQUE: float = ROWS["mujoco.palm_torque_n_m"]["default"]
"""Of the default servo [N m]."""


class Ridge(Section):
    """A rounded ridge across the floor. All wheels cross it, one after the other."""

    at_m: float = key("mujoco.ridges[].at_m")
    """Distance from the midpoint of the pivots at the start, in the direction of travel."""
    height_m: float = key("mujoco.ridges[].height_m")
    length_m: float = key("mujoco.ridges[].length_m", has_default=True)
    """Length along the direction of travel."""


class MujocoParameters(Section):
    """[mujoco] What only the MuJoCo world and the check of the load use."""

    body_kg: float = key("mujoco.body_kg")
    """MuJoCo world: mass of a robot without arm and palm."""
    arm_kg: float = key("mujoco.arm_kg")
    """MuJoCo world: mass of an arm."""
    palm_kg: float = key("mujoco.palm_kg")
    """MuJoCo world: mass of a palm."""
    wheel_radius_m: float = key("mujoco.wheel_radius_m")
    """MuJoCo world: radius of the two driven wheels."""
    wheel_radius_mismatch: Mismatch = 0.0
    """MuJoCo world: fraction by which a robot's left wheel is larger than its right one. The
    heading controller has to compensate for it."""
    axle_m: float | None = key("mujoco.axle_m")
    """MuJoCo world: distance of the wheels outward of the palm's pivot. Not set: 0.2 on a straight
    path. On a curved path 0, because the axle follows the path and must be below the palm."""
    floor_friction: float = key("mujoco.floor_friction")
    """MuJoCo world: Coulomb coefficient between wheels and floor."""
    palm_torque_n_m: float = key("mujoco.palm_torque_n_m")
    """MuJoCo world: torque with which a palm's servo still holds the palm within a quarter of a
    degree of its commanded angle; less than the stall torque of a data sheet. Under more, a robot
    waits for a palm that does not arrive."""
    ridges: tuple[Ridge, ...] = records("mujoco.ridges")
    """MuJoCo world: ridges across the floor, a list of tables {at_m, height_m, length_m}."""
    switch_force_n: Force = 0.1
    """MuJoCo world: smallest force that closes a switch of the tactile sensor."""
    switch_debounce_s: Debounce = 0.05
    """MuJoCo world: a switch opens when nothing has pressed it for this time."""
    step_s: Step = 0.002
    """MuJoCo world: integration step. It is shortened so that a control period is a whole number of
    steps."""

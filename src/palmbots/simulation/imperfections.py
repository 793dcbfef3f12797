# SPDX-License-Identifier: Apache-2.0
"""What simulated robots really are, which their programs do not know (`Imperfections`).

The defaults are robots that fit the defaults of ``[hardware]`` in ``pair.toml``. Forward, left and
right are those of `palmbots.drivers.hardware`.
"""

from collections.abc import Sequence
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, ValidationError, model_validator

from palmbots._types import Side
from palmbots.drivers.hardware import (
    Acceleration,
    Counts,
    Scale,
    ServoAngle,
    ServoScale,
    Speed,
    Switches,
    Trim,
    Voltage,
)
from palmbots.errors import PalmbotsError
from palmbots.scene.core_keys import limits
from palmbots.scene.error_messages import validation_message
from palmbots.scene.fields import Range, Size, Switch, field_error
from palmbots.scene.file_kinds import FileKind
from palmbots.scene.files import read_table
from palmbots.scene.key_reference import SceneKey, section_keys
from palmbots.scene.overrides import merged, parse_override
from palmbots.scene.section import Section, check_sides, override_of, values_of_side

ClockError = Annotated[float, limits("robot.clock_ppm")]
Rise = Annotated[float, BeforeValidator(Range("m", least=-0.1, most=0.1))]
Drain = Annotated[float, BeforeValidator(Range("V/min", least=0, most=60))]


class ImperfectionParameters(Section):
    """One simulated robot."""

    wheel_radius_m: Size = 0.04
    """Nominal radius of the wheels."""
    wheel_separation_m: Size = 0.22
    """Distance between the middles of the wheels. The MuJoCo world has its own."""
    wheel_scale: Scale = 1.0
    """Distance that the robot covers, over the one that the nominal radius gives."""
    trim: Trim = 0.0
    """Fraction by which the left wheel covers more than the right one."""
    dead_zone_m_s: Speed = 0.0
    """Commanded speed below which a turning wheel stops, and by which it is slower."""
    stiction_m_s: Speed = 0.0
    """Commanded speed below which a resting wheel does not begin to turn."""
    encoder_ticks_per_turn: Counts = 1440.0
    """Counts of the encoders in one turn of a wheel. 0: there are none."""
    motor_acceleration_m_s2: Acceleration = 1.0
    """Largest change of the speed of a wheel, also when it brakes."""
    servo_zero_deg: ServoAngle = 90.0
    """Angle of the servo at which the palm is horizontal."""
    servo_scale: ServoScale = 1.0
    """Turn of the servo over the turn of the palm."""
    servo_reports: Switch = False
    """The servo reports its angle."""
    arm_floor_deg: ServoAngle = 30.0
    """Angle of the arm's servo at which the nose of the steep palm is on the floor."""
    arm_top_deg: ServoAngle = 150.0
    """Angle of the arm's servo at which the pivot is at arm.carry_height_m of the scene."""
    switches: Switches | None = None
    """The switches of the palm, as hardware.switches. Not set: the zones of the scene."""
    battery_v: Voltage = 8.0
    """Voltage of the full battery at rest."""
    battery_sag_v: Voltage = 0.0
    """Drop of the voltage while the wheels turn."""
    battery_drain_v_per_min: Drain = 0.0
    """Drop of the voltage per minute in which the wheels turn."""
    battery_slows: Switch = False
    """The wheels are slower in proportion to the voltage that is missing."""
    clock_ppm: ClockError = 0.0
    """Rate error of the clock of the robot's program, > 0 if it runs fast."""
    pivot_height_m: Rise = 0.0
    """Height of the palm's pivot over where the scene has it."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.stiction_m_s < self.dead_zone_m_s:
            raise field_error(
                self.stiction_m_s,
                f"is less than dead_zone_m_s, which is {self.dead_zone_m_s:g}",
                f"a number in m/s, from {self.dead_zone_m_s:g} to 1",
                "stiction_m_s",
            )
        if abs(self.servo_scale) < 0.01:
            allowed = "a number, at least 0.01, or at most -0.01"
            raise field_error(self.servo_scale, "is too close to 0", allowed, "servo_scale")
        if self.arm_floor_deg == self.arm_top_deg:
            allowed = f"a number in degrees that is not {self.arm_floor_deg:g}"
            raise field_error(self.arm_top_deg, "is arm_floor_deg", allowed, "arm_top_deg")
        return self


@override_of(ImperfectionParameters)
class ImperfectionOverride(Section):
    """What differs on one side."""


class Imperfections(ImperfectionParameters):
    """Both robots; the tables left and right override keys for one."""

    left: ImperfectionOverride = ImperfectionOverride()
    right: ImperfectionOverride = ImperfectionOverride()

    @model_validator(mode="after")
    def _check_sides(self) -> Self:
        check_sides(self, {"left": self.left, "right": self.right}, ImperfectionParameters)
        return self

    def of(self, side: Side) -> ImperfectionParameters:
        """One robot, with its overrides applied."""
        override = self.left if side == "left" else self.right
        return ImperfectionParameters(**values_of_side(self, override))


IMPERFECTIONS_FILE = FileKind(
    "a file of imperfections",
    "palmbots world --imperfect",
    "what simulated robots really are",
    keys=Imperfections.model_fields,
)


def imperfection_keys() -> tuple[SceneKey, ...]:
    """All keys, in order."""
    return tuple(section_keys(ImperfectionParameters, "imperfect"))


def load_imperfections(texts: Sequence[str]) -> Imperfections:
    """The imperfections that ``--imperfect`` states.

    Args:
        texts: the name of a TOML file, or ``KEY=VALUE``; a later one has precedence.

    Raises:
        PalmbotsError: a file cannot be read, or has a fault; a key or value is not allowed.
    """
    table: dict[str, Any] = {}
    for text in texts:
        if text.endswith(".toml") and "=" not in text:
            found = read_table(text, IMPERFECTIONS_FILE)
            table = merged(table, found, called=text)
        else:
            key, value = parse_override(text, "--imperfect", "left.trim=0.02")
            table = merged(table, {key: value}, called="--imperfect")
    try:
        return Imperfections.model_validate(table)
    except ValidationError as error:
        message = validation_message(error, Imperfections)
        raise PalmbotsError(f"--imperfect {message}") from None

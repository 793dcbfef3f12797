# SPDX-License-Identifier: Apache-2.0
"""The hardware of one robot (`HardwareParameters`), as the table ``[hardware]`` of ``pair.toml``.

A robot has two driven wheels side by side, a servo that turns the palm, and switches on the palm.
*Forward* is towards the partner, so that both robots of a pair can be built alike. Left and right
wheel are those of a person who looks forward.

The functions convert between what a controller means and what a motor board is given. They are
pure; `palmbots.drivers.hardware_io` joins them to what a driver needs. SI units, radians.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Self

from pydantic import BeforeValidator, model_validator

from palmbots._types import Side
from palmbots.drivers.arm import ArmShape
from palmbots.errors import PalmbotsError
from palmbots.scene.fields import Range, Switch, field_error, from_list
from palmbots.scene.robot_section import Zone
from palmbots.scene.section import Section, check_sides, override_of, values_of_side

# A robot that fits under an object of some decimetres has smaller ones.
WheelRadius = Annotated[
    float, BeforeValidator(Range("m (3.3 cm are 0.033 m)", least=0.002, most=0.5))
]
WheelSeparation = Annotated[
    float, BeforeValidator(Range("m (22 cm are 0.22 m)", least=0.01, most=2))
]
Scale = Annotated[float, BeforeValidator(Range(least=0.5, most=2))]
Trim = Annotated[float, BeforeValidator(Range(least=-0.2, most=0.2))]
Counts = Annotated[float, BeforeValidator(Range(least=0, most=10_000_000))]
Acceleration = Annotated[float, BeforeValidator(Range("m/s²", least=0.001, most=1000))]
FullSpeed = Annotated[float, BeforeValidator(Range("m/s", least=0.001, most=10))]
Speed = Annotated[float, BeforeValidator(Range("m/s", least=0, most=1))]
ServoAngle = Annotated[float, BeforeValidator(Range("degrees", least=-720, most=720))]
ServoScale = Annotated[float, BeforeValidator(Range(least=-100, most=100))]
Pulse = Annotated[float, BeforeValidator(Range("s", least=0.0001, most=0.02))]
Turning = Annotated[float, BeforeValidator(Range("degrees/s", least=0.1, most=100_000))]
Voltage = Annotated[float, BeforeValidator(Range("V", least=0, most=60))]
Stopping = Annotated[float, BeforeValidator(Range("s", least=0.01, most=100))]
Switches = Annotated[
    tuple[Zone, ...],
    BeforeValidator(from_list('a list of 1 to 16 tables {sign = "-", from_m, to_m}', 1, 16)),
]
_LEAST_SERVO_SCALE = 0.01


class HardwareParameters(Section):
    """The hardware of one robot."""

    wheel_radius_m: WheelRadius = 0.04
    """Radius of the two driven wheels, as measured with a ruler."""
    wheel_separation_m: WheelSeparation = 0.22
    """Distance between the middles of the two driven wheels."""
    wheel_scale: Scale = 1.0
    """Distance that the robot really covers, over the one that `wheel_radius_m` gives. Measured by
    palmbots calibrate."""
    trim: Trim = 0.0
    """Straight-line trim: fraction by which the left wheel covers more than the right one for the
    same turning angle. Left is that of a person who looks towards the partner. Measured by palmbots
    calibrate."""
    left_reversed: Switch = False
    """The left motor and its encoder count forward as negative."""
    right_reversed: Switch = False
    """The right motor and its encoder count forward as negative."""
    encoder_ticks_per_turn: Counts = 1440.0
    """Counts of the encoder in one turn of the wheel. 0: there are no encoders."""
    acceleration_m_s2: Acceleration = 0.5
    """Limit of the change of the commanded speed. A stop does not wait for it."""
    full_speed_m_s: FullSpeed = 0.25
    """Speed of the wheels at full power, for motor boards that take a power in place of a speed."""
    dead_zone_m_s: Speed = 0.0
    """Commanded speed below which a turning wheel stops. The wheel is slower than commanded by as
    much. Measured by palmbots calibrate."""
    stiction_m_s: Speed = 0.0
    """Commanded speed below which a resting wheel does not begin to turn; at least `dead_zone_m_s`.
    Measured by palmbots calibrate."""
    servo_zero_deg: ServoAngle = 90.0
    """Angle of the servo at which the palm is horizontal. Measured by palmbots calibrate."""
    servo_scale: ServoScale = 1.0
    """Turn of the servo over the turn of the palm; negative if the servo turns the other way.
    Measured by palmbots calibrate."""
    servo_min_deg: ServoAngle = 0.0
    """Smallest angle that the servo may be given."""
    servo_max_deg: ServoAngle = 180.0
    """Largest angle that the servo may be given."""
    servo_min_pulse_s: Pulse = 0.0005
    """Length of the pulse for the smallest angle."""
    servo_max_pulse_s: Pulse = 0.0025
    """Length of the pulse for the largest angle."""
    servo_rate_deg_s: Turning = 50.0
    """Speed of the servo. A servo that does not report its angle counts as at its target after the
    time that it needs at this speed."""
    arm_floor_deg: ServoAngle = 0.0
    """Angle of the arm's servo at which the nose of the steep palm is on the floor, for jobs on the
    floor. Between this angle and `arm_top_deg` the height of the pivot is taken as linear. Measured
    by palmbots calibrate."""
    arm_top_deg: ServoAngle = 0.0
    """Angle of the arm's servo at which the pivot is arm.carry_height_m of the scene above the
    floor. Equal to `arm_floor_deg`: the robot has no arm. Measured by palmbots calibrate."""
    switches: Switches = (
        Zone(sign="-", from_m=-0.075, to_m=-0.005),
        Zone(sign="0", from_m=-0.005, to_m=0.005),
        Zone(sign="+", from_m=0.005, to_m=0.075),
    )
    """The switches of the palm in the order of their inputs: a list of tables {sign, from_m, to_m}.
    The contact coordinate grows outward, away from the partner. A pressed switch of sign 0 takes
    precedence. The edges are measured by palmbots calibrate."""
    battery_low_v: Voltage = 0.0
    """Voltage below which the robot is not armed. 0: it is not checked."""
    stopping_s: Stopping = 0.12
    """Time in which the wheels come to rest from the nominal speed; the default is assumed. It must
    not exceed robot.speed_m_s / robot.acceleration_m_s2 of the scene. Measured by palmbots
    calibrate."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if abs(self.servo_scale) < _LEAST_SERVO_SCALE:
            allowed = "a number, at least 0.01, or at most -0.01"
            raise field_error(self.servo_scale, "is too close to 0", allowed, "servo_scale")
        for k, zone in enumerate(self.switches):
            if zone.to_m <= zone.from_m:
                raise field_error(
                    zone.to_m, f"is not more than from_m, which is {zone.from_m:g}",
                    f"a number in m, more than {zone.from_m:g} and at most 10",
                    f"switches[{k}].to_m",
                )  # fmt: skip
        for low, high, unit in (
            ("servo_min_deg", "servo_max_deg", "degrees"),
            ("servo_min_pulse_s", "servo_max_pulse_s", "s"),
        ):
            least, most = getattr(self, low), getattr(self, high)
            if most <= least:
                raise field_error(
                    most, f"is not more than {low}, which is {least:g}",
                    f"a number in {unit}, more than {least:g}", high,
                )  # fmt: skip
        if self.stiction_m_s < self.dead_zone_m_s:
            raise field_error(
                self.stiction_m_s,
                f"is less than dead_zone_m_s, which is {self.dead_zone_m_s:g}",
                f"a number in m/s, from {self.dead_zone_m_s:g} to 1",
                "stiction_m_s",
            )
        return self


@override_of(HardwareParameters)
class HardwareOverride(Section):
    """What differs on one side."""


class Hardware(HardwareParameters):
    """[hardware] Both robots; [hardware.left] and [hardware.right] override keys for one."""

    left: HardwareOverride = HardwareOverride()
    right: HardwareOverride = HardwareOverride()

    @model_validator(mode="after")
    def _check_sides(self) -> Self:
        check_sides(self, {"left": self.left, "right": self.right}, HardwareParameters)
        return self

    def of(self, side: Side) -> HardwareParameters:
        """The hardware of one robot, with its overrides applied."""
        return HardwareParameters(
            **values_of_side(self, self.left if side == "left" else self.right)
        )


# --- from meanings to commands -------------------------------------------------------------------


def oriented(hardware: HardwareParameters, wheels: Sequence[float]) -> tuple[float, float]:
    """Commands or counts of both wheels, between forward and the sense of the motor board.

    Drivers apply it in both directions: raw commands and raw readings count forward.
    """
    left, right = wheels
    return (
        -left if hardware.left_reversed else left,
        -right if hardware.right_reversed else right,
    )


def wheel_scales(hardware: HardwareParameters) -> tuple[float, float]:
    """What one radian of the left and of the right wheel covers, over the nominal radius."""
    half = 0.5 * hardware.trim
    return hardware.wheel_scale * (1 + half), hardware.wheel_scale * (1 - half)


def wheel_rates(hardware: HardwareParameters, forward_m_s: float) -> tuple[float, float]:
    """The rates [rad/s] of both wheels with which the robot drives straight at a speed."""
    nominal = forward_m_s / hardware.wheel_radius_m
    left, right = wheel_scales(hardware)
    return nominal / left, nominal / right


def motor_command(hardware: HardwareParameters, rate: float, *, turns: bool) -> float:
    """What a motor is commanded [rad/s], so that its wheel turns at `rate` [rad/s].

    Args:
        hardware: of the robot.
        rate: wanted.
        turns: the wheel turns already; otherwise stiction has to be overcome.
    """
    if rate == 0:
        return 0.0
    size = abs(rate) + hardware.dead_zone_m_s / hardware.wheel_radius_m
    if not turns:
        size = max(size, hardware.stiction_m_s / hardware.wheel_radius_m)
    return math.copysign(size, rate)


def motor_power(hardware: HardwareParameters, command: float) -> float:
    """A command [rad/s] as a share of full power, -1 to 1."""
    return max(-1.0, min(1.0, command * hardware.wheel_radius_m / hardware.full_speed_m_s))


def ramped(
    hardware: HardwareParameters, wanted_m_s: float, before_m_s: float, period_s: float
) -> float:
    """The next speed on the way to the wanted one, within the acceleration limit [m/s]."""
    most = hardware.acceleration_m_s2 * period_s
    return max(before_m_s - most, min(before_m_s + most, wanted_m_s))


def servo_angle(hardware: HardwareParameters, palm_rad: float) -> float:
    """The angle of the servo [rad] for an angle of the palm, within the range of the servo."""
    wanted = math.radians(hardware.servo_zero_deg) + hardware.servo_scale * palm_rad
    least, most = math.radians(hardware.servo_min_deg), math.radians(hardware.servo_max_deg)
    return max(least, min(most, wanted))


def servo_pulse_s(hardware: HardwareParameters, servo_rad: float) -> float:
    """The length of the pulse [s] for an angle of the servo."""
    least, most = math.radians(hardware.servo_min_deg), math.radians(hardware.servo_max_deg)
    share = max(0.0, min(1.0, (servo_rad - least) / (most - least)))
    shortest, longest = hardware.servo_min_pulse_s, hardware.servo_max_pulse_s
    return shortest + share * (longest - shortest)


def arm_servo_angle(hardware: HardwareParameters, shape: ArmShape, pivot_m: float) -> float:
    """The angle of the arm's servo [rad] for a height of the pivot."""
    share = (pivot_m - shape.floors_m[0]) / (shape.top_m - shape.floors_m[0])
    low, high = math.radians(hardware.arm_floor_deg), math.radians(hardware.arm_top_deg)
    return low + share * (high - low)


def check_arm_hardware(hardware: HardwareParameters, side: Side, shape: ArmShape) -> None:
    """Refuse hardware that cannot do the job of a scene.

    Raises:
        PalmbotsError: it has no arm, its servo does not turn far enough, or its switches do not
            state whether anything lies on the palm.
    """
    if hardware.arm_floor_deg == hardware.arm_top_deg:
        raise PalmbotsError(
            f"hardware.arm_top_deg: value is {hardware.arm_top_deg:g}, as arm_floor_deg: the {side}"
            " robot has no arm, which a job on the floor needs; allowed: two different angles"
        )
    least, most = hardware.servo_min_deg, hardware.servo_max_deg
    for key, height_m in (("arm_floor_deg", min(shape.floors_m)), ("arm_top_deg", shape.top_m)):
        wanted = math.degrees(arm_servo_angle(hardware, shape, height_m))
        if not least <= wanted <= most:
            raise PalmbotsError(
                f"hardware.{key}: the arm's servo of the {side} robot would have to turn to "
                f"{wanted:g} degrees; allowed: hardware.servo_min_deg to servo_max_deg, "
                f"{least:g} to {most:g}"
            )
    if not any(zone.sign == "0" for zone in hardware.switches):
        raise PalmbotsError(
            f"hardware.switches: the {side} palm has no switch of sign 0, so an object between - "
            "and + closes none; a job on the floor or at a stand has to know whether anything lies "
            'on the palm; allowed: at least one with sign = "0"'
        )


# --- from what is read to meanings ---------------------------------------------------------------


def wheel_distances(hardware: HardwareParameters, counts: Sequence[float]) -> tuple[float, float]:
    """What both wheels have covered forward [m], after these counts of their encoders.

    NaN: there are no encoders.
    """
    if hardware.encoder_ticks_per_turn == 0:
        return math.nan, math.nan
    one = 2 * math.pi * hardware.wheel_radius_m / hardware.encoder_ticks_per_turn
    left, right = (
        one * scale * count for scale, count in zip(wheel_scales(hardware), counts, strict=True)
    )
    return left, right


def forward_distance(hardware: HardwareParameters, counts: Sequence[float]) -> float:
    """What the robot has covered forward [m]; NaN: there are no encoders."""
    return sum(wheel_distances(hardware, counts)) / 2


def heading(hardware: HardwareParameters, counts: Sequence[float]) -> float:
    """How far the robot has turned to the left [rad], by its encoders; NaN: it has none."""
    left, right = wheel_distances(hardware, counts)
    return (right - left) / hardware.wheel_separation_m


def palm_angle(hardware: HardwareParameters, servo_rad: float) -> float:
    """The angle of the palm over the horizontal [rad], for an angle of the servo."""
    return (servo_rad - math.radians(hardware.servo_zero_deg)) / hardware.servo_scale


def pressed_sign(hardware: HardwareParameters, closed: Sequence[bool]) -> int:
    """The tactile sign for the switches that are closed, in the order of their inputs.

    As in the simulated sensor, a switch of sign 0 takes precedence, and no closed switch reads 0.
    Of a - and a + that are both closed, the later one counts.
    """
    sign = 0
    for zone, is_closed in zip(hardware.switches, closed, strict=True):
        if is_closed and zone.sign == "0":
            return 0
        if is_closed:
            sign = 1 if zone.sign == "+" else -1
    return sign

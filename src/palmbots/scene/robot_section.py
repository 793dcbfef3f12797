# SPDX-License-Identifier: Apache-2.0
"""The sections of a scene about the robots: `robot`, `arm`, `tactile` and `control`."""

from typing import Any

from palmbots._types import Side
from palmbots.scene.core_keys import key, records
from palmbots.scene.fields import FileName
from palmbots.scene.section import Section, override_of, values_of_side


class RobotParameters(Section):
    """One robot: speeds, errors of the speed, and clock.

    It moves at the commanded speed times the gain, plus the bias, the noise (which has a
    correlation time) and the white part. All errors end while the robot stands with its brakes on,
    except for standing_noise_m_s.
    """

    speed_m_s: float = key("robot.speed_m_s")
    """Nominal speed, in the direction of travel."""
    correction_m_s: float = key("robot.correction_m_s")
    """Difference from the nominal speed while the robot corrects a contact."""
    acceleration_m_s2: float = key("robot.acceleration_m_s2")
    """Acceleration limit."""
    max_speed_m_s: float = key("robot.max_speed_m_s")
    """Limit of the commanded speed, in both directions."""
    gain: float = key("robot.gain")
    """Actual speed per commanded speed, as from a wrong wheel radius, on average over carries."""
    gain_sd: float = key("robot.gain_sd")
    """Standard deviation of the gain: it is drawn once for each carry and robot."""
    noise_m_s: float = key("robot.noise_m_s")
    """Standard deviation of the speed error (an Ornstein-Uhlenbeck process)."""
    noise_tau_s: float = key("robot.noise_tau_s")
    """Correlation time of the speed error."""
    standing_noise_m_s: float = key("robot.standing_noise_m_s")
    """What is left of the speed error while the robot stands with its brakes on, as a standard
    deviation; a value above noise_m_s counts as noise_m_s. 0: brakes hold. > 0: wheels creep."""
    white_noise_m_per_sqrt_s: float = key("robot.white_noise_m_per_sqrt_s")
    """White part of the speed error, as the standard deviation of the displacement that it causes
    in 1 s; in t seconds it is √t times that."""
    bias_m_s: float = key("robot.bias_m_s")
    """Constant speed error, as from wrong calibration. > 0: faster in the direction of travel."""
    error_trace: FileName | None = None
    """A file with recorded displacement errors of a robot, which replace its gain, bias and noise
    (docs/guide/fit.md). Each carry and robot begins at a random place, and continues with random
    segments. Time limits and forecasts still use the replaced keys. The name is relative to the
    scene file."""
    trace_gain: str = key("robot.trace_gain")
    """With error_trace: "carry" keeps the gain of the first segment during the carry; "segment"
    gives each segment its own gain, with the error that it has at the nominal speed."""
    clock_ppm: float = key("robot.clock_ppm")
    """Rate error of the robot's clock, > 0 if it runs fast. Controllers that measure no time ignore
    it: centralized and distributed."""
    motor_force_n: float | None = key("robot.motor_force_n")
    """Largest force along the floor of both motors of a robot together. If a robot would need a
    larger force, it stalls, and its wheels stand. Not set: no limit."""
    traction_n: float | None = key("robot.traction_n")
    """Largest force of a robot's wheels on the floor. If a robot would need a larger force, it
    stalls, and its wheels spin (in MuJoCo they stand, and mujoco.floor_friction limits the force as
    well). Not set: no limit."""
    period_s: float | None = key("robot.period_s")
    """Time between two steps of the robot's program: a whole multiple of control.period_s, and at
    most control.watchdog_s. Without it: control.period_s."""

    @property
    def force_limit_n(self) -> float | None:
        """The largest force of the robot along the floor [N]; None: no limit."""
        given = [f for f in (self.motor_force_n, self.traction_n) if f is not None]
        return min(given) if given else None


@override_of(RobotParameters)
class RobotOverride(Section):
    """What differs on one side."""


class Robot(RobotParameters):
    """[robot] Both robots; [robot.left] and [robot.right] override keys for one."""

    left: RobotOverride = RobotOverride()
    right: RobotOverride = RobotOverride()

    def of(self, side: Side) -> RobotParameters:
        """The robot of one side, with its overrides applied."""
        override: Any = self.left if side == "left" else self.right
        return RobotParameters(**values_of_side(self, override))


class ArmParameters(Section):
    """One arm: it raises and lowers the pivot of a palm. It moves only in jobs that begin or end on
    the floor (task.from, task.to)."""

    rate_m_per_s: float = key("arm.rate_m_per_s")
    """Speed at which the pivot rises and falls, at most."""
    carry_height_m: float = key("arm.carry_height_m")
    """Height of the pivot above the floor while the pair carries."""
    lowest_pivot_m: float = key("arm.lowest_pivot_m")
    """Least height of the pivot above the floor that the wrist permits. 0: the wrist fits
    everywhere."""
    height_error_m: float = key("arm.height_error_m")
    """Largest error of the height of a pivot."""


@override_of(ArmParameters)
class ArmOverride(Section):
    """What differs on one side."""


class Arm(ArmParameters):
    """[arm] Both arms; [arm.left] and [arm.right] override keys for one."""

    left: ArmOverride = ArmOverride()
    right: ArmOverride = ArmOverride()

    def of(self, side: Side) -> ArmParameters:
        """The arm of one side, with its overrides applied."""
        override: Any = self.left if side == "left" else self.right
        return ArmParameters(**values_of_side(self, override))


class Zone(Section):
    """A switch of the tactile sensor: the contact coordinates at which it reads its sign."""

    sign: str = key("tactile.zones[].sign")
    from_m: float = key("tactile.zones[].from_m")
    to_m: float = key("tactile.zones[].to_m")
    """End of the zone. Both ends belong to it."""


class Tactile(Section):
    """[tactile] The palms' sensors. They measure the sign of the contact coordinate."""

    zero_half_width_m: float = key("tactile.zero_half_width_m")
    """Half width of the zone about the pivot in which the sensor reads 0. Beyond it the sensor
    reads - or +."""
    zones: tuple[Zone, ...] | None = records("tactile.zones", is_optional=True)
    """Switches in place of that zone: a list of tables {sign, from_m, to_m}. Where a zone of sign 0
    overlaps another one, the sensor reads 0. It also reads 0 outside all zones, where no switch is
    pressed. At a common end of a - and a + zone the later one in the list counts."""
    false_rate: float = key("tactile.false_rate")
    """Probability that one reading is false."""


class Control(Section):
    """[control] The controllers."""

    period_s: float = key("control.period_s")
    """Time between two controller steps."""
    watchdog_s: float = key("control.watchdog_s")
    """If a controller has not stepped for this time, its robot stops and restarts. At least
    period_s."""
    brake: bool = key("control.brake")
    """Controllers shared-sign and silent: whether a robot may stop to correct a contact that is off
    centre, or because its partner seems to stand."""
    start: str = key("control.start")
    """Controllers silent and shared-sign. together: both robots start at an agreed time. touch: the
    follower starts, and the leader when it senses that, or hears the follower."""

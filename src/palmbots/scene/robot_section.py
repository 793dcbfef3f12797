# SPDX-License-Identifier: Apache-2.0
"""The sections of a scene about the robots: `robot`, `tactile` and `control`."""

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, model_validator

from palmbots._types import SIDES, Side
from palmbots.scene.fields import (
    Duration,
    Extent,
    Fraction,
    Place,
    Range,
    Switch,
    field_error,
    from_list,
)
from palmbots.scene.section import Section, key_of_side, values_of_side

Speed = Annotated[float, BeforeValidator(Range("m/s", least=0, most=10))]
SpeedError = Annotated[float, BeforeValidator(Range("m/s", least=-1, most=1))]
Noise = Annotated[float, BeforeValidator(Range("m/s", least=0, most=1))]
Acceleration = Annotated[float, BeforeValidator(Range("m/s²", least=0.001, most=1000))]
Memory = Annotated[float, BeforeValidator(Range("s", least=0.001, most=1000))]
Period = Annotated[float, BeforeValidator(Range("s", least=0.0001, most=1))]
ClockError = Annotated[
    float, BeforeValidator(Range("parts per million", least=-100_000, most=100_000))
]


class RobotParameters(Section):
    """One robot: speeds, noise and clock."""

    speed_m_s: Speed = 0.06
    """Nominal speed, in the direction of travel."""
    correction_m_s: Speed = 0.03
    """Difference from the nominal speed while the robot corrects a contact."""
    acceleration_m_s2: Acceleration = 0.5
    """Acceleration limit."""
    max_speed_m_s: Speed = 0.2
    """Limit of the commanded speed, in both directions."""
    noise_m_s: Noise = 0.01
    """Standard deviation of the speed error (an Ornstein-Uhlenbeck process)."""
    noise_tau_s: Memory = 0.5
    """Correlation time of the speed error."""
    bias_m_s: SpeedError = 0.0
    """Constant speed error, as from wrong calibration. > 0: faster in the direction of travel."""
    clock_ppm: ClockError = 0.0
    """Rate error of the robot's clock, > 0 if it runs fast. Controllers that measure no time ignore
    it: centralized and distributed."""
    period_s: Period | None = None
    """Time between two steps of the robot's program: a whole multiple of control.period_s, and at
    most control.watchdog_s. Without it: control.period_s."""


class RobotOverride(Section):
    """[robot.left], [robot.right] Overrides for one robot."""

    speed_m_s: Speed | None = None
    correction_m_s: Speed | None = None
    acceleration_m_s2: Acceleration | None = None
    max_speed_m_s: Speed | None = None
    noise_m_s: Noise | None = None
    noise_tau_s: Memory | None = None
    bias_m_s: SpeedError | None = None
    clock_ppm: ClockError | None = None
    period_s: Period | None = None


class Robot(RobotParameters):
    """[robot] Both robots."""

    left: RobotOverride = RobotOverride()
    right: RobotOverride = RobotOverride()

    def of(self, side: Side) -> RobotParameters:
        """The robot of one side, with its overrides applied."""
        return RobotParameters(**values_of_side(self, self.left if side == "left" else self.right))

    @model_validator(mode="after")
    def _check(self) -> Self:
        for side in SIDES:
            override = self.left if side == "left" else self.right
            robot = self.of(side)
            if robot.speed_m_s > robot.max_speed_m_s:
                raise field_error(
                    robot.speed_m_s,
                    "is more than max_speed_m_s",
                    f"a number in m/s, from 0 to {robot.max_speed_m_s:g}",
                    key_of_side(override, side, "speed_m_s"),
                )
        return self


class Zone(Section):
    """A switch of the tactile sensor: the contact coordinates at which it reads its sign."""

    sign: Literal["-", "0", "+"]
    from_m: Place
    to_m: Place
    """End of the zone. Both ends belong to it."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.to_m <= self.from_m:
            raise field_error(
                self.to_m,
                f"is not more than from_m, which is {self.from_m:g}",
                f"a number in m, more than {self.from_m:g} and at most 10",
                "to_m",
            )
        return self


Zones = Annotated[
    tuple[Zone, ...],
    BeforeValidator(from_list('a list of at most 16 tables {sign = "-", from_m, to_m}', 0, 16)),
]


class Tactile(Section):
    """[tactile] The palms' sensors. They measure the sign of the contact coordinate."""

    zero_half_width_m: Extent = 0.005
    """Half width of the zone about the pivot in which the sensor reads 0. Beyond it the sensor
    reads - or +."""
    zones: Zones | None = None
    """Switches in place of that zone: a list of tables {sign, from_m, to_m}. Where a zone of sign 0
    overlaps another one, the sensor reads 0. It also reads 0 outside all zones, where no switch is
    pressed. At a common end of a - and a + zone the later one in the list counts."""
    false_rate: Fraction = 0.0
    """Probability that one reading is false."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        zones = list(enumerate(self.zones or ()))
        for _, minus in zones:
            for k, plus in zones:
                apart = minus.to_m <= plus.from_m or plus.to_m <= minus.from_m
                if (minus.sign, plus.sign) == ("-", "+") and not apart:
                    raise field_error(
                        plus.model_dump(),
                        f"overlaps the zone - from {minus.from_m:g} to {minus.to_m:g}",
                        "zones + and - that do not overlap each other",
                        f"zones[{k}]",
                    )
        return self


class Control(Section):
    """[control] The controllers."""

    period_s: Period = 0.01
    """Time between two controller steps."""
    watchdog_s: Duration = 0.1
    """If a controller has not stepped for this time, its robot stops and restarts."""
    brake: Switch = True
    """Controllers shared-sign and silent: whether a robot may stop to correct a contact that is off
    centre, or because its partner seems to stand."""
    start: Literal["together", "touch"] = "together"
    """Controllers silent and shared-sign. together: both robots start at an agreed time. touch: the
    follower starts, and the leader when it feels that, or hears it."""

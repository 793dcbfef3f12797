# SPDX-License-Identifier: Apache-2.0
"""Hardware tables and their formulas against a robot of the test that obeys the commands."""

import itertools
import math
import random
from dataclasses import dataclass, field, replace
from typing import Any

import pytest

from palmbots.drivers.driver import Drive, DriverSettings, RawCommand, RawReading
from palmbots.drivers.hardware import (
    Hardware,
    HardwareParameters,
    forward_distance,
    heading,
    motor_command,
    motor_power,
    oriented,
    palm_angle,
    pressed_sign,
    servo_angle,
    servo_pulse_s,
    wheel_rates,
)
from palmbots.drivers.hardware_io import HardwareIo
from palmbots.errors import PalmbotsError
from scripted_drivers import NotedHardware

PERIOD_S = 0.01


@dataclass
class Robot:
    """A robot with wheels of two sizes [m], motors with a dead zone and stiction [rad/s]."""

    radii: tuple[float, float]
    separation: float
    dead: float = 0.0
    stiction: float = 0.0
    counts_per_turn: float = 1e6
    turned: list[float] = field(default_factory=lambda: [0.0, 0.0])
    rates: list[float] = field(default_factory=lambda: [0.0, 0.0])
    place: complex = 0j
    yaw: float = 0.0

    def step(self, command: RawCommand) -> None:
        for wheel, wanted in enumerate(command.wheels_rad_s):
            least = self.dead if self.rates[wheel] else self.stiction
            over = max(0.0, abs(wanted) - self.dead) if abs(wanted) >= least else 0.0
            self.rates[wheel] = math.copysign(over, wanted)
            self.turned[wheel] += self.rates[wheel] * PERIOD_S
        left, right = (r * w for r, w in zip(self.radii, self.rates, strict=True))
        self.yaw += (right - left) / self.separation * PERIOD_S
        self.place += (
            0.5 * (left + right) * PERIOD_S * complex(math.cos(self.yaw), math.sin(self.yaw))
        )

    def reading(self) -> RawReading:
        counts = [int(t / (2 * math.pi) * self.counts_per_turn) for t in self.turned]
        return RawReading((counts[0], counts[1]), (False, True, False))


def hardware_of(robot: Robot, **values: Any) -> HardwareParameters:
    """The table that describes the robot, with a nominal radius that is wrong."""
    left, right = robot.radii
    return HardwareParameters(
        wheel_radius_m=0.04,
        wheel_separation_m=robot.separation,
        wheel_scale=(left + right) / 2 / 0.04,
        trim=2 * (left - right) / (left + right),
        dead_zone_m_s=robot.dead * 0.04,
        stiction_m_s=robot.stiction * 0.04 * 1.001,
        encoder_ticks_per_turn=robot.counts_per_turn,
        **values,
    )


def drive(speed: float, palm_rad: float = 0.1, *, wheels: bool = True) -> Drive:
    return Drive(0, 0, speed == 0, wheels, palm_rad, speed)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("leads", [False, True])
def test_a_robot_drives_straight_and_knows_how_far(seed: int, leads: bool) -> None:
    chance = random.Random(seed)
    radii = (chance.uniform(0.037, 0.043), chance.uniform(0.038, 0.042))
    dead = chance.uniform(0, 0.5)
    robot = Robot(radii, 0.22, dead, dead + chance.uniform(0, 1.0))
    hardware = hardware_of(robot)
    io = HardwareIo(hardware, leads=leads)
    speed = chance.choice([0.03, 0.06, 0.09])
    reading = io.reading(robot.reading(), 0.0)
    start = 0.0
    for tick in range(1000):
        robot.step(io.command(drive(speed), tick * PERIOD_S))
        reading = io.reading(robot.reading(), tick * PERIOD_S)
        start = robot.place.real if tick == 499 else start
    sense = -1 if leads else 1
    assert robot.place.real * sense > 0
    # The kick against stiction may turn one wheel more than the other, for some ticks.
    assert robot.yaw == pytest.approx(0, abs=0.05)
    yaw = heading(hardware, robot.reading().wheel_counts or ())
    assert yaw == pytest.approx(robot.yaw, abs=1e-3)
    assert reading.distance_m == pytest.approx(sense * robot.place.real, rel=2e-3)
    # Once it moves it has the speed that the controller wants.
    assert sense * (robot.place.real - start) / 5.0 == pytest.approx(speed, rel=2e-3)


def test_without_the_table_it_does_not() -> None:
    robot = Robot((0.042, 0.038), 0.22)
    io = HardwareIo(HardwareParameters(), leads=False)
    for tick in range(1000):
        robot.step(io.command(drive(0.06), tick * PERIOD_S))
    assert abs(robot.yaw) > 0.2


@pytest.mark.parametrize("counts_per_turn", [20.0, 0.0])
def test_stiction_is_overcome_with_coarse_encoders_or_none(counts_per_turn: float) -> None:
    robot = Robot((0.04, 0.04), 0.22, 0.2, 2.0, counts_per_turn or 1.0)
    hardware = hardware_of(robot).model_copy(update={"encoder_ticks_per_turn": counts_per_turn})
    io = HardwareIo(hardware, leads=False)
    for tick in range(1000):
        robot.step(io.command(drive(0.03), tick * PERIOD_S))
        if counts_per_turn:
            io.reading(robot.reading(), tick * PERIOD_S)
    assert robot.place.real == pytest.approx(0.3, rel=0.06)  # the kicks make it a little more
    assert robot.rates == pytest.approx([0.75, 0.75])


def test_a_stop_does_not_wait_for_the_acceleration_limit() -> None:
    io = HardwareIo(HardwareParameters(acceleration_m_s2=0.5), leads=False)
    rates = [io.command(drive(0.06), tick * PERIOD_S).wheels_rad_s[0] for tick in range(30)]
    assert rates[0] == 0
    steps = [b - a for a, b in itertools.pairwise(rates)]
    assert max(steps) == pytest.approx(0.5 * PERIOD_S / 0.04)
    assert rates[-1] == pytest.approx(0.06 / 0.04)
    # A drive of speed 0 brakes gently; wheels that must not turn stop in the same tick.
    assert io.command(drive(0.0), 0.3).wheels_rad_s[0] > 1.0
    assert io.command(drive(0.0, wheels=False), 0.31).wheels_rad_s == (0, 0)


def test_servo_with_zero_scale_range_and_pulse() -> None:
    hardware = HardwareParameters(servo_zero_deg=80, servo_scale=-2.0, servo_max_deg=120)
    for palm_deg in (-15, 0, 10, 30):
        servo = servo_angle(hardware, math.radians(palm_deg))
        assert math.degrees(servo) == pytest.approx(80 - 2 * palm_deg)
        assert math.degrees(palm_angle(hardware, servo)) == pytest.approx(palm_deg)
    assert math.degrees(servo_angle(hardware, math.radians(-60))) == pytest.approx(120)
    assert math.degrees(servo_angle(hardware, math.radians(60))) == pytest.approx(0)
    assert servo_pulse_s(hardware, math.radians(120)) == pytest.approx(0.0025)
    assert servo_pulse_s(hardware, math.radians(60)) == pytest.approx(0.0015)
    assert servo_pulse_s(hardware, 9.0) == 0.0025


def test_a_palm_is_at_its_target_when_it_is_measured_there_or_after_the_time_it_needs() -> None:
    hardware = HardwareParameters(servo_zero_deg=90, servo_rate_deg_s=50, servo_scale=2.0)
    closed = (False, False, True)
    io = HardwareIo(hardware, leads=False)
    assert not io.reading(RawReading(None, closed), 0.0).palm_at_target
    io.command(drive(0, math.radians(5)), 0.0)
    assert not io.reading(RawReading(None, closed), 3.59).palm_at_target  # 180° at 50°/s
    assert io.reading(RawReading(None, closed), 3.61).palm_at_target
    io.command(drive(0, math.radians(15)), 4.0)  # 20° of the servo
    assert not io.reading(RawReading(None, closed), 4.39).palm_at_target
    assert io.reading(RawReading(None, closed), 4.41).palm_at_target
    at = {deg: RawReading(None, closed, servo_rad=math.radians(deg)) for deg in (119, 125)}
    assert io.reading(at[119], 4.0).palm_at_target  # half a degree of the palm
    assert not io.reading(at[125], 9.0).palm_at_target


def test_readings_without_encoders_battery_and_contact() -> None:
    io = HardwareIo(HardwareParameters(encoder_ticks_per_turn=0), leads=False)
    seen = io.reading(RawReading((5, 5), (False, False, False)), 0.0)
    assert math.isnan(seen.distance_m)
    assert (seen.sign, seen.has_contact, seen.battery_v) == (0, False, None)
    seen = io.reading(RawReading(None, (True, False, False), battery_v=7.4), 0.0)
    assert (seen.sign, seen.has_contact, seen.battery_v) == (-1, True, 7.4)


@pytest.mark.parametrize(
    ("closed", "sign"),
    [((0, 0, 0), 0), ((1, 0, 0), -1), ((0, 1, 0), 0), ((0, 0, 1), 1), ((1, 1, 0), 0),
     ((0, 1, 1), 0), ((1, 0, 1), 1)],
)  # fmt: skip
def test_sign_of_the_closed_switches(closed: tuple[int, ...], sign: int) -> None:
    assert pressed_sign(HardwareParameters(), [bool(one) for one in closed]) == sign


def test_power_and_orientation() -> None:
    hardware = HardwareParameters(full_speed_m_s=0.2, right_reversed=True)
    assert motor_power(hardware, 0.1 / 0.04) == pytest.approx(0.5)
    assert motor_power(hardware, -90) == -1
    assert oriented(hardware, (3, 4)) == (3, -4)
    assert oriented(hardware, oriented(hardware, (3, 4))) == (3, 4)
    assert motor_command(hardware, 0.0, turns=False) == 0
    assert wheel_rates(hardware, 0.0) == (0, 0)
    assert forward_distance(hardware, (1440, 1440)) == pytest.approx(2 * math.pi * 0.04)


def test_keys_of_one_robot_override_those_of_both() -> None:
    hardware = Hardware.model_validate({"trim": 0.01, "left": {"trim": -0.02}, "right": {}})
    assert (hardware.of("left").trim, hardware.of("right").trim) == (-0.02, 0.01)
    assert set(type(hardware.left).model_fields) == set(HardwareParameters.model_fields)


def test_encoders_that_a_driver_does_not_read_are_refused() -> None:
    class Blind(NotedHardware):
        def read_raw(self) -> RawReading:
            return RawReading(None, (False, True, False))

    settings = DriverSettings("left", leads=False, address="", period_s=0.01, watchdog_s=0.1)
    with pytest.raises(PalmbotsError, match="encoder_ticks_per_turn: value is 1440, but the driv"):
        Blind(settings).read()
    without = HardwareParameters(encoder_ticks_per_turn=0)
    assert Blind(replace(settings, hardware=without)).read() is not None

# SPDX-License-Identifier: Apache-2.0
"""What a calibration works with: a robot that stands alone (`Machine`) and a person (`Person`).

`Task` is what the robot is calibrated for, and `Finding` is what a step finds.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from palmbots.drivers.arm import ArmShape
from palmbots.drivers.driver import RawAccess, RawCommand, RawReading
from palmbots.drivers.hardware import HardwareParameters, motor_command, ramped, wheel_rates
from palmbots.errors import PalmbotsError
from palmbots.pair.estimates import Estimate

_DIGITS = 6
_STILL_S = 0.3  # a wheel that has not counted for this time rests


@dataclass(frozen=True)
class Task:
    """What the robot is calibrated for."""

    length_m: float
    """Length of the drive along the tape."""
    speed_m_s: float
    """Nominal speed, from which the robot has to stop."""
    palm_deg: tuple[float, float]
    """Shallow and steep angle of the palm."""
    palm_half_m: float
    """Half the length of the palm."""
    arm: ArmShape | None = None
    """What the job of the scene asks of the arm; None: it is not on the floor."""


@dataclass(frozen=True)
class Finding:
    """One value of the hardware."""

    key: str
    """In ``[hardware]``."""
    value: Any
    """As it is written; None: it is a part of another one."""
    estimate: Estimate | None
    """In the unit of the key; None: it has no interval."""
    note: str = ""
    """What else the user has to know."""


def rounded(value: float) -> float:
    """With the digits that are written."""
    return float(f"{value:.{_DIGITS}g}")


def finding(key: str, estimate: Estimate, value: float | None = None) -> Finding:
    """A finding with a rounded value: that of the estimate, if no other is given."""
    return Finding(key, rounded(estimate.value if value is None else value), estimate)


class Person(Protocol):
    """Who does what the calibration asks for. Every method returns when that is done."""

    def ready(self, text: str) -> None:
        """Do what a line says."""
        ...

    def number(self, text: str, unit: str, least: float, most: float) -> float:
        """Read a number off an instrument, in this unit."""
        ...

    def watch(self, text: str, changed: Callable[[], bool]) -> bool:
        """Move something slowly until `changed` returns true; false: it cannot be moved further."""
        ...


class Machine:
    """The hardware of a robot, tick by tick.

    Args:
        driver: of the robot.
        hardware: what is known of it so far.
        wait: waits for the next control tick, and returns the number of ticks since the last call.
        period_s: time between two ticks.
    """

    def __init__(
        self,
        driver: RawAccess,
        hardware: HardwareParameters,
        wait: Callable[[], int],
        period_s: float,
    ) -> None:
        self._driver, self._wait = driver, wait
        self.hardware = hardware
        self.period_s = period_s
        self._servo_rad: float | None = None
        self._arm_rad: float | None = None
        self.missed = 0
        """How many ticks have passed so far without a command, because the program was late."""

    def read(self) -> RawReading:
        """The newest reading.

        Raises:
            PalmbotsError: the hardware is lost.
        """
        reading = self._driver.read_raw()
        if reading is None:
            raise PalmbotsError("driver: the hardware is gone")
        return reading

    def step(self, left: float, right: float) -> RawReading:
        """Command the wheels [rad/s] for one tick; returns the reading after it."""
        self._driver.write_raw(RawCommand((left, right), self._servo_rad, self._arm_rad))
        elapsed = self._wait()
        self.missed += elapsed - 1
        return self.read()

    def stop(self) -> None:
        """Stop the wheels."""
        self._driver.write_raw(RawCommand((0.0, 0.0), self._servo_rad, self._arm_rad))

    def turn_servo(self, servo_rad: float, seconds: float) -> None:
        """Command the servo, and wait until it has turned."""
        self._servo_rad = servo_rad
        self.rest(seconds)

    def move_arm(self, servo_rad: float, seconds: float, settle_s: float) -> None:
        """Command the servo of the arm, evenly in some time from its last command, and wait."""
        before = servo_rad if self._arm_rad is None else self._arm_rad
        ticks = max(1, math.ceil(seconds / self.period_s))
        for tick in range(1, ticks + 1):
            self._arm_rad = before + tick / ticks * (servo_rad - before)
            self.step(0.0, 0.0)
        self.rest(settle_s)

    def rest(self, seconds: float) -> RawReading:
        """Let the wheels rest for some time."""
        reading = self.read()
        for _ in range(max(1, math.ceil(seconds / self.period_s))):
            reading = self.step(0.0, 0.0)
        return reading

    def counts(self, reading: RawReading) -> tuple[float, float]:
        """The counts of the encoders.

        Raises:
            PalmbotsError: there are none.
        """
        if reading.wheel_counts is None or self.hardware.encoder_ticks_per_turn == 0:
            raise PalmbotsError(
                "hardware.encoder_ticks_per_turn: without encoders, wheels, dead zone and stopping "
                "time cannot be measured; allowed: --only palm,switches"
            )
        return reading.wheel_counts

    @property
    def count_rad(self) -> float:
        """Turn of a wheel for one count [rad]."""
        return 2 * math.pi / self.hardware.encoder_ticks_per_turn

    def drive(self, speed_m_s: float, turn: float) -> tuple[float, float]:
        """Drive forward until both wheels have turned by an angle [rad] on average, and come to
        rest; returns the counts meanwhile of both wheels.

        Raises:
            PalmbotsError: the wheels do not turn as commanded.
        """
        start = self.counts(self.rest(5 * self.period_s))  # the newest one was old
        now, speed = start, 0.0
        give_up = (
            math.ceil(5 * turn * self.hardware.wheel_radius_m / speed_m_s / self.period_s) + 500
        )
        for tick in range(give_up):
            speed = ramped(self.hardware, speed_m_s, speed, self.period_s)
            left, right = (
                motor_command(self.hardware, rate, turns=tick * self.period_s > _STILL_S)
                for rate in wheel_rates(self.hardware, speed)
            )
            now = self.counts(self.step(left, right))
            done = (now[0] - start[0] + now[1] - start[1]) / 2 * self.count_rad
            if done >= turn:
                break
        else:
            self.stop()
            raise PalmbotsError(
                "wheels: they do not turn forward as commanded; allowed: a motor board that has "
                "power, and the right hardware.left_reversed and hardware.right_reversed"
            )
        while speed > 0:  # gently, so that nothing slips
            speed = ramped(self.hardware, 0.0, speed, self.period_s)
            left, right = (
                motor_command(self.hardware, rate, turns=True)
                for rate in wheel_rates(self.hardware, speed)
            )
            self.step(left, right)
        now = self.counts(self.rest(2 * _STILL_S))
        return now[0] - start[0], now[1] - start[1]

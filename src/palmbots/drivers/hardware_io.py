# SPDX-License-Identifier: Apache-2.0
"""What a driver of real hardware computes in every control tick, both ways.

`HardwareIo` holds what has to be remembered between two ticks. The formulas are those of
`palmbots.drivers.hardware`.
"""

import math

from palmbots.drivers.arm import LONGEST_MOVE_S, NEW_ARM, ArmMotion, ArmShape, StoredArm
from palmbots.drivers.driver import Drive, RawCommand, RawReading, Reading
from palmbots.drivers.hardware import (
    HardwareParameters,
    arm_servo_angle,
    forward_distance,
    motor_command,
    palm_angle,
    pressed_sign,
    ramped,
    servo_angle,
    wheel_rates,
)

_KICK_S = 0.1
"""A wheel without encoders gets the command against stiction for this time; assumed."""
_PALM_SLACK = math.radians(1.0)
"""A palm this close to its target has reached it; assumed."""


class HardwareIo:
    """Converts between a controller's words and the motors of one robot.

    Args:
        hardware: of the robot.
        leads: the robot travels away from its partner, which is behind it.
        arm: what the job asks of the arm; None: it begins and ends on the palms.
        stored_arm: before the boot.
    """

    def __init__(
        self,
        hardware: HardwareParameters,
        *,
        leads: bool,
        arm: ArmShape | None = None,
        stored_arm: StoredArm = NEW_ARM,
    ) -> None:
        self._hardware = hardware
        self._arm_shape = arm
        self._arm = None if arm is None else ArmMotion(arm, stored_arm)
        self._sense = -1.0 if leads else 1.0
        self._touches = False  # a switch was closed at the newest reading
        self._speed_m_s = 0.0  # commanded last, forward
        self._time_s: float | None = None
        self._palm_rad: float | None = None
        self._turned_s = 0.0  # when the palm has reached its target, if it is not measured
        self._starts_s = [math.inf, math.inf]  # when each wheel was first commanded to turn
        self._counts: tuple[float, float] | None = None
        self._counted_s = [-math.inf, -math.inf]  # when each encoder has counted last

    def command(self, drive: Drive, now_s: float) -> RawCommand:
        """What the motors are commanded for a drive.

        Args:
            drive: of the controller.
            now_s: time of a clock that only goes forward.
        """
        hardware = self._hardware
        elapsed_s = 0.0 if self._time_s is None else now_s - self._time_s
        self._time_s = now_s
        wanted = self._sense * drive.speed_m_s
        speed = ramped(hardware, wanted, self._speed_m_s, elapsed_s) if drive.wheels else 0.0
        self._speed_m_s = speed
        rates = wheel_rates(hardware, speed)
        commands = [
            motor_command(hardware, rate, turns=self._turns(wheel, rate, now_s))
            for wheel, rate in enumerate(rates)
        ]
        if drive.palm_rad != self._palm_rad:
            before = self._palm_rad
            self._palm_rad = drive.palm_rad
            turn = math.inf if before is None else abs(drive.palm_rad - before)
            self._turned_s = now_s + self._turning_s(turn)
        arm_rad = None
        if self._arm is not None and self._arm_shape is not None:
            self._arm.move(
                drive.arm, drive.palm, min(elapsed_s, LONGEST_MOVE_S),
                ends=drive.arm_ends, touches=self._touches,
            )  # fmt: skip
            arm_rad = arm_servo_angle(hardware, self._arm_shape, self._arm.pivot_m)
        turned = servo_angle(hardware, drive.palm_rad)
        return RawCommand((commands[0], commands[1]), turned, arm_rad)

    def reading(self, raw: RawReading, now_s: float) -> Reading:
        """The reading that a raw reading means."""
        hardware = self._hardware
        counts = raw.wheel_counts
        distance_m = math.nan
        if counts is not None and hardware.encoder_ticks_per_turn > 0:
            distance_m = self._sense * forward_distance(hardware, counts)
            if self._counts is not None:
                for wheel, (now, before) in enumerate(zip(counts, self._counts, strict=True)):
                    if now != before:
                        self._counted_s[wheel] = now_s
            self._counts = counts
        has_middle = any(zone.sign == "0" for zone in hardware.switches)
        self._touches = any(raw.closed)
        seen = Reading(
            pressed_sign(hardware, raw.closed),
            self._is_turned(raw.servo_rad, now_s),
            distance_m,
            raw.battery_v,
            self._touches or not has_middle,
        )
        return seen if self._arm is None else seen.with_arm(self._arm)

    def _turns(self, wheel: int, rate: float, now_s: float) -> bool:
        """Whether a wheel turns already, as far as can be said."""
        if rate == 0:
            self._starts_s[wheel] = math.inf
            return False
        self._starts_s[wheel] = min(self._starts_s[wheel], now_s)
        if self._counts is None:
            return now_s - self._starts_s[wheel] > _KICK_S
        count_s = 2 * math.pi / self._hardware.encoder_ticks_per_turn / abs(rate)
        return now_s - self._counted_s[wheel] <= 2 * count_s + _KICK_S / 2

    def _turning_s(self, turn: float) -> float:
        """The time that the servo needs for a turn of the palm [rad]."""
        hardware = self._hardware
        whole = math.radians(hardware.servo_max_deg - hardware.servo_min_deg)
        servo = min(whole, abs(hardware.servo_scale) * turn)
        return servo / math.radians(hardware.servo_rate_deg_s)

    def _is_turned(self, servo_rad: float | None, now_s: float) -> bool:
        if self._palm_rad is None:
            return False
        if servo_rad is None:
            return now_s >= self._turned_s
        target = palm_angle(self._hardware, servo_angle(self._hardware, self._palm_rad))
        return abs(palm_angle(self._hardware, servo_rad) - target) <= _PALM_SLACK

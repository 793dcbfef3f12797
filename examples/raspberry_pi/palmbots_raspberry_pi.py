# SPDX-License-Identifier: Apache-2.0
"""A driver of your own: a Raspberry Pi with two motors, a servo and nine switches.

Install it on the robot, pip install ./examples/raspberry_pi lgpio, and use it in pair.toml:

[driver]
kind = "raspberry-pi"
[driver.options]                               # numbers of the pins (BCM)
left = [17, 27]                                # forward and backward input of the motor driver
right = [22, 23]
servo = 18
switches = [5, 6, 12, 13, 16, 19, 20, 21, 26]  # each closes to ground

The wheels have no encoders here, so set hardware.encoder_ticks_per_turn = 0. The pins keep their
levels when this program is stopped or killed. The driver therefore does not state a watchdog, and
palmbots runs it in a guard process, which stops the wheels.
"""

import math

from gpiozero import DigitalInputDevice, Motor, PWMOutputDevice

from palmbots.drivers.driver import DriverSettings, RawCommand, RawReading
from palmbots.drivers.hardware import motor_power, oriented, servo_pulse_s
from palmbots.drivers.hardware_driver import HardwareDriver
from palmbots.errors import PalmbotsError

FRAMES_PER_S = 50


class RaspberryPi(HardwareDriver):
    """Motors through an H-bridge, a hobby servo, switches with pull-ups."""

    def __init__(self, settings: DriverSettings) -> None:
        super().__init__(settings)
        pins = settings.options
        try:
            self._wheels = [Motor(*pins["left"]), Motor(*pins["right"])]
            self._servo = PWMOutputDevice(pins["servo"], frequency=FRAMES_PER_S)
            self._switches = [DigitalInputDevice(pin, pull_up=True) for pin in pins["switches"]]
        except KeyError as error:
            raise PalmbotsError(f"driver.options: {error.args[0]} is missing") from None

    def read_raw(self) -> RawReading:
        """The switches; a closed one pulls its pin to ground."""
        return RawReading(None, tuple(bool(switch.value) for switch in self._switches))

    def write_raw(self, command: RawCommand) -> None:
        """Power to the motors, and a pulse for the servo."""
        hardware = self.settings.hardware
        for wheel, rate in zip(self._wheels, oriented(hardware, command.wheels_rad_s), strict=True):
            wheel.value = motor_power(hardware, rate)
        if command.servo_rad is not None and math.isfinite(command.servo_rad):
            self._servo.value = FRAMES_PER_S * servo_pulse_s(hardware, command.servo_rad)

    def close(self) -> None:
        """Stop the wheels, and free the pins."""
        super().close()
        for device in [*self._wheels, self._servo, *self._switches]:
            device.close()

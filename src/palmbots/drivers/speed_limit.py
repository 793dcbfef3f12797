# SPDX-License-Identifier: Apache-2.0
"""The speed limit of a robot, ``limits.max_speed_m_s``, before any driver sees a command."""

import math
from dataclasses import replace

from palmbots.drivers.driver import (
    Drive,
    Driver,
    DriverSettings,
    RawAccess,
    RawCommand,
    RawReading,
    Reading,
    works,
)
from palmbots.drivers.hardware import wheel_scales


class LimitedDriver:
    """A driver that is never given a faster command. A speed that is no number stops the wheels."""

    def __init__(self, driver: Driver, settings: DriverSettings) -> None:
        self._driver, self._most = driver, settings.max_speed_m_s

    def read(self) -> Reading | None:
        """As the driver's own."""
        return self._driver.read()

    @property
    def works(self) -> bool:
        """As the driver's own."""
        return works(self._driver)

    @property
    def loss(self) -> str:
        """Why the driver was lost last; empty: it was not, or does not say so."""
        return getattr(self._driver, "loss", "")

    @property
    def call_s(self) -> tuple[float, float] | None:
        """How long a guard process last took for a read and for a write; None: there is none."""
        return getattr(self._driver, "call_s", None)

    @property
    def clock_rate(self) -> float:
        """How fast the clock of the robot's program runs; 1 except for simulated robots."""
        return getattr(self._driver, "clock_rate", 1.0)

    def write(self, drive: Drive) -> None:
        """Command palm and wheels, at most at the limit."""
        if math.isnan(drive.speed_m_s):
            drive = replace(drive, wheels=False, speed_m_s=0.0)
        speed_m_s = max(-self._most, min(drive.speed_m_s, self._most))
        self._driver.write(replace(drive, speed_m_s=speed_m_s))

    def stop(self) -> None:
        """As the driver's own."""
        self._driver.stop()

    def close(self) -> None:
        """As the driver's own."""
        self._driver.close()


class LimitedRawDriver(LimitedDriver):
    """The same for a driver that gives access to its hardware as it is."""

    def __init__(self, driver: Driver, raw: RawAccess, settings: DriverSettings) -> None:
        super().__init__(driver, settings)
        self._raw = raw
        metres = [settings.hardware.wheel_radius_m * s for s in wheel_scales(settings.hardware)]
        self._most_rad_s = [settings.max_speed_m_s / one for one in metres]

    def read_raw(self) -> RawReading | None:
        """As the driver's own."""
        return self._raw.read_raw()

    def write_raw(self, command: RawCommand) -> None:
        """Command the motors, at most at the limit."""
        left, right = (
            0.0 if math.isnan(rate) else max(-most, min(rate, most))
            for rate, most in zip(command.wheels_rad_s, self._most_rad_s, strict=True)
        )
        self._raw.write_raw(replace(command, wheels_rad_s=(left, right)))


def limited(driver: Driver, settings: DriverSettings) -> Driver:
    """The driver with the speed limit of its settings."""
    if isinstance(driver, RawAccess) and getattr(driver, "has_raw", True):
        return LimitedRawDriver(driver, driver, settings)
    return LimitedDriver(driver, settings)

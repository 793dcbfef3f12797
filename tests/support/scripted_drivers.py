# SPDX-License-Identifier: Apache-2.0
"""Drivers of somebody else, as the tests of the guard install them.

Each writes what it does, with the time, into the file `driver.address`.
"""

import os
import time
from pathlib import Path

from palmbots.drivers.driver import Drive, DriverSettings, RawCommand, RawReading, Reading
from palmbots.drivers.hardware_driver import HardwareDriver
from palmbots.errors import PalmbotsError


class Noted:
    """The least that a driver has to have."""

    def __init__(self, settings: DriverSettings) -> None:
        self._file = Path(settings.address)
        self._options = settings.options
        self._reads = 0
        self._note("open", os.getpid())
        if "refuse" in self._options:
            raise PalmbotsError(f"driver.options.refuse: {self._options['refuse']}")
        if "crash" in self._options:
            raise RuntimeError("no such bus")

    def _note(self, *words: object) -> None:
        with self._file.open("a") as stream:
            stream.write(" ".join(map(str, [f"{time.monotonic():.4f}", *words])) + "\n")

    def read(self) -> Reading | None:
        self._reads += 1
        if self._reads == self._options.get("end_after"):
            return None
        if self._reads == self._options.get("fail_after"):
            raise OSError(5, "Input/output error")
        return Reading(1, True, float("nan"), 7.5, True)

    def write(self, drive: Drive) -> None:
        print("a driver that prints disturbs nobody")
        self._note("write", drive.speed_m_s if drive.wheels else 0.0)

    def stop(self) -> None:
        self._note("stop")

    def close(self) -> None:
        self._note("close")


class NotedHardware(HardwareDriver):
    """One with access to its hardware."""

    def __init__(self, settings: DriverSettings) -> None:
        super().__init__(settings)
        self.command = RawCommand((0.0, 0.0))

    def read_raw(self) -> RawReading:
        return RawReading(self.command.wheels_rad_s, (False, True, False), self.command.servo_rad)

    def write_raw(self, command: RawCommand) -> None:
        self.command = command


class WithWatchdog(Noted):
    """One whose hardware stops by itself."""

    has_watchdog = True

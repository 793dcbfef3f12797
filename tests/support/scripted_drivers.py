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
        self._arm = settings.stored_arm._replace(pivot_m=settings.stored_arm.pivot_m + 0.01)
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
        return Reading(1, True, float("nan"), 7.5, True, stored_arm=self._arm)

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


class Toy(HardwareDriver):
    """One whose hardware stops by itself, and which fails as its options say: `fails` is the
    method, `after` how many calls go well before, `times` how often the driver is opened and fails.
    Only the first time, calls go well before."""

    has_watchdog = True
    opened = 0

    def __init__(self, settings: DriverSettings) -> None:
        super().__init__(settings)
        self._calls = {"read_raw": 0, "write_raw": 0}
        self.commands: list[RawCommand] = []
        type(self).opened += 1
        self._number = type(self).opened

    def _fail(self, method: str) -> None:
        options = self.settings.options
        self._calls[method] += 1
        well = options.get("after", 0) if self._number == 1 else 0
        fails = options.get("fails") == method and self._number <= options.get("times", 1)
        if fails and self._calls[method] > well:
            raise OSError(5, "Input/output error")  # the line that the tests look for

    def read_raw(self) -> RawReading | None:
        self._fail("read_raw")
        if "returns" in self.settings.options:
            return self.settings.options["returns"]
        time.sleep(self.settings.options.get("waits_s", 0.0))
        switches = len(self.settings.hardware.switches)
        return RawReading((0.0, 0.0), (False,) * switches, None, None)

    def write_raw(self, command: RawCommand) -> None:
        self._fail("write_raw")
        self.commands.append(command)


class GuardedToy(Toy):
    """The same in a guard process."""

    has_watchdog = False

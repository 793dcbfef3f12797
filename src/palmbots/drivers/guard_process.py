# SPDX-License-Identifier: Apache-2.0
"""The guard process of a driver (`palmbots.drivers.guard`): python -m … DESCRIPTOR.

It opens the driver that it is given on standard input, sends its readings to the robot's program in
every period, and writes the program's commands to it. Each command states when it was given, by
the clock of this machine. The wheels stop when the newest command is nearly as old as the watchdog
allows, and when the connection ends; then this process ends, too.
"""

import contextlib
import math
import pickle
import select
import signal
import socket
import sys
import time
from dataclasses import asdict
from typing import Any

from palmbots.drivers.driver import (
    WATCHDOG_SHARE,
    Drive,
    Driver,
    DriverSettings,
    RawAccess,
    RawCommand,
    targets,
    works,
)
from palmbots.drivers.driver_registry import DRIVERS
from palmbots.drivers.own_driver import checked, failure
from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import Connection, ConnectionLost


def main() -> None:
    """Open the driver, and guard it until the robot's program has gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    kind, settings = pickle.load(sys.stdin.buffer)
    stream = socket.socket(fileno=int(sys.argv[1]))
    program = Connection(stream, "robot")
    with contextlib.closing(program):
        make: Any = None
        try:
            make = DRIVERS.get(kind)
            driver = make(settings)
        except Exception as error:  # whatever a driver of somebody else does
            _report_failure(program, make, error)
            return
        try:
            _Guard(driver, settings, program, stream).run()
        except ConnectionLost:
            pass
        except Exception as error:
            _report_failure(program, make, error)
        finally:
            with contextlib.suppress(Exception):
                driver.stop()
            with contextlib.suppress(Exception):
                driver.close()


def _report_failure(program: Connection, make: Any, error: Exception) -> None:
    name = "refused" if isinstance(error, PalmbotsError) else "failed"
    with contextlib.suppress(ConnectionLost):
        program.send([name, failure(make, error)])


class _Guard:
    def __init__(
        self, driver: Driver, settings: DriverSettings, program: Connection, stream: socket.socket
    ) -> None:
        self._driver, self._program, self._stream = driver, program, stream
        self._period_s = settings.period_s
        self._limit_s = WATCHDOG_SHARE * settings.watchdog_s
        self._write_s = 0.0  # how long the last command took
        self._stop_s = math.inf  # when the wheels have to stop if no command comes
        self._obeyed: list[float] | None = None  # palm angle and arm of the newest command

    def run(self) -> None:
        """Pass on readings and commands, until the connection or the driver ends."""
        next_s = time.monotonic()
        while True:
            wait_s = max(0.0, min(next_s, self._stop_s) - time.monotonic())
            select.select([self._stream], [], [], wait_s)
            self._obey()
            now = time.monotonic()
            if now >= self._stop_s:
                self._stop_s = math.inf
                self._driver.stop()
            if now >= next_s:
                next_s = max(next_s + self._period_s, now)
                if not self._send_reading():
                    return

    def _obey(self) -> None:
        """Carry out the newest command, unless it is too old by now."""
        newest: Any = None
        while (frame := self._program.poll()) is not None:
            newest = frame
        if newest is None:
            return
        name, given_s, content = newest
        if time.monotonic() >= given_s + self._limit_s:
            return
        if name == "stop":
            self._stop_s = math.inf
            self._driver.stop()
            return
        self._stop_s = given_s + self._limit_s
        begin_s = time.monotonic()
        if name == "drive":
            drive = Drive(*content)
            self._driver.write(drive)
            self._obeyed = targets(drive)
        elif isinstance(self._driver, RawAccess):
            (left, right), *servos = content
            self._driver.write_raw(RawCommand((left, right), *servos))
        self._write_s = time.monotonic() - begin_s

    def _send_reading(self) -> bool:
        """Send a reading; false: the hardware has ended the carry."""
        begin_s = time.monotonic()
        seen = checked(self._driver.read())
        if seen is None:
            self._program.send("end")
            return False
        distance_m = None if math.isnan(seen.distance_m) else seen.distance_m
        shape = asdict(seen) | {"distance_m": distance_m}
        raw = getattr(self._driver, "newest_raw", None)  # to read twice takes twice as long
        if raw is None and isinstance(self._driver, RawAccess):
            raw = self._driver.read_raw()
        if raw is not None:
            raw = [raw.wheel_counts, raw.closed, raw.servo_rad, raw.battery_v]
        call_s = [time.monotonic() - begin_s, self._write_s]
        self._program.offer(["reading", [shape, raw, works(self._driver), call_s, self._obeyed]])
        return True


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: Apache-2.0
"""A driver of another distribution in the robot's own process (`OwnDriver`).

Whatever its methods raise counts as lost hardware, as with a guard process: the others hear of it,
the wheels are commanded to stop, and the driver is opened again until that succeeds. The line for
the operator names the exception and the place in the driver (`failure`).
"""

import contextlib
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from palmbots.control.own_code import show_error
from palmbots.drivers.driver import (
    Drive,
    Driver,
    DriverFailed,
    DriverMaker,
    DriverSettings,
    RawAccess,
    RawCommand,
    RawReading,
    Reading,
    works,
)
from palmbots.errors import PalmbotsError

_RETRY_S = 1.0
_Value = TypeVar("_Value")


def failure(make: Any, error: Exception) -> str:
    """What an exception of a driver means to the operator: its text, and the place in the driver.

    Args:
        make: what opened the driver.
        error: raised by the driver. The text of a `PalmbotsError` suffices.
    """
    if isinstance(error, PalmbotsError):
        return str(error)
    package = str(getattr(make, "__module__", "")).partition(".")[0]
    place, trace = "", error.__traceback__
    while trace is not None:
        code, name = trace.tb_frame.f_code, trace.tb_frame.f_globals.get("__name__", "")
        if package and str(name).partition(".")[0] == package:
            place = f" at {Path(code.co_filename).name}:{trace.tb_lineno}"
        trace = trace.tb_next
    return show_error(error) + place


def checked(seen: Any) -> Reading | None:
    """What `read` of a driver has returned.

    Raises:
        TypeError: it is neither a `Reading` nor None.
    """
    if seen is not None and not isinstance(seen, Reading):
        raise TypeError(f"read returns {type(seen).__name__}; allowed: a Reading, or None")
    return seen


class OwnDriver:
    """A driver that is opened again after an exception.

    Args:
        kind: of the driver.
        make: opens it.
        settings: of the driver.

    Raises:
        PalmbotsError: it cannot be opened, or its first reading fails.
    """

    def __init__(self, kind: str, make: DriverMaker, settings: DriverSettings) -> None:
        self._kind, self._make, self._settings = kind, make, settings
        self.loss = ""
        """Why it was lost last; empty: it was not."""
        self._lost_s = 0.0
        self._is_closed = False
        self._opening: threading.Thread | None = None
        self._newest: Reading | None = None
        self._driver: Driver | None = None
        try:
            self._opened: tuple[Driver, Reading | None] | None = self._open()
        except PalmbotsError:
            raise
        except Exception as error:
            raise DriverFailed(kind, failure(make, error)) from error
        self._take()

    def _open(self) -> tuple[Driver, Reading | None]:
        settings = self._settings
        if self._newest is not None:  # opened again: the arm is where it was
            settings = replace(settings, stored_arm=self._newest.stored_arm)
        driver = self._make(settings)
        try:
            return driver, checked(driver.read())
        except Exception:
            _end(driver)
            raise

    def _take(self) -> None:
        assert self._opened is not None
        (self._driver, self._newest), self._opened = self._opened, None

    def read(self) -> Reading | None:
        """The newest reading; while the driver is lost, the last one."""
        if self._driver is None:
            self._open_again()
        elif (found := self._call(lambda driver: (checked(driver.read()),))) is not None:
            (self._newest,) = found
        return self._newest

    @property
    def works(self) -> bool:
        """The driver is open, and works by its own account."""
        return bool(self._call(works))

    def write(self, drive: Drive) -> None:
        """Command palm and wheels."""
        self._call(lambda driver: driver.write(drive))

    @property
    def has_raw(self) -> bool:
        """The driver gives access to its hardware as it is."""
        return isinstance(self._driver, RawAccess)

    def read_raw(self) -> RawReading | None:
        """The newest reading as it is; None: the driver has none, or is lost."""
        if self._driver is None:
            self._open_again()
        return self._call(lambda driver: driver.read_raw() if _is_raw(driver) else None)

    def write_raw(self, command: RawCommand) -> None:
        """Command the motors."""
        self._call(lambda driver: driver.write_raw(command) if _is_raw(driver) else None)

    def stop(self) -> None:
        """Stop the wheels at once."""
        self._call(lambda driver: driver.stop())

    def close(self) -> None:
        """Stop the wheels, and give the hardware back."""
        self._is_closed = True
        self._call(lambda driver: driver.close())
        self._driver = None

    def _call(self, method: Callable[[Any], _Value]) -> _Value | None:
        """What the driver returns; None: it is lost."""
        if self._driver is None:
            return None
        try:
            return method(self._driver)
        except Exception as error:
            self._lose(failure(self._make, error))
            return None

    def _lose(self, why: str) -> None:
        driver, self._driver = self._driver, None
        with contextlib.suppress(Exception):
            assert driver is not None
            driver.stop()
        self.loss, self._lost_s = why, time.monotonic()
        self._settings.on_line(f"driver.kind: {self._kind} is lost: {why}")
        # Closing and opening may take seconds, and the loop must go on: it passes on a stop.
        self._opening = threading.Thread(target=_end, args=[driver], daemon=True)
        self._opening.start()

    def _open_again(self) -> None:
        """Open the driver once more, in a thread; never waits."""
        if self._is_closed or (self._opening is not None and self._opening.is_alive()):
            return
        if self._opened is not None:
            self._take()
            self._settings.on_line(f"driver.kind: {self._kind} is back")
        elif time.monotonic() - self._lost_s >= _RETRY_S:
            self._lost_s = time.monotonic()
            self._opening = threading.Thread(target=self._try, daemon=True)
            self._opening.start()

    def _try(self) -> None:
        with contextlib.suppress(Exception):  # the next attempt follows
            opened = self._open()
            if self._is_closed:
                _end(opened[0])
            else:
                self._opened = opened


def _is_raw(driver: Any) -> bool:
    return isinstance(driver, RawAccess)


def _end(driver: Any) -> None:
    for method in ("stop", "close"):
        with contextlib.suppress(Exception):
            getattr(driver, method)()

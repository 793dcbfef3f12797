# SPDX-License-Identifier: Apache-2.0
"""The kinds of drivers, and opening one.

Other distributions add kinds under the entry point group ``palmbots.drivers``: a class, or a
function, that takes `DriverSettings` and returns a `Driver` (docs/guide/drivers.md).
"""

import importlib
from typing import cast

from palmbots._util.entry_points import built_in_or_installed
from palmbots._util.offers import offered_entries
from palmbots.drivers.driver import Driver, DriverMaker, DriverSettings
from palmbots.drivers.guard import GuardedDriver
from palmbots.drivers.speed_limit import limited

DRIVER_GROUP = "palmbots.drivers"
"""Group of the entry points."""

_BUILT_IN = {
    "simulated": "palmbots.drivers.simulated:open_simulated",
    "serial": "palmbots.drivers.serial_board:SerialDriver",
    "dry-run": "palmbots.drivers.dry_run:DryRunDriver",
}


def drivers() -> dict[str, str]:
    """The kinds of this package, each as ``module:attribute`` of a `DriverMaker`. Their hardware
    has a watchdog of its own."""
    return _BUILT_IN | offered_entries("driver")


def driver_maker(kind: str) -> DriverMaker:
    """What opens a driver of this kind.

    Raises:
        PalmbotsError: there is no such kind, or it cannot be imported.
    """
    found = built_in_or_installed("driver.kind", kind, drivers(), DRIVER_GROUP)
    if isinstance(found, str):
        module, _, attribute = found.partition(":")
        found = getattr(importlib.import_module(module), attribute)
    return cast(DriverMaker, found)


def open_driver(kind: str, settings: DriverSettings) -> Driver:
    """Open the driver of a robot; in a guard process, if its hardware has no watchdog.

    Raises:
        PalmbotsError: there is no such kind, or its hardware cannot be used.
    """
    make = driver_maker(kind)
    if kind in drivers() or getattr(make, "has_watchdog", False):
        return limited(make(settings), settings)
    return limited(GuardedDriver(kind, settings), settings)

# SPDX-License-Identifier: Apache-2.0
"""The kinds of drivers, and opening one.

Other distributions add kinds under the entry point group ``palmbots.drivers``: a class, or a
function, that takes `DriverSettings` and returns a `Driver` (docs/guide/drivers.md).
"""

from palmbots._util.named_registry import Registry
from palmbots.drivers.driver import Driver, DriverMaker, DriverSettings
from palmbots.drivers.guard import GuardedDriver
from palmbots.drivers.own_driver import OwnDriver
from palmbots.drivers.speed_limit import limited
from palmbots.errors import PalmbotsError

DRIVERS: Registry[DriverMaker] = Registry(
    "driver.kind",
    {
        "simulated": "palmbots.drivers.simulated:open_simulated",
        "serial": "palmbots.drivers.serial_board:SerialDriver",
        "dry-run": "palmbots.drivers.dry_run:DryRunDriver",
    },
    "palmbots.drivers",
)
"""The hardware of the kinds of this package has a watchdog of its own."""


def check_arm(kind: str) -> None:
    """Refuse a kind of driver for a job on the floor.

    Raises:
        PalmbotsError: drivers of this kind move no arm.
    """
    if not getattr(DRIVERS.get(kind), "has_arm", False):
        raise PalmbotsError(
            f"driver.kind: {kind} moves no arm, which a job on the floor needs (task.from, task.to "
            "of the scene); allowed: simulated, or a driver with has_arm = True"
        )


def open_driver(kind: str, settings: DriverSettings) -> Driver:
    """Open the driver of a robot; in a guard process, if its hardware has no watchdog.

    Raises:
        PalmbotsError: there is no such kind, or its hardware cannot be used.
    """
    make = DRIVERS.get(kind)
    if settings.arm is not None:
        check_arm(kind)
    if kind in DRIVERS:
        return limited(make(settings), settings)
    if getattr(make, "has_watchdog", False):
        return limited(OwnDriver(kind, make, settings), settings)
    return limited(GuardedDriver(kind, settings), settings)

# SPDX-License-Identifier: Apache-2.0
"""The driver of a simulated robot. It talks to a world in another process.

The world is the motor board: it stops the wheels when no command has been written for the time of
the watchdog.
"""

import contextlib
import time
from typing import Any

from palmbots._types import Side
from palmbots.drivers.driver import Drive, DriverSettings, Reading
from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import ConnectionLost, connect

_WORLD_STARTS_WITHIN_S = 20.0
_PARTNER_STARTS_WITHIN_S = 40.0  # the world gives up earlier
_SILENCE_S = 1.0


class SimulatedDriver:
    """Talks to the process of a world (`palmbots.runtime.live_world`).

    Args:
        address: of the world.
        side: of the robot.
        epoch: number of the robot's boots.
        period_s: time between two readings.
        scene: `scene_number` of the robot's scene; 0: not compared.

    Raises:
        ConnectionLost: there is no world.
    """

    def __init__(
        self, address: str, side: Side, epoch: int, period_s: float = 0.01, scene: int = 0
    ) -> None:
        self._side = side
        self._silence_s = max(_SILENCE_S, 20 * period_s)
        self._heard_s = 0.0
        self._world = connect(address, "world", _WORLD_STARTS_WITHIN_S)
        self._world.send([side, epoch, scene])
        self._newest: Reading | None = None
        self._palm = 0

    def read(self) -> Reading | None:
        """The newest reading; None: the world has ended. Waits only for the first one.

        Raises:
            PalmbotsError: the world is lost, or gives no readings to this robot.
        """
        while (frame := self._world.poll()) is not None or self._newest is None:
            if frame is None:
                frame = self._world.receive(_PARTNER_STARTS_WITHIN_S)
            if frame == "end":
                return None
            self._newest = self._reading_in(frame)
            self._heard_s = time.monotonic()
        return self._newest

    @property
    def works(self) -> bool:
        """Readings still come."""
        return time.monotonic() - self._heard_s <= self._silence_s

    def _reading_in(self, frame: Any) -> Reading:
        if frame == "taken":
            raise PalmbotsError(f"world: another program is the {self._side} robot")
        if frame == "scene":
            raise PalmbotsError(f"world: runs another scene than the {self._side} robot")
        if not isinstance(frame, list) or len(frame) != 3:
            raise PalmbotsError("world: sends no readings; allowed: one without --lockstep")
        return Reading(*frame)

    def write(self, drive: Drive) -> None:
        """Command palm and wheels; if `drive.wheels` is false, the wheels stop."""
        self._palm = drive.palm
        self._offer(drive.move if drive.wheels else 0, drive.stop or not drive.wheels)

    def stop(self) -> None:
        """Stop the wheels; the palm keeps its angle."""
        self._offer(0, True)

    def _offer(self, move: int, stop: bool) -> None:
        with contextlib.suppress(ConnectionLost):  # `read` reports it, or the world's end
            self._world.offer([self._palm, move, stop])

    def close(self) -> None:
        """Close the connection; the world then stops the wheels."""
        self._world.close()


def open_simulated(settings: DriverSettings) -> SimulatedDriver:
    """The driver of a simulated robot, as a `DriverMaker`."""
    return SimulatedDriver(
        settings.address, settings.side, settings.epoch, settings.period_s, settings.scene
    )

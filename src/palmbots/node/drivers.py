# SPDX-License-Identifier: Apache-2.0
"""Drivers: how a robot's program reaches its sensors and motors.

The simulated driver talks to a world in another process. The world is the motor board: it stops the
wheels when no command has been written for the time of the watchdog.
"""

from dataclasses import dataclass

from palmbots._types import Side
from palmbots.errors import PalmbotsError
from palmbots.node.frames import ConnectionLost, connect

_WORLD_STARTS_WITHIN_S = 20.0


@dataclass(frozen=True)
class Sensed:
    """What a driver reads."""

    sign: int
    """Tactile sign of the contact coordinate p; p > 0 is outward."""
    palm_at_target: bool
    """The palm has reached the angle last commanded."""
    distance_m: float
    """Distance covered so far, by odometry; its value at the start of a carry may exceed 0."""


class SimulatedDriver:
    """Talks to the process of a world (`palmbots.node.live_world`).

    Args:
        address: of the world.
        side: of the robot.
        epoch: number of the robot's boots.

    Raises:
        ConnectionLost: there is no world.
    """

    def __init__(self, address: str, side: Side, epoch: int) -> None:
        self._world = connect(address, "world", _WORLD_STARTS_WITHIN_S)
        self._world.send([side, epoch])
        self._side = side
        self._newest: Sensed | None = None

    def read(self) -> Sensed | None:
        """The newest reading; None: the world has ended."""
        try:
            while (frame := self._world.poll()) is not None or self._newest is None:
                if frame is None:
                    frame = self._world.receive(_WORLD_STARTS_WITHIN_S)
                if frame == "end":
                    return None
                if frame == "taken":
                    raise PalmbotsError(f"{self._side} robot: another program has this side")
                self._newest = Sensed(*frame)
        except ConnectionLost:
            return None
        return self._newest

    def write(self, palm: int, move: int, stop: bool, wheels: bool) -> None:
        """Command palm and wheels; if `wheels` is false, the wheels stop."""
        try:
            self._world.send([palm, move if wheels else 0, stop or not wheels])
        except ConnectionLost:
            self._newest = None

    def close(self) -> None:
        """Close the connection."""
        self._world.close()

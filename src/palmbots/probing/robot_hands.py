# SPDX-License-Identifier: Apache-2.0
"""Two robots that probe, commanded as motors: in this program, or as processes of their own."""

from __future__ import annotations

import contextlib
import shlex
import time
from collections.abc import Callable, Iterator

from palmbots._types import SIDES, Side
from palmbots.drivers.driver import RawCommand, RawReading
from palmbots.drivers.hardware import (
    HardwareParameters,
    forward_distance,
    motor_command,
    palm_angle,
    servo_angle,
    wheel_rates,
)
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.errors import PalmbotsError
from palmbots.links.greeting import scene_number
from palmbots.links.local_connection import connect
from palmbots.pair.pair_file import Pair as RobotPair
from palmbots.pair.pair_file import probe_address
from palmbots.probing.contact_tracking import Pair
from palmbots.probing.probe_run import Switches
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene

_STARTS_WITHIN_S = 10.0
_STILL_S = 0.3
"""A wheel needs the command against stiction for this time; assumed."""

Commands = tuple[RawCommand, RawCommand]
Readings = tuple[RawReading, RawReading]


class RobotHands:
    """A pair of robots.

    Args:
        hardware: of the left and of the right robot.
        period_s: the control period.
        exchange: gives both robots their commands for one control period, and returns what they
            read after it; None: the world of simulated robots has ended.
        first: what they read before.
        lockstep: a step takes one control period; otherwise time passes by itself.
    """

    def __init__(
        self,
        hardware: tuple[HardwareParameters, HardwareParameters],
        period_s: float,
        exchange: Callable[[Commands], Readings | None],
        first: Readings,
        *,
        lockstep: bool = True,
    ) -> None:
        self.period_s = period_s
        self.end = ""
        """Why the object is no longer held; empty if it is."""
        self.is_in_lockstep = lockstep
        self.time_s = 0.0
        """Since the start."""
        self._start_s = time.monotonic()
        self._hardware, self._exchange, self._seen = hardware, exchange, first
        self._driven_s = 0.0
        self._commanded: Pair | None = None

    def switches(self) -> Switches:
        """Which switches of each palm are closed."""
        left, right = self._seen
        return left.closed, right.closed

    def step(self, changes: Pair, angles: Pair) -> None:
        """One control period: each robot changes the separation [m] and turns its palm."""
        self._driven_s = self._driven_s + self.period_s if any(changes) else 0.0
        self._commanded = angles
        left, right = (
            self._command(one, -change / self.period_s, angle)
            for one, change, angle in zip(self._hardware, changes, angles, strict=True)
        )
        seen = self._exchange((left, right))
        if seen is None:
            self.end = "the world has ended"
        else:
            self._seen = seen
        if self.is_in_lockstep:
            self.time_s += self.period_s
        else:
            self.time_s = time.monotonic() - self._start_s

    def _command(self, hardware: HardwareParameters, forward: float, angle: float) -> RawCommand:
        turns = self._driven_s > _STILL_S
        left, right = (
            motor_command(hardware, rate, turns=turns) for rate in wheel_rates(hardware, forward)
        )
        return RawCommand((left, right), servo_angle(hardware, angle))

    def read(self) -> tuple[Pair, Pair]:
        """What the encoders show: by how much each robot has changed the separation [m], from any
        start, and the palm angles [rad].

        A servo that does not report its angle counts as where it was commanded to be.
        """
        changes, angles = [0.0, 0.0], [0.0, 0.0]
        for i, (hardware, seen) in enumerate(zip(self._hardware, self._seen, strict=True)):
            assert seen.wheel_counts is not None
            changes[i] = -forward_distance(hardware, seen.wheel_counts)
            if seen.servo_rad is not None:
                angles[i] = palm_angle(hardware, seen.servo_rad)
            elif self._commanded is not None:
                angles[i] = self._commanded[i]
        return (changes[0], changes[1]), (angles[0], angles[1])


@contextlib.contextmanager
def hands_of_pair(pair: RobotPair, scene: Scene) -> Iterator[RobotHands]:
    """Connect to the programs of both robots (`palmbots robot --probe`).

    If one of them is lost, the wheels of the other one stop and its palm keeps its angle.

    Raises:
        PalmbotsError: a program does not run, has another scene, is lost, or its robot has no
            encoders.
    """
    with contextlib.ExitStack() as stack:
        ports: dict[Side, SimulatedDriver] = {}
        hardware = [pair.settings.hardware.of(side) for side in SIDES]
        for side in SIDES:
            try:
                line = connect(probe_address(pair, side), f"{side} robot", _STARTS_WITHIN_S)
            except PalmbotsError as error:
                start = command_text("robot", shlex.quote(str(pair.file)), side=side, probe=True)
                raise PalmbotsError(f"{error}; start {start}") from None
            port = SimulatedDriver(
                line, side, 0, scene.control.period_s, scene_number(scene), hardware=hardware[0]
            )
            ports[side] = stack.enter_context(contextlib.closing(port))

        def exchange(commands: Commands | None) -> Readings | None:
            if commands is not None:
                for side, command in zip(SIDES, commands, strict=True):
                    # What has arrived while the next probe was computed is older than the command.
                    if _read(ports, side, ports[side].read_raw) is None:
                        return None
                    ports[side].write_raw(command)
            seen = [_read(ports, side, ports[side].next_raw) for side in SIDES]
            left, right = seen
            return None if left is None or right is None else (left, right)

        first = exchange(None)
        if first is None:
            raise PalmbotsError("probe: the world has ended")
        lockstep = all(port.is_in_lockstep for port in ports.values())
        for side, one in zip(SIDES, first, strict=True):
            if one.wheel_counts is None:
                raise PalmbotsError(f"probe: the {side} robot has no encoders, which probes need")
        period_s = scene.control.period_s
        yield RobotHands((hardware[0], hardware[1]), period_s, exchange, first, lockstep=lockstep)


def _read(
    ports: dict[Side, SimulatedDriver], side: Side, read: Callable[[], RawReading | None]
) -> RawReading | None:
    """What a robot reads; None: the world has ended. If the robot is lost, the other one stops."""
    try:
        return read()
    except PalmbotsError as error:
        for other, port in ports.items():
            if other != side:
                port.stop()
        raise PalmbotsError(
            f"probe: the {side} robot is lost ({error}); the wheels of the other one stop, and its "
            "palm keeps its angle"
        ) from None

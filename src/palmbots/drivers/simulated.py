# SPDX-License-Identifier: Apache-2.0
"""The driver of a simulated robot. It talks to a world in another process.

The world is the motor board: it stops the wheels when no command has been written for the time of
the watchdog.
"""

import contextlib
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from palmbots._types import Side
from palmbots._util import process_clock
from palmbots.drivers.arm import FOLLOWS, HOLDS
from palmbots.drivers.driver import Drive, DriverSettings, RawCommand, RawReading, Reading
from palmbots.drivers.hardware import HardwareParameters
from palmbots.drivers.hardware_io import HardwareIo
from palmbots.errors import PalmbotsError
from palmbots.links.greeting import check_admitted
from palmbots.links.local_connection import Connection, ConnectionLost, connect
from palmbots.links.reading_frame import ReadingFrame

_WORLD_STARTS_WITHIN_S = 20.0
_PARTNER_STARTS_WITHIN_S = 40.0  # the world gives up earlier
_SILENCE_S = 1.0


class SimulatedDriver:
    """Talks to the process of a world (`palmbots.simulation.live_world`).

    Args:
        address: of the world, or a connection to it.
        side: of the robot.
        epoch: number of the robot's boots.
        period_s: time between two readings.
        scene: `scene_number` of the robot's scene; 0: not compared.
        hardware: what the robot's program takes its hardware for. Only robots with imperfections
            have any; the others obey the words of a controller.
        leads: the robot travels away from its partner.
        within_s: how long to wait for a world that is still starting.
        time: a clock that only goes forward [s].

    Raises:
        ConnectionLost: there is no world.
    """

    def __init__(
        self,
        address: Any,
        side: Side,
        epoch: int,
        period_s: float = 0.01,
        scene: int = 0,
        *,
        hardware: HardwareParameters | None = None,
        leads: bool = False,
        within_s: float = _WORLD_STARTS_WITHIN_S,
        time: Callable[[], float] = process_clock.monotonic,
    ) -> None:
        self._side = side
        self._silence_s = max(_SILENCE_S, 20 * period_s)
        self._heard_s = 0.0
        self._time = time
        if isinstance(address, str):
            address = connect(address, "world", within_s, "driver.address")
        self._world: Connection = address
        self._world.send([side, epoch, scene])
        self._newest: Reading | RawReading | None = None
        self._palm = 0
        self._arm: int | None = None
        self._in_force: tuple[int, int | None] = (0, None)  # palm and arm, at the newest reading
        self._phase = 0
        self._has_arm = False
        self._servo_rad: float | None = None
        self._arm_rad: float | None = None
        self._rate = 1.0  # multiple of real time at which the world runs; infinite in lockstep
        self._io = HardwareIo(hardware or HardwareParameters(), leads=leads)
        self.clock_rate = 1.0
        """How fast the clock of the robot's program runs. A simulated robot has one that is wrong;
        a real one cannot know."""

    def read(self) -> Reading | None:
        """The newest reading; None: the world has ended. Waits only for the first one.

        Raises:
            PalmbotsError: the world is lost, or gives no readings to this robot.
        """
        reading = self._read()
        if isinstance(reading, RawReading):
            return self._io.reading(reading, self._now_s())
        if reading is None:
            return None
        palm, arm = self._in_force  # the world may not yet have had the newest command
        return replace(
            reading,
            palm_at_target=reading.palm_at_target and palm == self._palm,
            arm_there=reading.arm_there and arm == self._arm,
        )

    def read_raw(self) -> RawReading | None:
        """The newest reading of the hardware itself; as `read`.

        Raises:
            PalmbotsError: as for `read`, or the robots of this world have no hardware.
        """
        reading = self._read()
        if isinstance(reading, Reading):
            raise PalmbotsError(
                "world: its robots obey controllers and have no hardware; allowed: "
                "palmbots world --bench, or --imperfect"
            )
        return reading

    def next_raw(self) -> RawReading | None:
        """The next reading of the hardware, in lockstep: waits for one that was not read yet.

        Raises:
            PalmbotsError: as for `read_raw`.
        """
        self._newest = None
        return self.read_raw()

    @property
    def is_in_lockstep(self) -> bool:
        """Whether the world waits for this program, as it has stated with its first reading."""
        return math.isinf(self._rate)

    def _now_s(self) -> float:
        return self._time() * self._rate

    def _read(self) -> Reading | RawReading | None:
        while (frame := self._world.poll()) is not None or self._newest is None:
            if frame is None:
                frame = self._world.receive(_PARTNER_STARTS_WITHIN_S)
            if frame == "end":
                return None
            if isinstance(frame, list) and len(frame) == 3 and frame[0] == "clock":
                self.clock_rate, self._rate = float(frame[1]), float(frame[2])
                continue
            self._newest = self._reading_in(frame)
            self._heard_s = self._time()
        return self._newest

    @property
    def works(self) -> bool:
        """Readings still come."""
        return self._time() - self._heard_s <= self._silence_s

    def _reading_in(self, frame: Any) -> Reading | RawReading:
        check_admitted(frame, self._side)
        if isinstance(frame, list) and len(frame) == 5 and frame[0] == "raw":
            _, counts, closed, servo_rad, battery_v = frame
            return RawReading(
                None if counts is None else (counts[0], counts[1]),
                tuple(closed),
                servo_rad,
                battery_v,
            )
        if not isinstance(frame, list | tuple) or len(frame) != len(ReadingFrame._fields):
            raise PalmbotsError("world: sends no readings; allowed: one without --lockstep")
        seen = ReadingFrame(*frame)
        self._in_force = seen.palm, seen.arm
        self._has_arm = seen.arm is not None
        return Reading(
            seen.sign, seen.palm_at_target, seen.distance_m, has_contact=seen.has_contact,
            arm_there=seen.arm_there, arm_steps=seen.arm_steps, beneath=seen.beneath,
        )  # fmt: skip

    def write(self, drive: Drive) -> None:
        """Command palm and wheels; if `drive.wheels` is false, the wheels stop."""
        if isinstance(self._newest, RawReading):
            self.write_raw(self._io.command(drive, self._now_s()))
            return
        self._palm, self._arm, self._phase = drive.palm, drive.arm, drive.phase
        stops = drive.stop or not drive.wheels
        self._obey(drive.move if drive.wheels else 0, stops)

    def write_raw(self, command: RawCommand) -> None:
        """Command the motors themselves."""
        if command.servo_rad is not None:
            self._servo_rad = command.servo_rad
        if command.arm_rad is not None:
            self._arm_rad = command.arm_rad
        self._offer(["raw", *command.wheels_rad_s, self._servo_rad, self._arm_rad])

    def stop(self) -> None:
        """Stop the wheels; the palm keeps its angle."""
        if isinstance(self._newest, RawReading):
            self.write_raw(RawCommand((0.0, 0.0)))
        else:
            self._arm = FOLLOWS if self._arm == FOLLOWS else HOLDS
            self._obey(0, True)

    def _obey(self, move: int, stops: bool) -> None:
        of_arm = [self._arm, self._phase] if self._has_arm else []
        self._offer([self._palm, move, stops, *of_arm])

    def _offer(self, frame: list[Any]) -> None:
        with contextlib.suppress(ConnectionLost):  # `read` reports it, or the world's end
            self._world.offer(frame)

    def close(self) -> None:
        """Close the connection; the world then stops the wheels."""
        self._world.close()


def open_simulated(settings: DriverSettings) -> SimulatedDriver:
    """The driver of a simulated robot, as a `DriverMaker`."""
    return SimulatedDriver(
        settings.address, settings.side, settings.epoch, settings.period_s, settings.scene,
        hardware=settings.hardware, leads=settings.leads, within_s=settings.within_s,
    )  # fmt: skip


open_simulated.has_arm = True  # ty: ignore[missing-attribute]  # of a DriverMaker

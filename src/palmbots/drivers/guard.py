# SPDX-License-Identifier: Apache-2.0
"""A driver in a guard process, which stops the wheels when the robot's program is silent.

A program that is stopped or killed cannot stop its wheels. Where the hardware does not do that
either, the driver runs in a small process (`palmbots.drivers.guard_process`), and the robot's
program talks to it. The guard stops the wheels when no command has come for the time of the
watchdog, or when the program has ended.

If the guard or its driver fails, the robot's driver counts as lost, and a new guard is started.
"""

import contextlib
import math
import pickle
import socket
import subprocess
import sys
import time
from dataclasses import asdict, replace
from typing import Any

from palmbots.drivers.arm import StoredArm
from palmbots.drivers.driver import (
    Drive,
    DriverFailed,
    DriverSettings,
    RawCommand,
    RawReading,
    Reading,
    targets,
)
from palmbots.errors import PalmbotsError
from palmbots.links.link import to_stderr
from palmbots.links.local_connection import Connection, ConnectionLost

_GUARD = "palmbots.drivers.guard_process"
_STARTS_WITHIN_S = 20.0
_ENDS_WITHIN_S = 2.0
_SILENCE_S = 0.5
_RETRY_S = 1.0


class GuardedDriver:
    """The end of the robot's program.

    Args:
        kind: of the driver that the guard opens.
        settings: of that driver.

    Raises:
        PalmbotsError: the guard does not start, or its hardware cannot be used.
    """

    def __init__(self, kind: str, settings: DriverSettings) -> None:
        self._kind, self._settings = kind, settings
        self._silence_s = max(_SILENCE_S, 20 * settings.period_s)
        self._newest: tuple[Reading, RawReading | None] | None = None
        self._has_ended = self._works = False
        self._wanted: list[float] | None = None  # `targets` of the newest command
        self._obeyed: list[float] | None = None  # the same of the one that a reading refers to
        self.loss = ""
        """Why the driver was lost last; empty: it was not."""
        self.call_s = (0.0, 0.0)
        """How long the driver last took for a read and for a write [s]."""
        self._heard_s = 0.0
        self._lost_s: float | None = None
        self._start()
        while self._newest is None and not self._has_ended:
            try:
                self._take(self._guard.receive(_STARTS_WITHIN_S))
            except PalmbotsError:
                self._end()
                raise

    def _start(self) -> None:
        near, far = socket.socketpair()
        command = [sys.executable, "-P", "-m", _GUARD, str(far.fileno())]
        with far:
            # In a session of its own, it outlives a Ctrl-C and stops the wheels.
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=sys.stderr.fileno() if _has_descriptor(sys.stderr) else None,
                pass_fds=[far.fileno()],
                start_new_session=True,
            )
        self._guard = Connection(near, "driver")
        assert self._process.stdin is not None
        with contextlib.suppress(OSError), self._process.stdin as stream:
            plain = replace(self._settings, on_line=to_stderr)
            if self._newest is not None:  # the arm is where it was
                plain = replace(plain, stored_arm=self._newest[0].stored_arm)
            stream.write(pickle.dumps((self._kind, plain)))

    def read(self) -> Reading | None:
        """The newest reading; None: the hardware has ended the carry."""
        self._poll()
        if self._has_ended or self._newest is None:
            return None
        reading = self._newest[0]
        if self._obeyed != self._wanted:  # the driver had not yet received the newest command
            return replace(reading, palm_at_target=False, arm_there=False)
        return reading

    @property
    def has_raw(self) -> bool:
        """The driver gives access to its hardware as it is."""
        return self._newest is not None and self._newest[1] is not None

    def read_raw(self) -> RawReading | None:
        """The newest reading as it is; only with `has_raw`."""
        self._poll()
        return None if self._has_ended or self._newest is None else self._newest[1]

    @property
    def works(self) -> bool:
        """The guard and its driver still answer."""
        return self._works and time.monotonic() - self._heard_s <= self._silence_s

    def write(self, drive: Drive) -> None:
        """Command palm and wheels."""
        self._wanted = targets(drive)
        self._offer(["drive", time.monotonic(), [*asdict(drive).values()]])

    def write_raw(self, command: RawCommand) -> None:
        """Command the motors."""
        shape = [list(command.wheels_rad_s), command.servo_rad, command.arm_rad]
        self._offer(["raw", time.monotonic(), shape])

    def stop(self) -> None:
        """Stop the wheels."""
        self._offer(["stop", time.monotonic(), None])

    def close(self) -> None:
        """Stop the wheels, and end the guard."""
        self._end()

    def _poll(self) -> None:
        if self._lost_s is not None and not self._starts_again():
            return
        try:
            while (frame := self._guard.poll()) is not None:
                self._take(frame)
        except DriverFailed as error:
            self._lose(error.why)
        except PalmbotsError as error:
            self._lose(str(error))

    def _take(self, frame: Any) -> None:
        """Take in a frame of the guard.

        Raises:
            PalmbotsError: the driver has failed, or cannot be opened.
        """
        if frame == "end":
            self._has_ended = True
            return
        name, content = frame
        if name == "failed":
            raise DriverFailed(self._kind, content)
        if name == "refused":
            raise PalmbotsError(content)
        shape, raw, works, (read_s, write_s), self._obeyed = content
        self.call_s = (read_s, write_s)
        distance_m = math.nan if shape["distance_m"] is None else shape["distance_m"]
        stored_arm = StoredArm(*shape["stored_arm"])
        reading = Reading(**shape | {"distance_m": distance_m, "stored_arm": stored_arm})
        if self._newest is not None and not self._works and works:
            self._settings.on_line(f"driver.kind: {self._kind} is back")
        self._newest, self._works = (reading, _raw_in(raw)), works
        self._heard_s = time.monotonic()

    def _offer(self, frame: Any) -> None:
        with contextlib.suppress(ConnectionLost):  # `read` notices it
            self._guard.offer(frame)

    def _lose(self, why: str) -> None:
        if self._works:
            self._settings.on_line(f"driver.kind: {self._kind} is lost: {why}")
        self._works, self.loss = False, why
        self._lost_s = time.monotonic()
        self._guard.close()  # a guard that still runs stops the wheels, and ends

    def _starts_again(self) -> bool:
        """Start a new guard once the old one has ended; never waits."""
        assert self._lost_s is not None
        lost_for_s = time.monotonic() - self._lost_s
        if self._process.poll() is None:
            if lost_for_s > 2 * _ENDS_WITHIN_S:
                self._process.kill()
            elif lost_for_s > _ENDS_WITHIN_S:
                self._process.terminate()
            return False
        if lost_for_s < _RETRY_S:
            return False
        self._start()
        self._lost_s = None
        return True

    def _end(self) -> None:
        """End the guard, which stops the wheels when the connection closes."""
        self._guard.close()
        for end in (None, self._process.terminate, self._process.kill):
            if end is not None:
                end()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(_ENDS_WITHIN_S)
                return


def _raw_in(shape: Any) -> RawReading | None:
    if shape is None:
        return None
    counts, closed, servo_rad, battery_v = shape
    counts = None if counts is None else tuple(counts)
    return RawReading(counts, tuple(closed), servo_rad, battery_v)


def _has_descriptor(stream: Any) -> bool:
    try:
        return stream.fileno() >= 0
    except (AttributeError, OSError, ValueError):
        return False

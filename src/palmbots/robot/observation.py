# SPDX-License-Identifier: Apache-2.0
"""What a robot's program does, tick by tick, for programs beside it that only watch.

The robot's program sends each observation as a datagram to a socket in the file system, beside its
stored state. A watching program (`Observations`) owns the socket. The robot's program never waits:
without a watching program, or with one that does not keep up, observations are dropped. Nothing
that a watching program does reaches the robot.
"""

import contextlib
import json
import os
import socket
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, get_args

from palmbots.errors import PalmbotsError
from palmbots.pair.stored_state import StateFile
from palmbots.wire import FaultCode, RobotMode

_LARGEST = 65536  # bytes
_LOOK_EVERY = 50  # ticks: how often the robot's program looks for a watching one


@dataclass(frozen=True)
class Observation:
    """One tick of a robot's program."""

    time_s: float
    """When, on the monotonic clock of the computer."""
    mode: RobotMode
    """Mode of the robot."""
    fault: FaultCode
    """Its fault code."""
    sign: int
    """Tactile sign of p, -1, 0 or 1; 1 is outward."""
    has_contact: bool
    """Something lies on the palm."""
    palm_at_target: bool
    """The palm has reached the commanded angle."""
    palm_rad: float
    """Commanded angle of the palm over the horizontal; the palm faces the partner."""
    speed_m_s: float
    """Commanded speed in the direction of travel."""
    distance_m: float | None
    """Distance covered by odometry; None: the robot has no encoders."""
    battery_v: float | None
    """Voltage of the battery; None: not measured."""
    overruns: int
    """Ticks missed among the last 100."""
    received: Mapping[str, int]
    """Packets received so far, by verdict."""


class Observer:
    """The end of the robot's program.

    Args:
        place: the socket, `observation_socket`.
    """

    def __init__(self, place: Path) -> None:
        self._place = place
        self._ticks = 0
        self._socket: socket.socket | None = None

    @property
    def is_watched(self) -> bool:
        """A program watches. If not, looks for one from time to time, so call it in every tick."""
        if self._socket is None and self._ticks % _LOOK_EVERY == 0:
            stream = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            stream.setblocking(False)
            try:
                with _short(self._place) as name:
                    stream.connect(name)
            except OSError:
                stream.close()
            else:
                self._socket = stream
        self._ticks += 1
        return self._socket is not None

    def send(self, observation: Observation) -> None:
        """Send an observation; never waits."""
        if self._socket is None:
            return
        try:
            self._socket.send(json.dumps(asdict(observation)).encode())
        except BlockingIOError:
            pass
        except OSError:  # the watching program has gone
            self.close()

    def close(self) -> None:
        """Close the socket."""
        if self._socket is not None:
            self._socket.close()
        self._socket = None


class Observations:
    """The end of the watching program.

    Args:
        place: the socket, `observation_socket`.

    Raises:
        PalmbotsError: another program watches this robot, or the socket cannot be used.
    """

    def __init__(self, place: Path) -> None:
        self._place = place
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            with _short(place) as name:
                if _is_owned(name):
                    raise PalmbotsError(f"{place}: another program watches this robot already")
                with contextlib.suppress(FileNotFoundError):
                    os.unlink(name)
                self._socket.bind(name)
        except OSError as error:
            self._socket.close()
            raise PalmbotsError(f"{place}: cannot be used: {error.strerror or error}") from None
        except PalmbotsError:
            self._socket.close()
            raise

    def receive(self, timeout_s: float) -> list[Observation]:
        """Wait for an observation, at most so long; returns all that have arrived, in order."""
        arrived = []
        self._socket.settimeout(timeout_s)
        with contextlib.suppress(TimeoutError, BlockingIOError):
            while True:
                seen = _observation_in(self._socket.recv(_LARGEST))
                self._socket.settimeout(0)
                if seen is not None:
                    arrived.append(seen)
        return arrived

    def close(self) -> None:
        """Close the socket, and remove it."""
        self._socket.close()
        with contextlib.suppress(OSError):
            os.unlink(self._place)


def observation_socket(file: StateFile) -> Path:
    """The socket of the robot with this file of stored state."""
    return file.path.with_suffix(".watch")


@contextlib.contextmanager
def _short(place: Path) -> Iterator[str]:
    """A name of a socket that is short enough for the kernel (107 bytes), whatever its folder."""
    folder = os.open(place.parent, os.O_PATH | os.O_DIRECTORY)
    try:
        yield f"/proc/self/fd/{folder}/{place.name}"
    finally:
        os.close(folder)


def _is_owned(name: str) -> bool:
    """Whether a program receives on the socket; one that was killed leaves its socket behind."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as caller:
        try:
            caller.connect(name)
        except (ConnectionRefusedError, FileNotFoundError):
            return False
    return True


def _observation_in(data: bytes) -> Observation | None:
    """The observation in a datagram; None: it is of another version, or none."""
    try:
        table: Any = json.loads(data)
    except (ValueError, RecursionError):
        return None
    if not isinstance(table, dict) or set(table) != {field.name for field in fields(Observation)}:
        return None
    is_known = table["mode"] in get_args(RobotMode) and table["fault"] in get_args(FaultCode)
    return Observation(**table) if is_known else None

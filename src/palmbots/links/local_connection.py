# SPDX-License-Identifier: Apache-2.0
"""Connections between the processes of one machine: one JSON list or object per line.

An address is ``HOST:PORT``, or ``unix:PATH`` for a socket in the file system.
"""

import contextlib
import errno
import json
import os
import socket
import stat
import time
from collections.abc import Iterator
from typing import Any, Self

from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError

_LONGEST_FRAME = 1_000_000  # bytes
_RETRY_S = 0.02
_LONGEST_PATH = 107  # bytes
_ALLOWED = "HOST:PORT, such as 127.0.0.1:7400, or unix:PATH"

# What the system's own words leave unclear.
_WHY_NOT = {
    errno.EADDRNOTAVAIL: "this computer does not have this address",
    errno.ENOENT: "the folder does not exist",
    errno.EADDRINUSE: "it is taken; end the program that listens there, or choose another address",
}


def why_not(error: OSError) -> str:
    """Why an address cannot be used, and what to do."""
    return _WHY_NOT.get(error.errno or 0, error.strerror or str(error))


_encode = json.JSONEncoder(separators=(",", ":")).encode
_decode = json.JSONDecoder().decode


def _line(frame: Any) -> bytes:
    return _encode(frame).encode() + b"\n"


class ConnectionLost(PalmbotsError):
    """The other process has closed the connection, or does not answer in time."""


class Connection:
    """One end of a connection. `name` is that of the other end, for messages."""

    def __init__(self, stream: socket.socket, name: str) -> None:
        self._stream = stream
        self._received = b""
        self._unsent = b""
        self.name = name
        if stream.family == socket.AF_INET:
            stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def send(self, frame: Any) -> None:
        """Send one frame.

        Raises:
            ConnectionLost: the connection is closed.
        """
        try:
            self._wait_at_most(None)
            self._stream.sendall(_line(frame))
        except OSError as error:
            raise ConnectionLost(f"{self.name}: {error.strerror or error}") from None

    def offer(self, frame: Any) -> bool:
        """Send one frame without waiting. An end that does not read misses it.

        Returns:
            Whether the end gets the frame.

        Raises:
            ConnectionLost: the connection is closed.
        """
        try:
            self._wait_at_most(0)
            if self._unsent:  # the rest of an earlier frame
                self._unsent = self._unsent[self._stream.send(self._unsent) :]
            if not self._unsent:
                data = _line(frame)
                self._unsent = data[self._stream.send(data) :]
                return True
        except BlockingIOError:
            return False
        except OSError as error:
            raise ConnectionLost(f"{self.name}: {error.strerror or error}") from None
        return False

    def receive(self, timeout_s: float | None = None) -> Any:
        """Wait for one frame.

        Raises:
            ConnectionLost: the connection is closed, no frame arrives in time, or what arrives is
                not a frame.
        """
        self._wait_at_most(timeout_s)
        while b"\n" not in self._received:
            try:
                more = self._stream.recv(65536)
            except TimeoutError:
                raise ConnectionLost(f"{self.name}: no answer within {timeout_s:g} s") from None
            except OSError as error:
                raise ConnectionLost(f"{self.name}: {error.strerror or error}") from None
            if not more:
                raise ConnectionLost(f"{self.name}: has closed the connection")
            self._received += more
            if len(self._received) > _LONGEST_FRAME:
                raise ConnectionLost(f"{self.name}: sends frames that are too long")
        line, self._received = self._received.split(b"\n", 1)
        try:
            return _decode(line.decode())
        except (ValueError, RecursionError):
            raise ConnectionLost(f"{self.name}: sends no frames") from None

    def poll(self) -> Any:
        """The next frame, if there is one; else None. Never waits.

        Raises:
            ConnectionLost: as for `receive`.
        """
        if b"\n" not in self._received:
            self._wait_at_most(0)
            try:
                more = self._stream.recv(65536)
            except BlockingIOError:
                return None
            except OSError as error:
                raise ConnectionLost(f"{self.name}: {error.strerror or error}") from None
            if not more:
                raise ConnectionLost(f"{self.name}: has closed the connection")
            self._received += more
            if b"\n" not in self._received:
                if len(self._received) > _LONGEST_FRAME:
                    raise ConnectionLost(f"{self.name}: sends frames that are too long")
                return None
        return self.receive()

    def drain(self, within_s: float) -> None:
        """Send the rest of a frame that was offered, waiting at most this long.

        Raises:
            ConnectionLost: the connection is closed, or the other end does not read.
        """
        try:
            self._wait_at_most(max(within_s, 0.001))
            self._stream.sendall(self._unsent)
            self._unsent = b""
        except OSError as error:
            raise ConnectionLost(f"{self.name}: {error.strerror or error}") from None

    def _wait_at_most(self, timeout_s: float | None) -> None:
        if self._stream.gettimeout() != timeout_s:  # to set it is a call of the system
            self._stream.settimeout(timeout_s)

    def fileno(self) -> int:
        """Number of the socket, to wait for more than one."""
        return self._stream.fileno()

    def close(self) -> None:
        """Close the connection."""
        with contextlib.suppress(OSError):
            self._stream.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@contextlib.contextmanager
def _usable(place: Any) -> Iterator[Any]:
    """The place as the system takes it: paths of sockets are limited to 107 bytes."""
    if not isinstance(place, str) or len(os.fsencode(place)) <= _LONGEST_PATH:
        yield place
        return
    folder, name = os.path.split(place)
    number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        yield f"/proc/self/fd/{number}/{name}"
    finally:
        os.close(number)


def _parsed(address: str, called: str) -> tuple[socket.AddressFamily, Any]:
    kind, _, rest = address.partition(":")
    if kind == "unix" and rest and "\0" not in rest:
        return socket.AF_UNIX, os.path.expanduser(rest)
    host, _, port = address.rpartition(":")
    is_port = port.isascii() and port.isdecimal() and len(port) <= 5 and int(port) <= 65535
    try:
        host.encode("idna")
    except UnicodeError:
        host = ""
    if not host or "\0" in host or not is_port:
        raise PalmbotsError(f"{called}: value is {show(address)}; allowed: {_ALLOWED}")
    return socket.AF_INET, (host, int(port))


class _Door(socket.socket):
    """A listening socket. One in the file system takes its file with it when it closes."""

    path = ""

    def close(self) -> None:
        """Close the socket."""
        if self.fileno() != -1 and self.path:
            with contextlib.suppress(OSError):
                os.unlink(self.path)
        super().close()


def _is_left_behind(path: str) -> bool:
    """Whether this is a socket on which nobody listens: its program was killed."""
    try:
        if not stat.S_ISSOCK(os.stat(path).st_mode):
            return False
        with socket.socket(socket.AF_UNIX) as caller, _usable(path) as place:
            caller.settimeout(1.0)
            caller.connect(place)
    except ConnectionRefusedError:
        return True
    except OSError:
        return False
    return False


def listen(address: str, called: str = "address") -> socket.socket:
    """A socket that accepts connections. `called` is the option or key that gave the address.

    Raises:
        PalmbotsError: the address is not valid, or cannot be used.
    """
    family, place = _parsed(address, called)
    stream = _Door(family)
    try:
        if family == socket.AF_INET:
            stream.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        with _usable(place) as usable:
            try:
                stream.bind(usable)
            except OSError as error:
                if family != socket.AF_UNIX or error.errno != errno.EADDRINUSE:
                    raise
                if not _is_left_behind(place):
                    raise
                os.unlink(place)
                stream.bind(usable)
        stream.path = place if family == socket.AF_UNIX else ""
        stream.listen()
    except OSError as error:
        stream.close()
        raise PalmbotsError(f"{called}: cannot listen at {address}: {why_not(error)}") from None
    return stream


def connect(address: str, name: str, within_s: float, called: str = "address") -> Connection:
    """Connect to a process that may still be starting. `called` is the key that gave the address.

    Raises:
        PalmbotsError: the address is not valid.
        ConnectionLost: no process listens there within the time.
    """
    family, place = _parsed(address, called)
    give_up = time.monotonic() + within_s
    while True:
        stream = socket.socket(family)
        try:
            with _usable(place) as usable:
                stream.connect(usable)
            return Connection(stream, name)
        except socket.gaierror as error:  # waiting does not help
            stream.close()
            raise PalmbotsError(f"{name}: cannot find {address}: {error.strerror}") from None
        except OSError as error:
            stream.close()
            if time.monotonic() >= give_up:
                why = error.strerror or error
                raise ConnectionLost(f"{name}: nobody listens at {address}: {why}") from None
        time.sleep(_RETRY_S)

# SPDX-License-Identifier: Apache-2.0
"""A serial line with frames (docs/reference/wire.md), which never waits and survives unplugging.

pyserial opens the device and sets its speed. Reading and writing go to the file descriptor: what
the line cannot take at once is dropped, and a line that is unplugged is opened again when it is
back.
"""

import contextlib
import errno
import os
import select
import time
from collections.abc import Callable
from typing import Any

from palmbots._util.arguments import show
from palmbots._util.optional_imports import require
from palmbots.errors import PalmbotsError
from palmbots.wire.serial_frames import FrameDecoder

_READ_SIZE = 4096  # bytes
_MOST_READS = 16  # a babbling device must not hold up the control loop
_LONGEST_QUEUE_S = 0.05
_BITS_PER_BYTE = 10  # with start and stop bit
_RETRY_S = 0.5


class SerialLine:
    """A device with frames.

    Args:
        key: what messages call the address, such as ``link.left``.
        device: such as ``/dev/ttyACM0``.
        baud: bits per second.
        on_line: called with a line when the device is lost, and when it is back.

    Raises:
        PalmbotsError: the device cannot be opened.
        MissingExtra: pyserial is not installed.
    """

    def __init__(self, key: str, device: str, baud: int, on_line: Callable[[str], None]) -> None:
        if not device.startswith("/") or "\0" in device:
            allowed = "the path of a serial device, such as /dev/ttyACM0"
            raise PalmbotsError(f"{key}: value is {show(device)}; allowed: {allowed}")
        self._serial = require("serial", "serial")
        self._key, self._device, self._baud, self._on_line = key, device, baud, on_line
        self._decoder = FrameDecoder()
        self._unsent = b""
        self._longest_queue = max(256, int(_LONGEST_QUEUE_S * baud / _BITS_PER_BYTE))
        self._next_try_s = 0.0
        self.dropped = 0
        """Frames that the line could not take."""
        self.times_opened = 1
        """How often the device has been opened."""
        try:
            self._port: Any | None = self._opened()
        except (OSError, ValueError) as error:
            raise PalmbotsError(f"{key}: cannot open {device}: {_reason(error)}") from None

    def _opened(self) -> Any:
        # A second program on the same device would get half of the bytes.
        port = self._serial.Serial(self._device, self._baud, timeout=0, exclusive=True)
        os.set_blocking(port.fileno(), False)
        return port

    @property
    def is_open(self) -> bool:
        """The device is there."""
        return self._port is not None

    @property
    def damaged(self) -> int:
        """Damaged frames that have arrived."""
        return self._decoder.damaged

    def receive(self) -> list[tuple[int, bytes]]:
        """The frames that have arrived: kind and content. Opens a lost device again."""
        frames: list[tuple[int, bytes]] = []
        if self._port is None and not self._has_come_back():
            return frames
        assert self._port is not None
        try:
            descriptor = self._port.fileno()
            poll = select.poll()
            poll.register(descriptor, select.POLLIN)
            for _ in range(_MOST_READS):
                ready = poll.poll(0)
                if not ready:
                    break
                data = os.read(descriptor, _READ_SIZE) if ready[0][1] & select.POLLIN else b""
                if not data:  # ready, but there is nothing: the device is gone
                    raise OSError("it has been unplugged")
                frames += self._decoder.take(data)
            self._write()
        except BlockingIOError:
            pass
        except OSError as error:
            self._lose(error)
        return frames

    def send(self, frame: bytes) -> bool:
        """Send a frame, or drop it if the line is busy or lost; whether it was sent."""
        if self._port is not None:
            try:
                self._write()
                if not self._unsent and self._port.out_waiting <= self._longest_queue:
                    self._unsent = frame
                    self._write()
                    return True
            except OSError as error:
                self._lose(error)
        self.dropped += 1
        return False

    def _write(self) -> None:
        """Write what is left of a frame."""
        with contextlib.suppress(BlockingIOError):
            while self._unsent and self._port is not None:
                written = os.write(self._port.fileno(), self._unsent)
                self._unsent = self._unsent[written:]

    def _lose(self, error: OSError) -> None:
        self._on_line(f"{self._key}: {self._device} is lost: {_reason(error)}")
        self.close()
        self._next_try_s = time.monotonic() + _RETRY_S

    def _has_come_back(self) -> bool:
        """Whether the lost device could be opened again."""
        if time.monotonic() < self._next_try_s:
            return False
        self._next_try_s = time.monotonic() + _RETRY_S
        try:
            self._port = self._opened()
        except (OSError, ValueError):
            return False
        self._decoder.take(b"\0")  # ends what was received before
        self.times_opened += 1
        self._on_line(f"{self._key}: {self._device} is back")
        return True

    def close(self) -> None:
        """Close the device; it may be gone already."""
        with contextlib.suppress(OSError):
            if self._port is not None:
                self._port.close()
        self._port, self._unsent = None, b""


def _reason(error: Exception) -> str:
    """Why a device cannot be used, without the numbers and repetitions of pyserial's messages."""
    if isinstance(error, OSError) and error.errno in (errno.EAGAIN, errno.EBUSY):
        return "another program uses it"
    if isinstance(error, OSError) and error.errno:
        return os.strerror(error.errno)
    return str(error)

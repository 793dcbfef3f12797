# SPDX-License-Identifier: Apache-2.0
"""Pseudo-terminals in place of serial lines, and a radio between bridges at their ends."""

import contextlib
import os
import pty
import select
import threading
import tty
from collections.abc import Iterator
from pathlib import Path

import serial_oracle


class Line:
    """A serial line: a device for the program under test, and the other end of the wire.

    The path of the device is a symbolic link, so that the line can be unplugged and come back.
    """

    def __init__(self, device: Path) -> None:
        self.device = device
        self.end = -1
        self._keeper = -1
        self.plug()

    def plug(self) -> None:
        """A device appears."""
        self.end, self._keeper = pty.openpty()
        tty.setraw(self._keeper)
        os.set_blocking(self.end, False)
        self.device.unlink(missing_ok=True)
        self.device.symlink_to(os.ttyname(self._keeper))

    def unplug(self) -> None:
        """The device disappears, as a USB plug that is pulled."""
        self.device.unlink(missing_ok=True)
        for descriptor in (self.end, self._keeper):
            os.close(descriptor)
        self.end = -1

    def write(self, data: bytes) -> None:
        os.write(self.end, data)

    def read(self) -> bytes:
        with contextlib.suppress(BlockingIOError):
            return os.read(self.end, 65536)
        return b""

    def close(self) -> None:
        if self.end >= 0:
            self.unplug()


@contextlib.contextmanager
def lines(*devices: Path) -> Iterator[list[Line]]:
    """Lines that are closed at the end."""
    made = [Line(device) for device in devices]
    try:
        yield made
    finally:
        for line in made:
            line.close()


def frames_in(data: bytes) -> list[tuple[int, bytes]]:
    """The frames in some bytes, by the independent implementation."""
    found = []
    for piece in data.split(b"\0"):
        plain, at = b"", 0
        while at < len(piece):
            plain += piece[at + 1 : at + piece[at]]
            at += piece[at]
            plain += b"\0" if at < len(piece) else b""
        if piece:
            assert serial_oracle.crc(plain[:-2]) == int.from_bytes(plain[-2:], "little")
            found.append((plain[0], plain[1:-2]))
    return found


class Bridges(threading.Thread):
    """Radio bridges without a radio: what one line sends arrives on all others."""

    def __init__(self, ends: list[Line]) -> None:
        super().__init__(daemon=True)
        self._ends = ends
        self._over = threading.Event()

    def run(self) -> None:
        while not self._over.is_set():
            by_descriptor = {line.end: line for line in self._ends if line.end >= 0}
            ready, _, _ = select.select([*by_descriptor], [], [], 0.01)
            for descriptor in ready:
                sender = by_descriptor[descriptor]
                with contextlib.suppress(OSError):
                    data = os.read(descriptor, 65536)
                    for line in self._ends:
                        if line is not sender and line.end >= 0:
                            with contextlib.suppress(BlockingIOError):
                                os.write(line.end, data)

    def __enter__(self) -> "Bridges":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self.join()

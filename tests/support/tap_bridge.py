# SPDX-License-Identifier: Apache-2.0
"""Two network namespaces with a bad radio between them: whatever uses the network goes through it.

The bridge is the impairment of `palmbots up --link`, applied to Ethernet frames. It needs root and
/dev/net/tun; a kernel module for bad networks (netem) is not needed. Requests for addresses (ARP)
are passed on unharmed: they belong to no radio.
"""

import contextlib
import fcntl
import os
import select
import struct
import subprocess
import sys
import threading
import time
from typing import Self

from palmbots.links.impairment import ImpairedPackets, Impairment

_SET_INTERFACE = 0x400454CA
_TAP, _WITHOUT_INFORMATION = 0x0002, 0x1000
_ARP = b"\x08\x06"
_LARGEST = 4096
_IDLE_S = 0.02
ADDRESSES = {"a": "10.77.0.1", "b": "10.77.0.2"}


def missing() -> str | None:
    """Why there can be no bridge here; None: there can."""
    if os.geteuid() != 0:
        return "needs root"
    if not os.path.exists("/dev/net/tun"):
        return "needs /dev/net/tun"
    made = subprocess.run(["ip", "netns", "add", "palmbots-try"], capture_output=True)
    if made.returncode != 0:
        return "needs network namespaces"
    subprocess.run(["ip", "netns", "del", "palmbots-try"], check=True)
    return None


class TapBridge:
    """Namespaces ``a`` and ``b`` with one network between them; a context manager."""

    def __init__(self, impairment: Impairment, seed: int = 0) -> None:
        self.packets = ImpairedPackets(impairment, seed)
        self._names = {end: f"palmbots-{os.getpid()}-{end}" for end in ADDRESSES}
        self._taps: dict[str, int] = {}
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._forward, daemon=True)

    def run(self, end: str, code: str, *arguments: str) -> "subprocess.Popen[str]":
        """Start a Python program in one of the namespaces."""
        inside = ["ip", "netns", "exec", self._names[end]]
        return subprocess.Popen(
            [*inside, sys.executable, "-c", code, *arguments], stdout=subprocess.PIPE, text=True
        )

    def __enter__(self) -> Self:
        with contextlib.ExitStack() as stack:
            stack.callback(self._remove)
            for end, address in ADDRESSES.items():
                self._add(end, address)
            self._thread.start()
            stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join()
        self._remove()

    def _add(self, end: str, address: str) -> None:
        name, device = self._names[end], f"pb{os.getpid() % 100000}{end}"
        tap = self._taps[end] = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
        flags = struct.pack("16sH", device.encode(), _TAP | _WITHOUT_INFORMATION)
        fcntl.ioctl(tap, _SET_INTERFACE, flags)
        for command in (
            ["netns", "add", name],
            ["link", "set", device, "netns", name],
            ["-n", name, "address", "add", f"{address}/24", "dev", device],
            ["-n", name, "link", "set", device, "up"],
            ["-n", name, "link", "set", "lo", "up"],
        ):
            subprocess.run(["ip", *command], check=True)

    def _remove(self) -> None:
        for end, name in self._names.items():
            if end in self._taps:
                os.close(self._taps.pop(end))
            subprocess.run(["ip", "netns", "del", name], capture_output=True)

    def _forward(self) -> None:
        other = {"a": "b", "b": "a"}
        ends = {tap: end for end, tap in self._taps.items()}
        while not self._ends.is_set():
            wait_s = self.packets.wait_s(time.monotonic(), _IDLE_S)
            for tap in select.select([*ends], [], [], wait_s)[0]:
                end = ends[tap]
                with contextlib.suppress(OSError):
                    frame = os.read(tap, _LARGEST)
                    if frame[12:14] == _ARP:
                        os.write(self._taps[other[end]], frame)
                    else:
                        self.packets.send(time.monotonic(), end, other[end], frame)
            for receiver, frame in self.packets.due(time.monotonic()):
                with contextlib.suppress(OSError):
                    os.write(self._taps[receiver], frame)

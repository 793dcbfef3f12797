# SPDX-License-Identifier: Apache-2.0
"""A robot on QEMU's machine mps2-an386, driven tick by tick like an emulated nRF52833.

The board in `firmware/board/mps2/board.cpp` exchanges everything with the world through its UART:
packets, the switches of a tick, pulses, and the record of a completed tick.
"""

import os
import select
import subprocess
import tempfile
import time
from pathlib import Path

from intelhex import IntelHex

from emulator.lockstep import LockstepBoard
from emulator.processor import Violation
from palmbots.boards.settings_page import PAGE_ADDRESS, BoardSettings, settings_page
from palmbots.wire.serial_frames import FrameDecoder
from palmbots.wire.serial_frames import encode_frame as _encode

MACHINE = ("qemu-system-arm", "-M", "mps2-an386", "-nographic", "-monitor", "none")
PACKET, TICK, PULSES, DONE = 0x01, 0x41, 0x42, 0x43
_PATIENCE_S = 60.0


def _frame(kind: int, content: bytes) -> bytes:
    """A frame of a kind that the wire does not know."""
    crc = 0xFFFF
    plain = bytes([kind]) + content
    for byte in plain:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    out = b""
    for part in (plain + crc.to_bytes(2, "little")).split(b"\0"):
        out += bytes([len(part) + 1]) + part
    return out + b"\0"


class QemuBoard(LockstepBoard):
    """One robot in a process of QEMU."""

    def __init__(self, image: Path, settings: BoardSettings, table: bytes, seed: int) -> None:
        self.side = settings.role
        self.chance = seed
        self.sent: list[bytes] = []
        self.rejected = self.late = 0
        self.instructions: list[int] = []
        self._pulses: tuple[int, ...] = ()
        self._record = bytes(29)
        self._is_done = False
        self._decoder = FrameDecoder()
        self._folder = tempfile.TemporaryDirectory()
        flash, storage = Path(self._folder.name, "flash"), Path(self._folder.name, "storage")
        code = IntelHex(str(image)).tobinstr(start=0, size=PAGE_ADDRESS)
        flash.write_bytes(code + settings_page(settings, table))
        storage.write_bytes(b"\xff" * 0x2000)
        self._process = subprocess.Popen(
            [*MACHINE, "-serial", "stdio",
             "-device", f"loader,file={flash},addr=0,force-raw=on",
             "-device", f"loader,file={storage},addr=0x20010000,force-raw=on"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0,
        )  # fmt: skip

    def close(self) -> None:
        """End QEMU."""
        self._process.kill()
        self._process.communicate()
        self._folder.cleanup()

    def _write(self, data: bytes) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(data)

    def _read(self) -> None:
        assert self._process.stdout is not None
        ready, _, _ = select.select([self._process.stdout], [], [], 1.0)
        if not ready:
            return
        for kind, content in self._decoder.take(os.read(self._process.stdout.fileno(), 4096)):
            if kind == PACKET:
                self.sent.append(content)
            elif kind == PULSES:
                self._pulses = tuple(
                    int.from_bytes(content[i : i + 2], "little") for i in (0, 2, 4, 6)
                )
            elif kind == DONE:
                self._record, self._is_done = content, True

    def _run(self, elapsed: int, closed: int, packets: int | None) -> None:
        """Let a tick begin, and wait for its record and for its packets."""
        self._is_done = False
        tick = elapsed.to_bytes(2, "little") + closed.to_bytes(2, "little") + b"\0"
        self._write(_frame(TICK, tick))
        end_s = time.monotonic() + _PATIENCE_S
        while not self._is_done or len(self.sent) < self._expected(packets):
            if time.monotonic() > end_s or self._process.poll() is not None:
                raise Violation("QEMU: the board does not answer")
            self._read()

    def _expected(self, packets: int | None) -> int:
        return self.record()["packets"] if packets is None else packets

    def greeting(self, expected: int) -> list[bytes]:
        """A round of greetings: the packets that the board sends."""
        self.sent = []
        self._run(1, 0, expected)
        return self.sent

    def receive(self, packets: list[bytes]) -> None:
        """Packets arrive, one after the other."""
        for data in packets:
            self._write(_encode("packet", data))

    def feel(self, closed: int, elapsed: int) -> dict[str, int]:
        """One tick with these switches closed."""
        self._run(elapsed, closed, None)
        return self.record()

    def raw_record(self) -> bytes:
        """The record of the newest tick."""
        return self._record

    @property
    def pulses(self) -> tuple[int, ...]:
        """The newest pulses."""
        return self._pulses

    def reboot(self) -> None:
        """QEMU's board has no permanent memory."""
        raise Violation("QEMU: the board cannot be rebooted")

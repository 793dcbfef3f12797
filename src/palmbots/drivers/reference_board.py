# SPDX-License-Identifier: Apache-2.0
"""A motor board in software, which follows docs/reference/wire.md: for tests, and as a model.

    python -m palmbots.drivers.reference_board [--link PATH]

prints the path of a pseudo-terminal, which a robot uses as its serial device, and then a line
whenever the wheels or the palm get another command. Type ``press 3``, ``release 3`` (a switch, from
0), ``battery 7.2`` or ``reboot``.

`ReferenceBoard` is the board without its line. The firmware of a real board does the same. Its
wheels follow commands at once; a real one has a motor controller there.
"""

import argparse
import contextlib
import os
import pty
import select
import sys
import time
import tty
from pathlib import Path

from palmbots.wire.serial_frames import (
    FRAME_NUMBERS,
    BoardCommand,
    BoardIdentity,
    BoardReading,
    FrameDecoder,
    content_of,
    frame_of,
)

READING_EVERY_S = 0.01
_SERVO_RATE = 1.0  # rad/s
_TICKS_PER_TURN = 1440
_TURN = 6.283185307179586


class ReferenceBoard:
    """Bytes in, bytes out.

    Args:
        identity: what the board states about itself.
        now_s: the time.
    """

    def __init__(self, identity: BoardIdentity | None = None, now_s: float = 0.0) -> None:
        self.identity = identity or BoardIdentity(
            has_encoders=True, measures_palm=True, measures_battery=True, switches=9,
            longest_watchdog_ms=1000,
        )  # fmt: skip
        self.switches = 0
        """Bit i: switch i is pressed."""
        self.battery_v = 7.4
        self.servo_rad = _TURN / 4
        """Angle of the servo."""
        self.boot(now_s)

    def boot(self, now_s: float) -> None:
        """Begin anew, with the wheels at rest."""
        self.wheels: tuple[float, float] = (0.0, 0.0)
        """Angular speeds of the left and the right wheel [rad/s]."""
        self.watchdog_acts = False
        self._turned = [0.0, 0.0]  # rad
        self._decoder = FrameDecoder()
        self._command = BoardCommand(0, False, False, 1)
        self.target_rad = self.servo_rad
        self._malformed = 0
        self._now_s = self._stop_s = self._next_s = now_s
        self._unsent = frame_of(self.identity)

    def take(self, data: bytes, now_s: float) -> None:
        """Bytes have arrived."""
        self._advance(now_s)
        for kind, content in self._decoder.take(data):
            command = content_of(kind, content)
            if isinstance(command, BoardCommand):
                self._obey(command, now_s)
            elif kind == FRAME_NUMBERS["board_hello"] and not content:
                self._unsent += frame_of(self.identity)
            else:
                self._malformed += 1

    def _obey(self, command: BoardCommand, now_s: float) -> None:
        self._command, self.watchdog_acts = command, False
        watchdog_ms = min(command.watchdog_ms, self.identity.longest_watchdog_ms)
        self._stop_s = now_s + 1e-3 * watchdog_ms
        speeds = (1e-3 * command.left_speed, 1e-3 * command.right_speed)
        self.wheels = speeds if command.wheels else (0.0, 0.0)
        if command.palm:
            self.target_rad = 1e-3 * command.palm_angle

    @property
    def next_s(self) -> float:
        """The time at which `step` has something to do."""
        return min(self._next_s, self._stop_s) if self.wheels != (0.0, 0.0) else self._next_s

    def step(self, now_s: float) -> bytes:
        """The time is now this; returns the bytes to send."""
        self._advance(now_s)
        if now_s >= self._next_s:
            self._next_s = max(self._next_s + READING_EVERY_S, now_s)
            self._unsent += frame_of(self._reading())
        sent, self._unsent = self._unsent, b""
        return sent

    def _advance(self, now_s: float) -> None:
        # The watchdog comes first: whatever was late, the wheels do not turn beyond its time.
        if now_s >= self._stop_s and self.wheels != (0.0, 0.0):
            self._turn(self._stop_s)
            self.wheels, self.watchdog_acts = (0.0, 0.0), True
        self._turn(now_s)

    def _turn(self, until_s: float) -> None:
        elapsed_s = max(0.0, until_s - self._now_s)
        self._now_s = max(self._now_s, until_s)
        for wheel, speed in enumerate(self.wheels):
            self._turned[wheel] += speed * elapsed_s
        most = _SERVO_RATE * elapsed_s
        self.servo_rad += max(-most, min(most, self.target_rad - self.servo_rad))

    def _reading(self) -> BoardReading:
        has = self.identity
        left, right = (_signed(round(_TICKS_PER_TURN * turn / _TURN)) for turn in self._turned)
        return BoardReading(
            number=self._command.number,
            watchdog_acts=self.watchdog_acts,
            time_ms=round(1000 * self._now_s) % 65536,
            switches=self.switches,
            palm_angle=round(1000 * self.servo_rad) if has.measures_palm else 0,
            left_count=left if has.has_encoders else 0,
            right_count=right if has.has_encoders else 0,
            battery_mv=round(1000 * self.battery_v) if has.measures_battery else 0,
            damaged=(self._decoder.damaged + self._malformed) % 65536,
        )


def _signed(count: int) -> int:
    """A count modulo 2³², from -2³¹ to 2³¹ - 1."""
    return (count + 2**31) % 2**32 - 2**31


class _Terminal:
    """The board's end of a pseudo-terminal."""

    def __init__(self, link: str | None) -> None:
        # The slave stays open here: otherwise the line would end when a robot leaves it.
        self.master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self.master, False)
        self.path = os.ttyname(self._slave)
        if link is not None:
            place = Path(link)
            fresh = place.with_name(f"{place.name}.new")
            fresh.unlink(missing_ok=True)
            fresh.symlink_to(self.path)
            fresh.replace(place)
            self.path = link

    def exchange(self, data: bytes, wait_s: float, *others: int) -> bytes:
        """Send bytes, and wait until some arrive, or `others` can be read; returns what arrived."""
        with contextlib.suppress(BlockingIOError):  # nobody reads
            os.write(self.master, data)
        ready, _, _ = select.select([self.master, *others], [], [], max(0.0, wait_s))
        try:
            return os.read(self.master, 4096) if self.master in ready else b""
        except BlockingIOError:
            return b""


def _order(board: ReferenceBoard, line: str, now_s: float) -> None:
    """Carry out what a person has typed."""
    word, _, number = line.strip().partition(" ")
    try:
        if word == "press":
            board.switches |= 1 << int(number)
        elif word == "release":
            board.switches &= ~(1 << int(number))
        elif word == "battery":
            board.battery_v = float(number)
        elif word == "reboot":
            board.boot(now_s)
    except ValueError:
        print("allowed: press N, release N, battery V, reboot", file=sys.stderr, flush=True)


def main() -> None:
    """Run a board until it is ended."""
    parser = argparse.ArgumentParser(description="A motor board in software.")
    parser.add_argument("--link", metavar="PATH", help="a symbolic link to the terminal")
    terminal = _Terminal(parser.parse_args().link)
    board = ReferenceBoard(now_s=time.monotonic())
    print(terminal.path, flush=True)
    stated, has_input = "", True
    while True:
        sent = board.step(time.monotonic())
        wait_s = board.next_s - time.monotonic()
        arrived = terminal.exchange(sent, wait_s, *([0] if has_input else []))
        board.take(arrived, time.monotonic())
        if has_input and select.select([0], [], [], 0)[0]:
            typed = os.read(0, 4096)
            has_input = bool(typed)
            for line in typed.decode(errors="replace").splitlines():
                _order(board, line, time.monotonic())
        left, right = board.wheels
        by = " by the watchdog" if board.watchdog_acts else ""
        text = f"wheels {left:.3f} {right:.3f} rad/s{by}, palm to {board.target_rad:.3f} rad"
        if text != stated:
            stated = text
            print(f"{time.monotonic():.4f} {text}", flush=True)


if __name__ == "__main__":
    main()

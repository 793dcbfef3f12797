# SPDX-License-Identifier: Apache-2.0
"""The driver of a motor board on a serial line (docs/reference/wire.md).

The board stops the wheels when no command comes in time: each command states for how long it holds.
"""

import math
import time

from palmbots.drivers.driver import (
    WATCHDOG_SHARE,
    DriverSettings,
    NoAnswer,
    RawCommand,
    RawReading,
)
from palmbots.drivers.hardware import oriented
from palmbots.drivers.hardware_driver import HardwareDriver
from palmbots.errors import PalmbotsError
from palmbots.links.serial_line import SerialLine
from palmbots.wire.serial_frames import (
    BOARD_VERSION,
    FRAME_NUMBERS,
    BoardCommand,
    BoardIdentity,
    BoardReading,
    content_of,
    encode_frame,
    frame_of,
)

_ANSWERS_WITHIN_S = 5.0  # many boards boot when the line is opened
_POLL_S = 0.005
_HELLO_EVERY_S = 0.5
_SILENCE_S = 0.25
_OF_BRIDGES = (FRAME_NUMBERS["packet"], FRAME_NUMBERS["bridge_report"])
_MOST = 2**15 - 1  # of a signed number of 16 bits


class SerialDriver(HardwareDriver):
    """A motor board.

    Raises:
        PalmbotsError: the device cannot be opened, no motor board answers there, or the board
            does not fit to ``[hardware]``.
    """

    def __init__(self, settings: DriverSettings) -> None:
        super().__init__(settings)
        self._silence_s = max(_SILENCE_S, 3 * settings.period_s)
        self._watchdog_ms = max(1, int(1000 * WATCHDOG_SHARE * settings.watchdog_s))
        self._identity: BoardIdentity | None = None
        self._newest: BoardReading | None = None
        self._last: tuple[int, int] | None = None  # counts as the board numbers them; None: anew
        self._counts = (0, 0)  # since this driver was opened
        self._number = 0
        self._times_opened = 1
        self._hello_s = self._heard_s = -math.inf
        self._asked_s: float | None = None  # when the oldest command without confirmation was sent
        self._line = SerialLine("driver.address", settings.address, settings.baud, settings.on_line)
        try:
            self._await()
        except PalmbotsError:
            self._line.close()
            raise

    def _await(self) -> None:
        """Wait for the board's identity and its first reading.

        Raises:
            PalmbotsError: they do not come, or do not fit.
        """
        give_up = time.monotonic() + _ANSWERS_WITHIN_S
        while self._identity is None or self._newest is None:
            self._take()
            if time.monotonic() > give_up:
                raise NoAnswer(
                    f"driver.address: no motor board answers at {self.settings.address} "
                    f"within {_ANSWERS_WITHIN_S:g} s"
                )
            time.sleep(_POLL_S)

    def read_raw(self) -> RawReading:
        """The newest reading of the board."""
        self._take()
        assert self._identity is not None and self._newest is not None  # since `_await`
        seen, hardware = self._newest, self.settings.hardware
        closed = tuple(bool(seen.switches >> i & 1) for i in range(len(hardware.switches)))
        return RawReading(
            oriented(hardware, self._counts) if self._identity.has_encoders else None,
            closed,
            seen.palm_angle / 1000 if self._identity.measures_palm else None,
            seen.battery_mv / 1000 if self._identity.measures_battery else None,
        )

    @property
    def works(self) -> bool:
        """The line is open, readings come, and the board confirms commands."""
        now = time.monotonic()
        is_heard = now - self._heard_s <= self._silence_s
        is_obeyed = self._asked_s is None or now - self._asked_s <= self._silence_s
        return self._line.is_open and is_heard and is_obeyed

    def write_raw(self, command: RawCommand) -> None:
        """Command the motors."""
        left, right = oriented(self.settings.hardware, command.wheels_rad_s)
        palm = command.servo_rad
        turns = command.wheels_rad_s != (0.0, 0.0)
        self._number = (self._number + 1) % 256
        shape = BoardCommand(
            self._number, turns, palm is not None, self._watchdog_ms,
            _milli(left), _milli(right), 0 if palm is None else _milli(palm),
        )  # fmt: skip
        self._line.send(frame_of(shape))
        self._asked_s = time.monotonic() if self._asked_s is None else self._asked_s

    def close(self) -> None:
        """Stop the wheels, and close the line."""
        self.stop()
        self._line.close()

    def _take(self) -> None:
        """Take in what the board has sent."""
        frames = self._line.receive()
        if self._line.times_opened != self._times_opened:  # the board may have booted meanwhile
            self._times_opened = self._line.times_opened
            self._hello_s = -math.inf
            self._asked_s = None
            self._last = None  # its encoders may count anew
        for kind, content in frames:
            found = content_of(kind, content)
            if isinstance(found, BoardIdentity):
                self._meet(found)
            elif isinstance(found, BoardReading):
                self._note(found)
            elif kind in _OF_BRIDGES and self._identity is None:
                raise PalmbotsError(
                    f"driver.address: {self.settings.address} is a radio bridge; "
                    "allowed: a motor board"
                )
        now = time.monotonic()
        is_met = self._identity is not None and now - self._heard_s <= self._silence_s
        if not is_met and now - self._hello_s >= _HELLO_EVERY_S:
            self._hello_s = now
            self._line.send(encode_frame("board_hello"))

    def _meet(self, board: BoardIdentity) -> None:
        """The identity of a board. Its encoders may count anew: it may have booted.

        Raises:
            PalmbotsError: the board cannot be used.
        """
        address, hardware = self.settings.address, self.settings.hardware
        if board.version != BOARD_VERSION:
            raise PalmbotsError(
                f"driver.address: the board at {address} has version {board.version} of the "
                f"frames; allowed: {BOARD_VERSION}"
            )
        wired = len(hardware.switches)
        if board.switches < wired:
            raise PalmbotsError(
                f"hardware.switches: {wired} switches are listed; the board at {address} has "
                f"{board.switches}"
            )
        if board.longest_watchdog_ms < 3000 * self.settings.period_s:
            raise PalmbotsError(
                f"driver.address: the board at {address} stops after "
                f"{board.longest_watchdog_ms} ms without a command; needed: at least three control "
                f"periods, {3000 * self.settings.period_s:g} ms"
            )
        self._identity, self._last = board, None

    def _note(self, seen: BoardReading) -> None:
        now = time.monotonic()
        before, self._newest, self._heard_s = self._newest, seen, now
        if before is None or seen.number == self._number or seen.number != before.number:
            self._asked_s = None
        counts = (seen.left_count, seen.right_count)
        last = counts if self._last is None else self._last
        left, right = (_difference(*pair) for pair in zip(counts, last, strict=True))
        self._counts, self._last = (self._counts[0] + left, self._counts[1] + right), counts


def _difference(now: int, before: int) -> int:
    """The difference of two counts modulo 2³², from -2³¹ to 2³¹ - 1."""
    return (now - before + 2**31) % 2**32 - 2**31


def _milli(value: float) -> int:
    """A number in thousandths, as far as the field allows."""
    return max(-_MOST, min(_MOST, round(1000 * value)))

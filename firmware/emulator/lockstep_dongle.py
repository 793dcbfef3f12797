# SPDX-License-Identifier: Apache-2.0
"""The station's radio on an emulated board, in lockstep with two robots and the exact world.

The station's program runs on the host. Each of its packets goes through the serial line and the
radio of the board, in both directions, within the tick in which the world passes it.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import palmbots._core as _core
from emulator.board import Board, Image
from emulator.processor import CYCLES_PER_US, Violation
from palmbots.boards.settings_page import PAGE_ADDRESS, radio_settings, settings_page
from palmbots.wire.serial_frames import FRAME_NUMBERS, FrameDecoder, encode_frame

_CHANNEL = 60


class LockstepDongle:
    """The board of the station's radio, and the station behind it.

    Args:
        image: the program of the board.
        station: the station's program.
        period_us: of a control tick of the world.
        seed: of the board's random numbers.
    """

    def __init__(self, image: Image, station: Any, period_us: int, seed: int) -> None:
        page = settings_page(radio_settings(_CHANNEL, 0))
        self.board = Board(replace(image, flash=image.flash[:PAGE_ADDRESS] + page), seed)
        self.board.on_send = self._sends
        self.station = station
        self.instructions: list[int] = []
        self._period = period_us * CYCLES_PER_US
        self._sent: list[bytes] = []
        self._decoder = FrameDecoder()
        self._outages = 0
        self._is_out = False
        self._power_up()

    def _sends(self, data: bytes) -> None:
        self._sent.append(data)

    def _power_up(self) -> None:
        self.board.boot()
        self._wait_for_timer()

    def _wait_for_timer(self) -> None:
        while self.board.timer.started_at is None or not self.board.radio.listens:
            self.board.run_us(10)
        self._begin_tick()

    def _begin_tick(self) -> None:
        self._end = self.board.now + self._period
        self._executed = self.board.meter.instructions

    def _end_tick(self) -> None:
        self.board.run(self._end)
        self.instructions.append(self.board.meter.instructions - self._executed)
        self._begin_tick()

    # --- packets

    def from_radio(self, data: bytes) -> bytes:
        """A packet of a robot, as the station reads it from the serial line."""
        board = self.board
        self._run_until(lambda: board.radio.listens)
        board.serial_out = b""
        board.radio.receive(data)
        found: list[bytes] = []

        def has_come() -> bool:
            written, board.serial_out = board.serial_out, b""
            found.extend(
                bytes(content)
                for kind, content in self._decoder.take(written)
                if kind == FRAME_NUMBERS["packet"]
            )
            return bool(found)

        self._run_until(has_come)
        return found[0]

    def to_radio(self, packets: Sequence[bytes]) -> list[bytes]:
        """Packets of the station, as they leave the antenna."""
        self._sent = []
        for data in packets:
            self.board.uart.feed(encode_frame("packet", data))
        self._run_until(lambda: len(self._sent) == len(packets) and self.board.radio.listens)
        return self._sent

    def _run_until(self, is_done: Any) -> None:
        board = self.board
        while not is_done():
            if board.now >= self._end:
                raise Violation("the station's radio does not pass a packet within its tick")
            board.run_a_little(self._end)

    # --- the station

    def greet(self, robot: int, hello: bytes) -> bytes:
        """Pass the hello of a robot to the station, and its answer to the robot."""
        self.station.hear(self.from_radio(hello))
        (answer,) = self.to_radio([self.station.greet(robot)])
        self._end_tick()
        return answer

    def step(self, packets: Sequence[bytes] | None) -> Any:
        """One tick of the station.

        Args:
            packets: those that have arrived at its radio; None: the world says that the station is
                lost, so its radio has failed.
        """
        if packets is None:
            self._fail()
            return None
        self._recover()
        sent, *rest = self.station.step([self.from_radio(data) for data in packets])
        on_air = self.to_radio([data for _, data, _ in sent])
        self._end_tick()
        return (
            [(to, data, message) for (to, _, message), data in zip(sent, on_air, strict=True)],
            *rest,
        )

    def _fail(self) -> None:
        """Outages are power cuts and hangs of the program in turn."""
        if self._is_out:
            return
        self._is_out = True
        if self._outages % 2 == 0:
            self.board.cut_power()
        else:
            self.board.halt += round(1e6 * CYCLES_PER_US)  # longer than any watchdog
        self._outages += 1

    def _recover(self) -> None:
        if not self._is_out:
            return
        self._is_out = False
        self._decoder = FrameDecoder()
        resets = len(self.board.resets)
        if self._outages % 2 == 1:
            self._power_up()
            return
        while len(self.board.resets) == resets:
            self.board.run_us(1000)
        self._wait_for_timer()


def station_program(key: bytes, pair: int) -> Any:
    """The program of a station, on the host."""
    return _core.runtime.Station(key, pair, 1)

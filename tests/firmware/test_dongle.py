# SPDX-License-Identifier: Apache-2.0
"""The station's radio: an emulated board behind a serial line."""

import contextlib
import json
import os
import pty
import subprocess
import sys
import time
import tty
from collections.abc import Callable
from dataclasses import replace

import pytest

from emulator.__main__ import dongle_image
from emulator.board import Board, Image
from emulator.live import LivePair
from palmbots.boards.pair_settings import BoardPair
from palmbots.boards.settings_page import PAGE_ADDRESS
from palmbots.wire.serial_frames import BridgeReport, FrameDecoder, content_of, encode_frame

MakeBoards = Callable[..., BoardPair]
PACKET = bytes(range(1, 33))


@pytest.fixture
def dongle(image: Image, boards: MakeBoards) -> Board:
    made = dongle_image()
    flash = made.flash[:PAGE_ADDRESS] + boards().dongle_page()
    board = Board(replace(made, flash=flash), 1)
    board.boot()
    board.run_us(5000)
    return board


def frames(board: Board) -> list[tuple[int, bytes]]:
    written, board.serial_out = board.serial_out, b""
    decoder = FrameDecoder()
    found = [(kind, bytes(content)) for kind, content in decoder.take(written)]
    assert decoder.damaged == 0
    return found


def test_packets_pass_in_both_directions(dongle: Board) -> None:
    sent: list[bytes] = []
    dongle.on_send = sent.append
    dongle.uart.feed(encode_frame("packet", PACKET))
    dongle.run_us(5000)
    assert sent == [PACKET]
    dongle.radio.receive(PACKET[::-1])
    dongle.run_us(2000)
    assert (1, PACKET[::-1]) in frames(dongle)


def test_what_cannot_be_forwarded_is_reported(dongle: Board) -> None:
    sent: list[bytes] = []
    dongle.on_send = sent.append
    burst = b"".join(encode_frame("packet", PACKET) for _ in range(20))
    dongle.uart.feed(b"\x05\x13\x00" + burst)
    for _ in range(3):
        while not dongle.radio.listens:
            dongle.run_us(100)
        dongle.radio.receive(PACKET, crc_ok=False)
        dongle.run_us(100)
    dongle.run_us(700_000)
    reports = [content_of(kind, content) for kind, content in frames(dongle)]
    (report,) = [r for r in reports if isinstance(r, BridgeReport)]
    assert report.sent == len(sent) >= 8
    assert report.radio_full == 20 - len(sent)
    assert report.serial_damaged == 1
    assert report.radio_damaged == 3
    assert report.received == 0


def test_a_long_stream_is_taken_without_loss(dongle: Board) -> None:
    """The reports and commands of the centralized algorithm: 200 packets per second."""
    sent: list[bytes] = []
    dongle.on_send = sent.append
    packets = [bytes([1 + n % 250]) * 32 for n in range(200)]
    for packet in packets:
        dongle.uart.feed(encode_frame("packet", packet))
        dongle.run_us(5000)
    dongle.run_us(20_000)
    assert sent == packets


def test_the_real_station_and_three_boards(image: Image, boards: MakeBoards) -> None:
    """Four programs together: `palmbots station` at the serial line of the emulated dongle."""
    ours, theirs = pty.openpty()
    tty.setraw(ours)
    tty.setraw(theirs)
    os.set_blocking(ours, False)
    pair = boards(
        values={
            "link.kind": "serial",
            "link.station": os.ttyname(theirs),
            "limits.station_lost": "stop",
            "limits.station_limit_s": 5.0,
        }
    )
    live = LivePair(image, pair, seed=3, dongle=dongle_image())
    command = [sys.executable, "-m", "palmbots", "station", str(pair.pair.file), "--auto", "--json"]
    station = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    start_s = time.monotonic()
    try:
        while station.poll() is None and time.monotonic() - start_s < 400:
            if live.time_us > 1e6 * (time.monotonic() - start_s):
                os.sched_yield()  # the boards are ahead of the station's clock
                continue
            try:
                received = os.read(ours, 4096)
            except BlockingIOError:
                received = b""
            live.tick()
            with contextlib.suppress(BlockingIOError):  # the station does not read yet: lost
                os.write(ours, live.exchange_serial(received))
        printed, errors = station.communicate(timeout=20)
    finally:
        station.kill()
        os.close(ours)
        os.close(theirs)
    assert station.returncode == 0, (printed, errors, live.state())
    assert errors == ""
    assert json.loads(printed.splitlines()[-1])
    assert [robot.mode for robot in live.robots] == ["done", "done"]
    assert live.is_held

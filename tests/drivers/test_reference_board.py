# SPDX-License-Identifier: Apache-2.0
"""The motor board in software does what docs/reference/wire.md says of a board, byte by byte."""

import random
import struct

import pytest

import serial_oracle
from palmbots.drivers.reference_board import ReferenceBoard
from palmbots.wire.serial_frames import BoardIdentity
from serial_lines import frames_in

HELLO, COMMAND = (serial_oracle.KINDS[f"board_{name}"] for name in ("hello", "command"))
IDENTITY, READING = (serial_oracle.KINDS[f"board_{name}"] for name in ("identity", "reading"))


def command(number: int, flags: int, watchdog: int, left: int, right: int, palm: int) -> bytes:
    content = struct.pack("<BBHhhh", number, flags, watchdog, left, right, palm)
    return serial_oracle.frame(COMMAND, content)


def reading(board: ReferenceBoard, now_s: float) -> tuple[int, ...]:
    kind, content = frames_in(board.step(now_s))[-1]
    assert kind == READING
    return struct.unpack("<BBHHhiiHH", content)


def test_it_answers_a_hello_and_states_its_boot() -> None:
    board = ReferenceBoard(BoardIdentity(1, True, False, True, 9, 500))
    identity = struct.pack("<BBBH", 1, 0b101, 9, 500)
    assert frames_in(board.step(0.0))[0] == (IDENTITY, identity)
    board.step(0.01)
    board.take(serial_oracle.frame(HELLO, b""), 0.015)
    assert frames_in(board.step(0.016)) == [(IDENTITY, identity)]
    board.boot(1.0)
    assert frames_in(board.step(1.0))[0] == (IDENTITY, identity)


def test_wheels_and_servo_follow_commands_and_are_measured() -> None:
    board = ReferenceBoard()
    board.servo_rad = 1.0
    board.switches, board.battery_v = 0b1_0000_0001, 7.25
    board.take(command(9, 3, 1000, 1000, -2000, 1100), 0.0)
    assert board.wheels == (1.0, -2.0)
    number, flags, time, switches, palm, left, right, battery, damaged = reading(board, 0.5)
    assert (number, flags, time, damaged) == (9, 0, 500, 0)
    assert (switches, battery) == (0b1_0000_0001, 7250)
    turn = 1440 / (2 * 3.14159265)  # counts of one radian
    assert (left, right) == (round(0.5 * turn), round(-1.0 * turn))
    assert palm == 1100  # reached after 0.1 s
    board.take(command(10, 0, 1000, 1000, 1000, 0), 0.6)  # neither wheels nor palm
    assert board.wheels == (0.0, 0.0)
    assert reading(board, 0.7)[4] == 1100


@pytest.mark.parametrize("watchdog_ms", [1, 90, 250])
def test_the_watchdog_stops_the_wheels_at_its_time(watchdog_ms: int) -> None:
    board = ReferenceBoard()
    board.take(command(1, 1, watchdog_ms, 1000, 1000, 0), 0.0)
    board.step(1e-3 * watchdog_ms - 1e-6)
    assert board.wheels == (1.0, 1.0)
    # It is stepped late: the wheels have turned no longer all the same.
    flags, left = [reading(board, 2.0)[i] for i in (1, 5)]
    assert flags == 1
    assert left == round(1440 / (2 * 3.14159265) * 1e-3 * watchdog_ms)
    board.take(command(2, 1, watchdog_ms, 1000, 1000, 0), 2.1)
    assert (board.wheels, board.watchdog_acts) == ((1.0, 1.0), False)


def test_a_command_cannot_ask_for_a_longer_watchdog_than_the_board_has() -> None:
    board = ReferenceBoard(BoardIdentity(switches=9, longest_watchdog_ms=200))
    board.take(command(1, 1, 60_000, 1000, 1000, 0), 0.0)
    board.step(0.201)
    assert board.wheels == (0.0, 0.0)


def test_damaged_frames_are_no_commands() -> None:
    chance = random.Random(1)
    board = ReferenceBoard()
    good = command(1, 1, 1000, 1000, 1000, 0)
    for _ in range(300):
        bad = bytearray(good)
        bad[chance.randrange(len(bad) - 1)] ^= 1 << chance.randrange(8)
        board.take(b"\0" + bytes(bad), 0.0)
        assert board.wheels == (0.0, 0.0)
    board.take(command(1, 4, 1000, 1000, 1000, 0), 0.0)  # an unknown flag
    board.take(command(1, 1, 0, 1000, 1000, 0), 0.0)  # no watchdog
    assert board.wheels == (0.0, 0.0)
    assert reading(board, 0.1)[8] > 250
    board.take(good, 0.2)
    assert board.wheels == (1.0, 1.0)


def test_a_boot_stops_the_wheels() -> None:
    board = ReferenceBoard()
    board.take(command(1, 1, 1000, 1000, 1000, 0), 0.0)
    board.boot(0.5)
    assert board.wheels == (0.0, 0.0)
    assert reading(board, 0.6)[5:7] == (0, 0)

# SPDX-License-Identifier: Apache-2.0
"""The models of the peripherals refuse what the hardware does not permit."""

from collections.abc import Callable

import pytest

from emulator.board import Board, Image
from emulator.processor import Violation
from emulator.registers import at


def write(board: Board, register: str, value: int, number: int = 0) -> None:
    """What the firmware would do."""
    address = at(register, number)
    board.written(address, 4, value)
    board.set_word(address, value)


@pytest.fixture
def board(image: Image) -> Board:
    board = Board(image)
    board.clock.crystal_runs = True
    return board


def radio_on(board: Board) -> None:
    for register in ("MODE", "FREQUENCY", "TXPOWER", "PCNF0", "PCNF1", "CRCCNF", "CRCPOLY"):
        write(board, f"RADIO.{register}", 36 if register == "PCNF1" else 0)
    write(board, "RADIO.PACKETPTR", 0x20001000)
    write(board, "RADIO.SHORTS", 1)
    write(board, "RADIO.TASKS_RXEN", 1)


def started_twice(board: Board) -> None:
    radio_on(board)
    write(board, "RADIO.TASKS_RXEN", 1)


def started_while_listening(board: Board) -> None:
    radio_on(board)
    board.radio.ready("rx")
    write(board, "RADIO.TASKS_START", 1)


def reconfigured(board: Board) -> None:
    radio_on(board)
    write(board, "RADIO.FREQUENCY", 3)


def without_crystal(board: Board) -> None:
    board.clock.crystal_runs = False
    radio_on(board)


def buffer_in_flash(board: Board) -> None:
    radio_on(board)
    write(board, "RADIO.PACKETPTR", 0x1000)
    board.radio.ready("rx")


def unknown_power(board: Board) -> None:
    write(board, "RADIO.TXPOWER", 9)


def servo(pulse: int) -> Callable[[Board], None]:
    def move(board: Board) -> None:
        write(board, "PWM0.ENABLE", 1)
        write(board, "PWM0.DECODER", 2)
        write(board, "PWM0.SEQ0_CNT", 4)
        write(board, "PWM0.SEQ0_PTR", 0x20001000)
        board.set_bytes(0x20001000, (0x8000 | pulse).to_bytes(2, "little") + b"\x00\x80" * 3)
        write(board, "PWM0.TASKS_SEQSTART", 1)

    return move


def store(address: int, *values: int) -> Callable[[Board], None]:
    def write_words(board: Board) -> None:
        write(board, "NVMC.CONFIG", 1)
        for value in values:
            board.written(address, 4, value)
            board.set_word(address, value)

    return write_words


def store_without_permission(board: Board) -> None:
    board.written(0x7E000, 4, 0)


def erase(board: Board) -> None:
    write(board, "NVMC.CONFIG", 2)
    write(board, "NVMC.ERASEPAGE", 0x7E000)


def erase_while_carrying(board: Board) -> None:
    board.can_erase = lambda: False
    erase(board)


def wear_out(board: Board) -> None:
    for _ in range(10_001):
        erase(board)


def fed_wrongly(board: Board) -> None:
    write(board, "WDT.CONFIG", 1)
    write(board, "WDT.RREN", 1)
    write(board, "WDT.TASKS_START", 1)
    write(board, "WDT.RR", 1)


def watchdog_changed(board: Board) -> None:
    write(board, "WDT.CONFIG", 1)
    write(board, "WDT.RREN", 1)
    write(board, "WDT.TASKS_START", 1)
    write(board, "WDT.CRV", 9)


def whole_port(board: Board) -> None:
    write(board, "P0.OUT", 1)


def no_register(board: Board) -> None:
    board.written(0x40001FF0, 4, 1)


@pytest.mark.parametrize(
    ("misuse", "line"),
    [
        (started_twice, "RADIO: enabled in mode rxru"),
        (started_while_listening, "RADIO: started in mode rx"),
        (reconfigured, "RADIO: FREQUENCY changed in mode rxru"),
        (without_crystal, "RADIO: enabled without the crystal"),
        (buffer_in_flash, "RADIO: a buffer at 0x1000, outside of RAM"),
        (unknown_power, "RADIO: a power of 9 dBm"),
        (servo(499), "PWM0: a pulse of 499 us"),
        (servo(2501), "PWM0: a pulse of 2501 us"),
        (store(0x7E000, 0, 1), "NVMC: sets bits at 0x7e000 that are cleared"),
        (store(0x7E000, 3, 1, 0), "NVMC: writes 0x7e000 too often"),
        (store(0x1000, 0), "NVMC: writes over the program"),
        (store_without_permission, "NVMC: writes to 0x7e000 without permission"),
        (erase_while_carrying, "NVMC: erases while the robot is not disarmed"),
        (wear_out, "NVMC: a page is worn out"),
        (fed_wrongly, "WDT: fed with a wrong value"),
        (watchdog_changed, "WDT: configured while it runs"),
        (whole_port, "P0: OUT written"),
        (no_register, "0x40001ff0 is no register that the board uses"),
    ],
)
def test_misuse_is_found(board: Board, misuse: Callable[[Board], None], line: str) -> None:
    with pytest.raises(Violation, match=line.replace("(", r"\(")):
        misuse(board)


def test_right_use_is_not(board: Board) -> None:
    radio_on(board)
    board.radio.ready("rx")
    servo(1500)(board)
    store(0x7E000, 3, 1)(board)
    erase(board)


def test_pins_of_the_antenna_become_pins_of_switches(image: Image) -> None:
    """Once: the program writes the setting, and restarts the chip."""
    board = Board(image)
    board.close_switches(0b001001001)  # all of the column at P0.10

    def column() -> int:
        """What the column reads while all rows are low."""
        for row in (17, 1, 13):
            write(board, "P0.PIN_CNF", 3, row)
        write(board, "P0.OUTCLR", 1 << 17 | 1 << 1 | 1 << 13)
        return board.word(at("P0.IN")) >> 10 & 1

    assert column() == 1  # not felt
    board.boot()
    board.run_us(5000)
    assert board.word(at("UICR.NFCPINS")) == 0xFFFFFFFE
    assert column() == 0
    written = dict(board.nvmc.writes)
    board.cut_power()
    board.boot()
    board.run_us(5000)
    assert board.nvmc.writes == written
    assert column() == 0
    assert board.resets == ["power"]


def test_the_debug_port_stays_open(image: Image) -> None:
    """By the setting of the chip and by the program, after each reset."""
    board = Board(image)
    for reset in (board.boot, board.watchdog_bites, board.cut_power):
        reset()
        board.boot()
        board.run_us(5000)
        assert board.word(at("UICR.APPROTECT")) == 0x5A
        assert board.word(at("APPROTECT.DISABLE")) == 0x5A


def test_memory_of_the_radio_is_guarded(image: Image) -> None:
    """The program fails as soon as it uses a buffer into which the radio writes."""
    board = Board(image)
    board.boot()
    board.run_us(5000)
    board.own(0, 0x20000000, 0xC00, may_read=False)  # its stack
    with pytest.raises(Violation, match="memory of a peripheral used at"):
        board.run_us(50_000)

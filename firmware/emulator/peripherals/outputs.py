# SPDX-License-Identifier: Apache-2.0
"""Pins and pulses."""

from emulator.peripherals.peripheral import Peripheral

OWNED = 1
ROWS = (17, 1, 13)
COLUMNS = (10, 12, 34)
BUTTONS = (14, 23)
LED_ROWS = (21, 22, 15, 24, 19)
LED_COLUMNS = (28, 11, 31, 37, 30)
"""The pins of the board as its documentation gives them, not read from the firmware."""


class Port(Peripheral):
    """P0 or P1."""

    first = 0

    def __init__(self, board) -> None:
        super().__init__(board)
        self.out = 0
        self.driven = 0

    def on_PIN_CNF(self, number: int, value: int) -> None:
        """Configure a pin."""
        self.driven = self.driven & ~(1 << number) | (value & 1) << number

    def on_OUTSET(self, value: int) -> None:
        """Set pins high."""
        self.out |= value
        self.board.pins_changed(self.first, value)

    def on_OUTCLR(self, value: int) -> None:
        """Set pins low."""
        self.out &= ~value
        self.board.pins_changed(self.first, value)

    def on_OUT(self, value: int) -> None:
        """Set all pins."""
        self.require(False, "OUT written: it would change other pins")

    def is_driven(self, pin: int) -> bool:
        """The pin is an output."""
        return self.driven >> pin & 1 == 1


class Port0(Port):
    """P0."""

    name = "P0"


class Port1(Port):
    """P1."""

    name = "P1"
    first = 32


class Pwm(Peripheral):
    """PWM0: pulses for four servos."""

    name = "PWM0"

    def __init__(self, board) -> None:
        super().__init__(board)
        self.pulses: tuple[int, ...] | None = None
        self.starts = 0

    def on_PRESCALER(self, value: int) -> None:
        """Configure."""
        self.require(value == 4, "widths are not in microseconds")

    def on_COUNTERTOP(self, value: int) -> None:
        """Configure."""
        self.require(value == 20000, f"a period of {value} us")

    def on_PSEL_OUT(self, number: int, value: int) -> None:
        """Configure."""
        self.require(self.get("ENABLE") == 0, "pins selected while it is enabled")
        self.require(self.board.is_output(value), f"pin {value} is no output")

    def on_TASKS_SEQSTART(self, number: int, value: int) -> None:
        """Take new widths at the next period."""
        self.require(self.get("ENABLE") == 1, "started while it is disabled")
        self.require(self.get("DECODER") == 2, "the outputs have no widths of their own")
        self.require(self.get("SEQ0_CNT") == 4 and number == 0, "a sequence of another length")
        raw = self.buffer(self.get("SEQ0_PTR"), 8)
        widths = [int.from_bytes(raw[i : i + 2], "little") for i in range(0, 8, 2)]
        self.require(all(width & 0x8000 for width in widths), "a pulse that begins low")
        pulses = tuple(width & 0x7FFF for width in widths)
        for pulse in pulses:
            self.require(pulse == 0 or 500 <= pulse <= 2500, f"a pulse of {pulse} us")
        self.pulses = pulses
        self.starts += 1
        # The hardware reads the widths when the next period begins, at the latest after 20 ms.
        self.board.own(OWNED, self.get("SEQ0_PTR"), 8, may_read=True)
        self.board.cancel("widths_read")
        self.board.in_us(20000, "widths_read")

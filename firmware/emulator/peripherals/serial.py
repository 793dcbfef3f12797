# SPDX-License-Identifier: Apache-2.0
"""UARTE0 and TWIM0: serial lines."""

import math

from emulator.peripherals.peripheral import Peripheral
from emulator.processor import CYCLES_PER_US
from emulator.registers import at

US_PER_BYTE = 10.0
OWNED_UART = 2
OWNED_TWI = 3


class Uart(Peripheral):
    """UARTE0 at 1 Mbit/s."""

    name = "UARTE0"
    interrupt = 2

    def __init__(self, board) -> None:
        super().__init__(board)
        self.arriving: list[int] = []
        self.first_us = 0.0
        """When the first of them has begun to arrive."""
        self.pointer = self.size = self.filled = 0
        self.listens = False
        self.overruns = 0

    def _is_off(self) -> None:
        self.require(self.get("ENABLE") == 0, "configured while it is enabled")

    def on_PSEL_TXD(self, value: int) -> None:
        """Configure."""
        self._is_off()

    def on_PSEL_RXD(self, value: int) -> None:
        """Configure."""
        self._is_off()

    def on_BAUDRATE(self, value: int) -> None:
        """Configure."""
        self.require(value == 0x10000000, "not 1 Mbit/s")

    def on_TASKS_STARTTX(self, value: int) -> None:
        """Send a buffer."""
        size = self.get("TXD_MAXCNT")
        pointer = self.get("TXD_PTR")
        data = self.buffer(pointer, size)
        self.require(size > 0, "sends nothing")
        self.board.own(OWNED_UART, pointer, size, may_read=True)
        self.board.in_us(US_PER_BYTE * size, "uart_sent", data)

    def sent(self, data: bytes) -> None:
        """A buffer has left."""
        self.board.disown(OWNED_UART)
        self.put("TXD_AMOUNT", len(data))
        self.event("EVENTS_ENDTX")
        self.board.serial_out += data

    def on_TASKS_STARTRX(self, value: int) -> None:
        """Receive into a buffer."""
        self.require(self.get("ENABLE") == 8, "started while it is disabled")
        self.require(self.get("INTENSET") & 1 << 2 == 0, "an interrupt for each byte")
        self.catch_up()  # what came before is lost
        self.listens = True
        self._next_buffer()
        self._wait_for_full()

    def _next_buffer(self) -> None:
        self.pointer, self.size, self.filled = self.get("RXD_PTR"), self.get("RXD_MAXCNT"), 0
        self.check_pointer(self.pointer, self.size)
        self.event("EVENTS_RXSTARTED")

    def feed(self, data: bytes) -> None:
        """Bytes arrive, one after the other."""
        if not data:
            return
        self.catch_up()
        if not self.arriving:
            self.first_us = self.board.now / CYCLES_PER_US
        self.arriving += data
        self._wait_for_full()

    def catch_up(self) -> None:
        """Put the bytes that have arrived by now into the buffer.

        Nothing looks at a byte before the counter is read or a buffer is full, so there is no event
        for each of them.
        """
        passed_us = self.board.now / CYCLES_PER_US - self.first_us
        count = min(len(self.arriving), int(passed_us / US_PER_BYTE + 1e-6))
        for value in self.arriving[:count]:
            self._byte(value)
        del self.arriving[:count]
        self.first_us += count * US_PER_BYTE

    def _byte(self, value: int) -> None:
        if not self.listens:
            return
        self.board.set_bytes(self.pointer + self.filled, bytes([value]))
        self.filled += 1
        self.event("EVENTS_RXDRDY")
        if self.board.word(at("PPI.CH0_EEP")) == at("UARTE0.EVENTS_RXDRDY"):
            self.board.counter.count_event()
        if self.filled == self.size:
            self.event("EVENTS_ENDRX")
            self.require(self.get("SHORTS") & 1 << 5 != 0, "stops to receive")
            self._next_buffer()

    def _wait_for_full(self) -> None:
        """Be called when the buffer is full, or when the last byte has arrived."""
        self.board.cancel("uart_bytes")
        if not self.arriving:
            return
        room = self.size - self.filled if self.listens else len(self.arriving)
        count = min(room, len(self.arriving))
        end_us = self.first_us + count * US_PER_BYTE
        self.board.at_time(math.ceil(end_us * CYCLES_PER_US), "uart_bytes")

    def bytes_have_come(self) -> None:
        """A buffer is full, or the line falls silent."""
        self.catch_up()
        self._wait_for_full()


class Twi(Peripheral):
    """TWIM0: the motor board."""

    name = "TWIM0"
    interrupt = 3

    def __init__(self, board) -> None:
        super().__init__(board)
        self.answers = True
        self.hangs = False
        self.newest: bytes | None = None

    def on_PSEL_SCL(self, value: int) -> None:
        """Configure."""
        self.require(self.get("ENABLE") == 0, "configured while it is enabled")

    def on_ENABLE(self, value: int) -> None:
        """Enable, or abandon a transfer."""
        if value == 0:
            self.board.cancel("twi_ends")
            self.board.disown(OWNED_TWI)

    def on_TASKS_STARTTX(self, value: int) -> None:
        """Send a buffer."""
        self.require(self.get("ENABLE") == 6, "started while it is disabled")
        size = self.get("TXD_MAXCNT")
        pointer = self.get("TXD_PTR")
        data = self.buffer(pointer, size)
        self.board.own(OWNED_TWI, pointer, size, may_read=True)
        if not self.hangs:
            self.board.in_us(90.0 * (1 + size if self.answers else 1), "twi_ends", data)

    def ends(self, data: bytes) -> None:
        """A transfer is over."""
        self.board.disown(OWNED_TWI)
        if not self.answers:
            self.put("ERRORSRC", 2)
            self.put("TXD_AMOUNT", 0)
            self.event("EVENTS_ERROR")
            return
        self.newest = data
        self.put("TXD_AMOUNT", len(data))
        self.event("EVENTS_LASTTX")
        if self.get("SHORTS") & 1 << 9:
            self.event("EVENTS_STOPPED")

    def on_TASKS_STOP(self, value: int) -> None:
        """End a transfer."""
        self.event("EVENTS_STOPPED")

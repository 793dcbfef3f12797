# SPDX-License-Identifier: Apache-2.0
"""NVMC: flash memory, its wear, and the time for which it halts the processor."""

import random

from emulator.peripherals.peripheral import Peripheral
from emulator.processor import FLASH, UICR

PAGE = 0x1000
ERASE_US = 87500.0
WORD_US = 42.5
MOST_WRITES = 2
"""To a word between two erases."""
MOST_ERASES = 10_000


class Nvmc(Peripheral):
    """The controller of the flash memory."""

    name = "NVMC"

    def __init__(self, board) -> None:
        super().__init__(board)
        self.config = 0
        self.writes: dict[int, int] = {}
        self.word_writes = 0
        """To pages, without the settings of the chip."""
        self.erases: dict[int, int] = {}
        self.power_fails_in: int | None = None
        """How many words are still written completely before the power fails; None: it stays."""
        self.newest: tuple[int, int, int] | None = None
        """Address of the newest word, and its content before and after."""
        self.chance = random.Random(1)

    def on_CONFIG(self, value: int) -> None:
        """Permit writing or erasing."""
        self.config = value

    def on_ERASEPAGE(self, value: int) -> None:
        """Erase a page."""
        self.require(self.config == 2, "erases without permission")
        self.require(value % PAGE == 0, "erases at an address that is no page")
        self.require(value >= 0x10000, "erases the program")
        self.require(self.board.may_erase(), "erases while the robot is not disarmed")
        self.erases[value] = self.erases.get(value, 0) + 1
        self.require(self.erases[value] <= MOST_ERASES, "a page is worn out")
        self.newest = None
        self.writes = {a: n for a, n in self.writes.items() if not value <= a < value + PAGE}
        if self.power_fails_in == 0:
            noise = bytes(
                self.chance.choice((0xFF, self.chance.randrange(256))) for _ in range(PAGE)
            )
            self.board.set_bytes(value, noise)
            self.board.power_fails()
            return
        self._count_word()
        self.board.set_bytes(value, b"\xff" * PAGE)
        self.board.halt_for(ERASE_US)

    def _count_word(self) -> None:
        if self.power_fails_in is not None:
            self.power_fails_in -= 1

    def write(self, address: int, size: int, value: int) -> None:
        """The program writes to flash memory."""
        self.require(size == 4 and address % 4 == 0, "writes less than a word")
        self.require(self.config == 1, f"writes to {address:#x} without permission")
        self.require(address >= 0x10000 or address >= UICR[0], "writes over the program")
        before = self.board.word(address)
        self.require(before & value == value, f"sets bits at {address:#x} that are cleared")
        self.writes[address] = self.writes.get(address, 0) + 1
        self.require(self.writes[address] <= MOST_WRITES, f"writes {address:#x} too often")
        self.word_writes += address < FLASH[1]
        self.newest = address, before, value
        if self.power_fails_in == 0:
            self.tear()
            self.board.power_fails()
            return
        self._count_word()
        self.board.halt_for(WORD_US)

    def tear(self) -> None:
        """The power fails while a word is written: some of the bits that had to be cleared are."""
        if self.newest is not None:
            address, before, value = self.newest
            self.board.torn = (address, before & (value | self.chance.getrandbits(32)))

    @staticmethod
    def covers(address: int) -> bool:
        """The address is in flash memory."""
        return address < FLASH[1] or UICR[0] <= address < UICR[0] + UICR[1]

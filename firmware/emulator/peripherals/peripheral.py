# SPDX-License-Identifier: Apache-2.0
"""What the models of all peripherals share."""

from collections.abc import Callable
from copy import deepcopy
from typing import TYPE_CHECKING, Any

from emulator.processor import RAM, Violation
from emulator.registers import addresses, at

if TYPE_CHECKING:
    from emulator.board import Board


class Peripheral:
    """A peripheral of a board.

    A method ``on_REGISTER`` is called before the program writes to that register, with the value,
    or with the number and the value if there are several of a kind. Registers without a method are
    plain memory. A write to a register that does not exist is a violation.
    """

    name = ""
    interrupt = -1
    """Its number; -1: it has none."""

    def __init__(self, board: "Board") -> None:
        self.board = board

    def handlers(self) -> dict[int, Callable[[int], None]]:
        """What to call for each address."""
        found: dict[int, Callable[[int], None]] = {}
        for full, (address, step) in addresses().items():
            peripheral, register = full.split(".")
            if peripheral != self.name:
                continue
            method = getattr(self, f"on_{register}", None)
            if step == 0:
                # Two names may stand for one register.
                if method or address not in found:
                    found[address] = method or _nothing
                continue
            for number in range(32 if register in ("PIN_CNF", "CHG") else 8):
                if number > 0 and any(
                    address + step * number == a for a, _ in addresses().values()
                ):
                    break
                one = (lambda v, n=number, m=method: m(n, v)) if method else _nothing
                found.setdefault(address + step * number, one)
        return found

    def get(self, register: str, number: int = 0) -> int:
        """The value of a register."""
        return self.board.word(at(f"{self.name}.{register}", number))

    def put(self, register: str, value: int, number: int = 0) -> None:
        """Set a register, as the hardware does."""
        self.board.set_word(at(f"{self.name}.{register}", number), value)

    def event(self, register: str, number: int = 0) -> None:
        """An event happens, which may be an interrupt."""
        address = at(f"{self.name}.{register}", number)
        self.board.set_word(address, 1)
        if self.interrupt >= 0:
            self.board.note_event(self, (address & 0xFFF) - 0x100 >> 2)

    def on_INTENSET(self, value: int) -> None:
        """Enable interrupts."""
        self.board.enabled[self.interrupt] = self.board.enabled.get(self.interrupt, 0) | value

    def on_INTENCLR(self, value: int) -> None:
        """Disable interrupts."""
        self.board.enabled[self.interrupt] = self.board.enabled.get(self.interrupt, 0) & ~value

    def require(self, condition: bool, what: str) -> None:
        """Raise `Violation` unless the condition holds."""
        if not condition:
            raise Violation(f"{self.name}: {what} (at {self.board.meter.address:#x})")

    def buffer(self, pointer: int, size: int) -> bytes:
        """What the peripheral reads from memory."""
        self.check_pointer(pointer, size)
        return self.board.bytes_at(pointer, size)

    def check_pointer(self, pointer: int, size: int) -> None:
        """A peripheral reaches only RAM."""
        inside = RAM[0] <= pointer and pointer + size <= RAM[0] + RAM[1]
        self.require(inside, f"a buffer at {pointer:#x}, outside of RAM")

    def state(self) -> dict[str, Any]:
        """All that it remembers."""
        return deepcopy({k: v for k, v in vars(self).items() if k != "board"})

    def restore(self, state: dict[str, Any]) -> None:
        """Go back to a state."""
        vars(self).update(deepcopy(state))


def _nothing(value: int) -> None:
    pass

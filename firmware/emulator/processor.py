# SPDX-License-Identifier: Apache-2.0
"""A Cortex-M4 with the memory of an nRF52833, and time: one cycle for each instruction.

Time goes on while the processor sleeps or is halted. An event is a time and a method of the board
to call then. The processor runs in slices that end at the next event, so it sees no event late.
"""

import ctypes
import heapq
from typing import Any

import unicorn
from unicorn import arm_const
from unicorn.unicorn_py3 import Uc, UcError
from unicorn.unicorn_py3.unicorn import uclib

from emulator.native import Meter, hooks, near_it_blocks

CYCLES_PER_US = 64
FLASH = (0x00000000, 0x80000)
RAM = (0x20000000, 0x20000)
PERIPHERALS = (0x40000000, 0x30000)
PORTS = (0x50000000, 0x1000)
FICR = (0x10000000, 0x1000)
UICR = (0x10001000, 0x1000)
SYSTEM = (0xE000E000, 0x1000)
_WFI = b"\x30\xbf"
_OFFSET = {0: 0xFFFFF, 1: 0xFFF, 2: 0xFFFFF, 4: 0xFFFFF, 5: 0xFFF, 0xE: 0xFFF}
"""The bits of an address that count within its region, by the upper four bits."""


_WRITE_CALLBACK = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_int, ctypes.c_uint64, ctypes.c_int, ctypes.c_int64,
    ctypes.c_void_p,
)  # fmt: skip


class Violation(Exception):
    """The firmware used a peripheral in a way that the hardware does not permit."""


class Processor:
    """Processor, memory and time; a board derives from it."""

    def __init__(self, flash: bytes) -> None:
        uc = Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        uc.ctl_set_cpu_model(arm_const.UC_CPU_ARM_CORTEX_M4)
        self.uc = uc
        self._words: dict[int, memoryview] = {}
        for base, size in (FLASH, RAM, PERIPHERALS, PORTS, FICR, UICR, SYSTEM):
            # The processor and this program share the memory, which is faster than calls.
            memory = ctypes.create_string_buffer(size)
            uc.mem_map_ptr(base, size, unicorn.UC_PROT_ALL, ctypes.addressof(memory))
            self._words[base >> 28 if base != UICR[0] else -1] = (
                memoryview(memory).cast("B").cast("I")
            )
        self.set_bytes(FLASH[0], b"\xff" * FLASH[1])
        self.set_bytes(UICR[0], b"\xff" * UICR[1])
        self.set_bytes(FLASH[0], flash)
        self.meter = Meter()
        self._near_it = near_it_blocks(flash.ljust(FLASH[1], b"\xff"))
        self.meter.near_it = ctypes.cast(ctypes.c_char_p(self._near_it), ctypes.c_void_p)
        self._add_hooks()
        self.offset = 0  # cycles that passed without an instruction
        self.halt = 0  # cycles for which the processor is about to be halted
        self.is_asleep = True
        self.is_running = False
        self.events: list[tuple[int, int, str, tuple[Any, ...]]] = []
        self.event_number = 0
        self.pc = 0
        self.error: Exception | None = None
        self.fails_at: int | None = None
        """After so many instructions the power fails; None: it stays."""

    def _add_hooks(self) -> None:
        library = hooks()
        library.use(
            *(ctypes.cast(getattr(uclib, name), ctypes.c_void_p)
              for name in ("uc_emu_stop", "uc_reg_read", "uc_reg_write"))
        )  # fmt: skip
        handle = self.uc._uch

        def add(kind: int, callback: Any, begin: int, end: int) -> None:
            number = ctypes.c_size_t()
            status = uclib.uc_hook_add(
                handle, ctypes.byref(number), ctypes.c_int(kind),
                ctypes.cast(callback, ctypes.c_void_p), ctypes.byref(self.meter),
                ctypes.c_uint64(begin), ctypes.c_uint64(end),
            )  # fmt: skip
            if status != unicorn.UC_ERR_OK:
                raise UcError(status)

        # Not by Unicorn's own functions, which take half as long again for each store.
        self._write_callback = _WRITE_CALLBACK(self._on_write)
        for base, size in (PERIPHERALS, PORTS, SYSTEM, FLASH, UICR):
            add(unicorn.UC_HOOK_MEM_WRITE, self._write_callback, base, base + size - 1)
        everywhere = (1, 0)
        add(unicorn.UC_HOOK_CODE, library.on_instruction, *everywhere)
        # The last: it has to run after the others.
        accesses = unicorn.UC_HOOK_MEM_READ | unicorn.UC_HOOK_MEM_WRITE
        add(accesses, library.on_access, *everywhere)

    # --- memory

    def _region(self, address: int) -> memoryview:
        return self._words[-1 if address & 0xFFFFF000 == UICR[0] else address >> 28]

    def word(self, address: int) -> int:
        """The word at an address."""
        return self._region(address)[(address & _OFFSET[address >> 28]) >> 2]

    def set_word(self, address: int, value: int) -> None:
        """Set the word at an address."""
        self._region(address)[(address & _OFFSET[address >> 28]) >> 2] = value & 0xFFFFFFFF

    def bytes_at(self, address: int, size: int) -> bytes:
        """Some bytes of the memory."""
        at = address & _OFFSET[address >> 28]
        return bytes(self._region(address).cast("B")[at : at + size])

    def set_bytes(self, address: int, data: bytes) -> None:
        """Set some bytes of the memory."""
        at = address & _OFFSET[address >> 28]
        self._region(address).cast("B")[at : at + len(data)] = data

    # --- time

    @property
    def now(self) -> int:
        """The time since power-up [cycles]."""
        return self.offset + self.meter.instructions

    def at_time(self, time: int, method: str, *arguments: Any) -> None:
        """Call a method of the board at a time [cycles]."""
        self.event_number += 1
        heapq.heappush(self.events, (time, self.event_number, method, arguments))
        if self.is_running:
            self.meter.limit = min(self.meter.limit, max(0, time - self.offset))

    def in_us(self, delay: float, method: str, *arguments: Any) -> None:
        """Call a method of the board after a delay."""
        self.at_time(self.now + round(delay * CYCLES_PER_US), method, *arguments)

    def cancel(self, method: str) -> None:
        """Forget all calls of a method that are still to come."""
        self.events = [event for event in self.events if event[2] != method]
        heapq.heapify(self.events)

    def halt_for(self, us: float) -> None:
        """Halt the processor after the present instruction, as a write to flash memory does."""
        self.halt += round(us * CYCLES_PER_US)
        self.meter.limit = self.meter.instructions

    # --- running

    def start_at_reset(self) -> None:
        """Start with the stack and the address in the vector table."""
        self.uc.reg_write(arm_const.UC_ARM_REG_SP, self.word(0))
        self.pc = self.word(4)
        self.is_asleep = False

    def run(self, until: int) -> None:
        """Run until a time [cycles].

        Raises:
            Violation: a peripheral was used in a wrong way.
        """
        while self.now < until:
            self._call_due()
            if self.fails_at is not None and self.meter.instructions >= self.fails_at:
                self.fails_at = None
                self.power_fails()
            if self.halt > 0:
                self._pass(min(self.halt, self._until_event(until)), halted=True)
            elif self.is_asleep and not self.wakes():
                self._pass(self._until_event(until))
            else:
                self.is_asleep = False
                self._slice(self._until_event(until))

    def run_us(self, us: float) -> None:
        """Run for a time."""
        self.run(self.now + round(us * CYCLES_PER_US))

    def run_a_little(self, until: int) -> None:
        """Run to the next event, or for some instructions if the processor is busy."""
        sleeps = self.is_asleep and not self.wakes()
        end = self.events[0][0] + 1 if sleeps else self.now + 20 * CYCLES_PER_US
        self.run(min(until, max(self.now + 1, end)))

    def _until_event(self, until: int) -> int:
        end = min(until, self.events[0][0]) if self.events else until
        return max(0, end - self.now)

    def _pass(self, cycles: int, *, halted: bool = False) -> None:
        self.offset += cycles
        if halted:
            self.halt -= cycles
        self._call_due()

    def _call_due(self) -> None:
        while self.events and self.events[0][0] <= self.now:
            _, _, method, arguments = heapq.heappop(self.events)
            getattr(self, method)(*arguments)

    def _slice(self, cycles: int) -> None:
        meter = self.meter
        meter.limit = meter.instructions + cycles
        if self.fails_at is not None:
            meter.limit = min(meter.limit, self.fails_at)
        if cycles == 0:
            return
        self.is_running = True
        try:
            self.uc.emu_start(self.pc | 1, 0xFFFFFFFE)
        except UcError as error:
            self.error = self.error or Violation(f"{error} at {meter.address:#x}")
        finally:
            self.is_running = False
        if self.error is not None:
            raise self.error
        if meter.trespasses:
            raise Violation(f"memory of a peripheral used at {meter.trespassed_by:#x}")
        self.pc = self.uc.reg_read(arm_const.UC_ARM_REG_PC)
        if meter.instructions < meter.limit and self.bytes_at(self.pc - 2, 2) == _WFI:
            self.is_asleep = True
            self.slept()

    def _on_write(
        self, uc: Any, access: int, address: int, size: int, value: int, data: Any
    ) -> None:
        try:
            self.written(address, size, value & 0xFFFFFFFF)
        except Exception as error:  # does not pass through the C code of Unicorn
            self.error = self.error or error
            self.uc.emu_stop()

    # --- what a board adds

    def wakes(self) -> bool:
        """Whether an interrupt is pending that ends the sleep."""
        raise NotImplementedError

    def power_fails(self) -> None:
        """The supply is cut in this instruction."""
        raise NotImplementedError

    def slept(self) -> None:
        """The processor has begun to sleep."""

    def written(self, address: int, size: int, value: int) -> None:
        """The program writes to a peripheral or to flash memory."""
        raise NotImplementedError

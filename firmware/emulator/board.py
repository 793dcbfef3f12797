# SPDX-License-Identifier: Apache-2.0
"""An emulated nRF52833 board: processor, peripherals, pins, and what is connected to them."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection
from intelhex import IntelHex

from emulator.peripherals.analog import Adc, Power, Rng
from emulator.peripherals.outputs import (
    BUTTONS,
    COLUMNS,
    LED_COLUMNS,
    LED_ROWS,
    ROWS,
    Port0,
    Port1,
    Pwm,
)  # fmt: skip
from emulator.peripherals.peripheral import Peripheral
from emulator.peripherals.radio import Radio
from emulator.peripherals.serial import Twi, Uart
from emulator.peripherals.storage import Nvmc
from emulator.peripherals.timing import Clock, Counter, Timer, Watchdog
from emulator.processor import (
    CYCLES_PER_US,
    FLASH,
    PERIPHERALS,
    PORTS,
    RAM,
    SYSTEM,
    UICR,
    Processor,
)
from emulator.registers import at

_ISER, _ICPR = 0xE000E100, 0xE000E280
_AIRCR, _RESTART = 0xE000ED0C, 0x05FA0004
_ANTENNA_PINS = 1 << 9 | 1 << 10
"""Unless a setting of the chip makes them ordinary pins."""
STORAGE = (0x7E000, 0x2000)
_LED_ROW_PINS = sum(1 << row for row in LED_ROWS)
_ROW_PINS = sum(1 << row for row in ROWS)
_ALL_PINS = 0xFFFFFFFF


class PowerFailed(Exception):
    """The supply was cut."""


@dataclass(frozen=True)
class Image:
    """A program for a board, with the places of its variables."""

    flash: bytes
    symbols: dict[str, tuple[int, int]]
    """Address and size of each."""


def load_image(hex_file: Path, elf_file: Path) -> Image:
    """An image as it is flashed, and the symbols of the program from which it was made."""
    flash = IntelHex(str(hex_file)).tobinstr(start=0, size=0x10000)
    with elf_file.open("rb") as stream:
        table = ELFFile(stream).get_section_by_name(".symtab")
        assert isinstance(table, SymbolTableSection)
        symbols = {s.name: (s["st_value"], s["st_size"]) for s in table.iter_symbols()}
    return Image(flash, symbols)


class Board(Processor):
    """A board that can be reset, cut from its supply, and stored.

    Args:
        image: its program.
        seed: of its random numbers.
        clock: how fast its crystal is, 1 for right.
    """

    def __init__(self, image: Image, seed: int = 0, clock: float = 1.0) -> None:
        super().__init__(image.flash)
        self.image, self.seed = image, seed
        self.cycles_per_us = CYCLES_PER_US / clock
        self.enabled: dict[int, int] = {}
        self.pending = self.unmasked = 0
        self.buttons = 0
        self.closed = 0
        self.led_picture = 0
        self.leds_lit = 0
        self.serial_out = b""
        self.torn: tuple[int, int] | None = None
        self.resets: list[str] = []
        """Why the board was reset, except at the wish of its program."""
        self.has_antenna = True
        self.on_send: Callable[[bytes], None] = lambda data: None
        self.can_erase: Callable[[], bool] = lambda: True
        self.nvmc = Nvmc(self)
        self._make_peripherals()
        self._paint_stack()

    def _make_peripherals(self) -> None:
        self.clock, self.timer, self.counter = Clock(self), Timer(self), Counter(self)
        self.watchdog, self.radio, self.pwm = Watchdog(self), Radio(self), Pwm(self)
        self.port0, self.port1 = Port0(self), Port1(self)
        self.uart, self.twi = Uart(self), Twi(self)
        self.adc, self.power, self.rng = Adc(self), Power(self), Rng(self)
        self._plain = [_Plain(self, name) for name in ("APPROTECT", "PPI")]
        self._handlers: dict[int, Callable[[int], None]] = {}
        for peripheral in (*self._peripherals(), *self._plain):
            self._handlers |= peripheral.handlers()
        self.set_word(at("NVMC.READY"), 1)
        self.pins_changed(0, _ALL_PINS)
        self.pins_changed(32, _ALL_PINS)

    def _peripherals(self) -> tuple[Peripheral, ...]:
        return (
            self.clock, self.timer, self.counter, self.watchdog, self.radio, self.pwm, self.port0,
            self.port1, self.uart, self.twi, self.adc, self.power, self.rng, self.nvmc,
        )  # fmt: skip

    # --- interrupts

    def note_event(self, peripheral: Peripheral, bit: int) -> None:
        """An event that may be an interrupt has happened."""
        if self.enabled.get(peripheral.interrupt, 0) >> bit & 1:
            self.pending |= 1 << peripheral.interrupt

    def wakes(self) -> bool:
        """Whether an interrupt is pending that ends the sleep."""
        return self.pending & self.unmasked != 0

    def _clear_pending(self, mask: int) -> None:
        self.pending &= ~mask
        for number, enabled in self.enabled.items():
            if not mask >> number & 1:
                continue
            events = PERIPHERALS[0] + 0x1000 * number + 0x100
            while enabled:
                bit = enabled.bit_length() - 1
                enabled ^= 1 << bit
                if self.word(events + 4 * bit):
                    self.pending |= 1 << number

    # --- what the program writes

    def written(self, address: int, size: int, value: int) -> None:
        """The program writes to a peripheral or to flash memory."""
        handler = self._handlers.get(address)
        if handler is not None:
            handler(value)
        elif Nvmc.covers(address):
            self.nvmc.write(address, size, value)
        elif address == _ISER:
            self.unmasked |= value
        elif address == _ICPR:
            self._clear_pending(value)
        elif address == _AIRCR:
            self.clock.require(value == _RESTART, f"AIRCR is {value:#x}")
            self.in_us(0, "restarts")
        else:
            self.clock.require(False, f"{address:#x} is no register that the board uses")

    # --- memory that a peripheral owns

    def own(self, place: int, begin: int, size: int, *, may_read: bool) -> None:
        """The program must not use this memory for now."""
        self.meter.begin[place], self.meter.end[place] = begin, begin + size
        self.meter.may_read[place] = may_read

    def disown(self, place: int) -> None:
        """The program may use it again."""
        self.meter.begin[place] = self.meter.end[place] = 0

    # --- pins

    def _is_low(self, pin: int) -> bool:
        port = self.port0 if pin < 32 else self.port1
        return (port.driven & ~port.out) >> pin % 32 & 1 == 1

    def is_output(self, pin: int) -> bool:
        """The pin is an output."""
        return (self.port0 if pin < 32 else self.port1).is_driven(pin % 32)

    def pins_changed(self, first: int, mask: int) -> None:
        """Compute what the inputs read, and which LEDs shine."""
        if first == 0 and mask & _LED_ROW_PINS:
            lit = [row for row in range(5) if self.port0.out >> LED_ROWS[row] & 1]
            self.leds_lit = max(self.leds_lit, len(lit))
            for row in lit:
                self.led_picture &= ~(31 << 5 * row)
                for column, pin in enumerate(LED_COLUMNS):
                    if self._is_low(pin):
                        self.led_picture |= 1 << (5 * row + column)
        if not mask & (_ROW_PINS if first == 0 else 0) and mask != _ALL_PINS:
            return  # neither the rows of the switches nor what is connected has changed
        values = [0xFFFFFFFF, 0xFFFFFFFF]
        for row in range(3):
            closed = self.closed >> 3 * row & 7
            if not closed or not self._is_low(ROWS[row]):
                continue
            for column in range(3):
                if closed >> column & 1 and not self._is_antenna(COLUMNS[column]):
                    values[COLUMNS[column] // 32] &= ~(1 << COLUMNS[column] % 32)
        for number, pin in enumerate(BUTTONS):
            if self.buttons >> number & 1:
                values[0] &= ~(1 << pin)
        self.set_word(at("P0.IN"), values[0])
        self.set_word(at("P1.IN"), values[1])

    def _is_antenna(self, pin: int) -> bool:
        return self.has_antenna and pin < 32 and _ANTENNA_PINS >> pin & 1 == 1

    def close_switches(self, closed: int) -> None:
        """Close these switches of the palm and open the others; bit 3 x row + column."""
        self.closed = closed
        self.pins_changed(0, _ALL_PINS)

    def hold_buttons(self, held: int) -> None:
        """Hold these buttons; bit 0 is A, bit 1 is B."""
        self.buttons = held
        self.pins_changed(0, _ALL_PINS)

    # --- radio

    def began_to_send(self, data: bytes) -> None:
        """A packet begins to leave."""
        self.on_send(data)

    def may_erase(self) -> bool:
        """Nothing can move."""
        return self.can_erase()

    # --- resets

    def boot(self) -> None:
        """Start the program."""
        self.has_antenna = self.word(at("UICR.NFCPINS")) & 1 == 1
        self.start_at_reset()

    def reset(self, why: str) -> None:
        """Everything but the flash memory and the settings of the chip forgets its state."""
        if why != "program":
            self.resets.append(why)
        self.events.clear()
        self.halt = 0
        self.is_asleep = True
        self.enabled, self.pending, self.unmasked = {}, 0, 0
        for place in range(len(self.meter.begin)):
            self.disown(place)
        for base, size in (PERIPHERALS, PORTS, SYSTEM):
            self.set_bytes(base, bytes(size))
        if why == "power":  # RAM keeps its content in a reset, which nobody may rely on
            self.set_bytes(RAM[0], bytes(0x2000))
            self._paint_stack()
        self.nvmc.config = 0
        supply = self.adc.supply_mv, self.twi.answers, self.twi.hangs
        self._make_peripherals()
        self.adc.supply_mv, self.twi.answers, self.twi.hangs = supply

    def restarts(self) -> None:
        """The program asks for a reset."""
        self.reset("program")
        self.boot()

    def watchdog_bites(self) -> None:
        """The watchdog resets the board, which starts at once."""
        self.reset("watchdog")
        self.boot()

    def power_fails(self) -> None:
        """The supply is cut in this instruction."""
        if self.halt > 0:  # the processor waits for the flash memory
            self.nvmc.tear()
        raise PowerFailed

    def cut_power(self) -> None:
        """Cut the supply; `boot` starts the board again."""
        if self.torn is not None:
            self.set_word(*self.torn)
            self.torn = None
        self.error = None
        self.nvmc.power_fails_in = None
        self.reset("power")

    # --- measuring

    def _paint_stack(self) -> None:
        self.set_bytes(RAM[0], b"\xa5" * (self.word(0) - RAM[0]))

    @property
    def stack_bytes(self) -> int:
        """How much of the stack has been used since power-up."""
        stack = self.bytes_at(RAM[0], self.word(0) - RAM[0])
        return len(stack.lstrip(b"\xa5"))

    def variable(self, name: str) -> bytes:
        """The content of a variable of the program."""
        return self.bytes_at(*self.image.symbols[name])

    def storage(self) -> bytes:
        """What the pages for permanent data hold."""
        return self.bytes_at(*STORAGE)

    # --- snapshots

    def snapshot(self) -> Any:
        """All that a board is, to go back to."""
        memory = [(base, self.bytes_at(base, size)) for base, size in (
            (RAM[0], 0x2000), PERIPHERALS, PORTS, SYSTEM, STORAGE, UICR)]  # fmt: skip
        own = {n: deepcopy(getattr(self, n)) for n in _OWN}
        states = [peripheral.state() for peripheral in self._peripherals()]
        meter = bytes(self.meter)
        return self.uc.context_save(), memory, own, states, meter

    def restore(self, snapshot: Any) -> None:
        """Go back."""
        context, memory, own, states, meter = snapshot
        self.uc.context_restore(context)
        for base, data in memory:
            self.set_bytes(base, data)
        for name, value in own.items():
            setattr(self, name, deepcopy(value))
        for peripheral, state in zip(self._peripherals(), states, strict=True):
            peripheral.restore(state)
        type(self.meter).from_buffer(self.meter)
        for name, *_ in self.meter._fields_:
            setattr(self.meter, name, getattr(type(self.meter).from_buffer_copy(meter), name))

    # --- events of the peripherals, by the names under which they are scheduled

    def crystal_started(self) -> None:
        """See `Clock`."""
        self.clock.started()

    def timer_match_0(self) -> None:
        """See `Timer`."""
        self.timer.match(0)

    def timer_match_1(self) -> None:
        """See `Timer`."""
        self.timer.match(1)

    def radio_ready(self, to: str) -> None:
        """See `Radio`."""
        self.radio.ready(to)

    def radio_sent(self) -> None:
        """See `Radio`."""
        self.radio.sent()

    def radio_disabled(self) -> None:
        """See `Radio`."""
        self.radio.disabled()

    def widths_read(self) -> None:
        """See `Pwm`."""
        self.disown(1)

    def uart_sent(self, data: bytes) -> None:
        """See `Uart`."""
        self.uart.sent(data)

    def uart_bytes(self) -> None:
        """See `Uart`."""
        self.uart.bytes_have_come()

    def twi_ends(self, data: bytes) -> None:
        """See `Twi`."""
        self.twi.ends(data)

    def adc_measured(self) -> None:
        """See `Adc`."""
        self.adc.measured()

    def random_ready(self) -> None:
        """See `Rng`."""
        self.rng.ready()


_OWN = (
    "offset", "halt", "is_asleep", "events", "event_number", "pc", "enabled", "pending", "unmasked",
    "buttons", "closed", "led_picture", "leds_lit", "has_antenna", "serial_out", "torn", "resets",
)  # fmt: skip


class _Plain(Peripheral):
    """A peripheral that is only memory in the model."""

    def __init__(self, board: Board, name: str) -> None:
        super().__init__(board)
        self.name = name


assert FLASH[0] == 0

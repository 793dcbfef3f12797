# SPDX-License-Identifier: Apache-2.0
"""Clock, timers, watchdog."""

from emulator.peripherals.peripheral import Peripheral
from emulator.processor import CYCLES_PER_US

CRYSTAL_STARTS_US = 360


class Clock(Peripheral):
    """CLOCK: the crystal that the radio needs."""

    name = "CLOCK"

    def __init__(self, board) -> None:
        super().__init__(board)
        self.crystal_runs = False

    def on_TASKS_HFCLKSTART(self, value: int) -> None:
        """Start the crystal."""
        self.board.in_us(CRYSTAL_STARTS_US, "crystal_started")

    def started(self) -> None:
        """The crystal runs."""
        self.crystal_runs = True
        self.event("EVENTS_HFCLKSTARTED")


class Timer(Peripheral):
    """TIMER0: microseconds."""

    name = "TIMER0"
    interrupt = 8

    def __init__(self, board) -> None:
        super().__init__(board)
        self.started_at: int | None = None

    def _is_stopped(self) -> None:
        self.require(self.started_at is None, "configured while it runs")

    def on_MODE(self, value: int) -> None:
        """Configure."""
        self._is_stopped()
        self.require(value == 0, "not in timer mode")

    def on_BITMODE(self, value: int) -> None:
        """Configure."""
        self._is_stopped()

    def on_PRESCALER(self, value: int) -> None:
        """Configure."""
        self._is_stopped()
        self.require(value == 4, "the model counts microseconds only")

    def on_TASKS_START(self, value: int) -> None:
        """Start to count."""
        self.require(self.get("BITMODE") == 3, "started without 32 bits")
        self.require(self.started_at is None, "started twice")
        self.started_at = self.board.now
        for number in (0, 1):
            self._schedule(number, self.get("CC", number))

    @property
    def counter(self) -> int:
        """Microseconds since the start."""
        if self.started_at is None:
            return 0
        return int((self.board.now - self.started_at) / self.board.cycles_per_us)

    def on_TASKS_CAPTURE(self, number: int, value: int) -> None:
        """Take the time."""
        self.put("CC", self.counter & 0xFFFFFFFF, number)

    def on_CC(self, number: int, value: int) -> None:
        """Set a compare value."""
        if number < 2 and self.started_at is not None:
            self._schedule(number, value)

    def _schedule(self, number: int, value: int) -> None:
        method = f"timer_match_{number}"
        self.board.cancel(method)
        wait = (value - self.counter) & 0xFFFFFFFF or 1 << 32
        assert self.started_at is not None
        time = self.started_at + (self.counter + wait) * self.board.cycles_per_us
        self.board.at_time(-int(-time // 1), method)

    def match(self, number: int) -> None:
        """The counter has reached a compare value."""
        self.event("EVENTS_COMPARE", number)
        assert self.started_at is not None
        self._schedule(number, self.get("CC", number))


class Counter(Peripheral):
    """TIMER1: counts events that PPI passes on."""

    name = "TIMER1"

    def __init__(self, board) -> None:
        super().__init__(board)
        self.count = 0
        self.runs = False

    def on_TASKS_START(self, value: int) -> None:
        """Start to count."""
        self.require(self.get("MODE") == 2, "started without counter mode")
        self.runs = True

    def on_TASKS_CLEAR(self, value: int) -> None:
        """Begin at 0."""
        self.count = 0

    def on_TASKS_CAPTURE(self, number: int, value: int) -> None:
        """Take the count."""
        self.board.uart.catch_up()
        self.put("CC", self.count, number)

    def count_event(self) -> None:
        """An event to count."""
        self.count += self.runs


class Watchdog(Peripheral):
    """WDT: resets the board unless it is fed in time."""

    name = "WDT"

    def __init__(self, board) -> None:
        super().__init__(board)
        self.runs = False
        self.fed_by: set[int] = set()
        self.feeds = 0

    def _is_stopped(self) -> None:
        self.require(not self.runs, "configured while it runs")

    def on_CRV(self, value: int) -> None:
        """Configure."""
        self._is_stopped()

    def on_RREN(self, value: int) -> None:
        """Configure."""
        self._is_stopped()

    def on_CONFIG(self, value: int) -> None:
        """Configure."""
        self._is_stopped()
        self.require(value & 1 == 1, "it would stop in sleep")

    def on_TASKS_START(self, value: int) -> None:
        """Start."""
        self.require(self.get("RREN") == 1, "started without a way to feed it")
        self.runs = True
        self._schedule()

    def on_RR(self, number: int, value: int) -> None:
        """Feed it."""
        self.require(self.runs and number == 0, "fed before it runs")
        self.require(value == 0x6E524635, "fed with a wrong value")
        self.fed_by.add(self.board.meter.address)
        self.feeds += 1
        self._schedule()

    def _schedule(self) -> None:
        self.board.cancel("watchdog_bites")
        steps = self.get("CRV") + 1
        self.board.at_time(
            self.board.now + round(steps / 32768 * 1e6 * CYCLES_PER_US), "watchdog_bites"
        )

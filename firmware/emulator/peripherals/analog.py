# SPDX-License-Identifier: Apache-2.0
"""Supply voltage and random numbers."""

import random

from emulator.peripherals.peripheral import Peripheral

FULL_SCALE_MV = 3600


class Adc(Peripheral):
    """SAADC: measures the supply."""

    name = "SAADC"

    def __init__(self, board) -> None:
        super().__init__(board)
        self.supply_mv = 3300
        self.is_started = False

    def on_TASKS_START(self, value: int) -> None:
        """Take the address of the result."""
        self.require(self.get("ENABLE") == 1, "started while it is disabled")
        self.check_pointer(self.get("RESULT_PTR"), 2)
        self.is_started = True
        self.event("EVENTS_STARTED")

    def on_TASKS_SAMPLE(self, value: int) -> None:
        """Measure."""
        self.require(self.is_started, "measures before it is started")
        self.board.in_us(12, "adc_measured")

    def measured(self) -> None:
        """A result is there."""
        self.is_started = False
        reading = min(4095, round(self.supply_mv * 4096 / FULL_SCALE_MV))
        self.board.set_bytes(self.get("RESULT_PTR"), reading.to_bytes(2, "little"))
        self.event("EVENTS_END")


class Power(Peripheral):
    """POWER: notices when the supply breaks down."""

    name = "POWER"
    interrupt = 0

    def breaks_down(self) -> None:
        """The supply is below the threshold for a moment."""
        if self.get("POFCON") & 1:
            self.event("EVENTS_POFWARN")


class Rng(Peripheral):
    """RNG: random bytes, from a seed."""

    name = "RNG"

    def __init__(self, board) -> None:
        super().__init__(board)
        self.chance = random.Random(board.seed)
        self.runs = False

    def on_TASKS_START(self, value: int) -> None:
        """Start."""
        self.runs = True
        self.board.in_us(30, "random_ready")

    def on_TASKS_STOP(self, value: int) -> None:
        """Stop."""
        self.runs = False

    def ready(self) -> None:
        """A byte is there."""
        if not self.runs:
            return
        self.put("VALUE", self.chance.randrange(256))
        self.event("EVENTS_VALRDY")
        self.board.in_us(30, "random_ready")

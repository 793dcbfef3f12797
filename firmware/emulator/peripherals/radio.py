# SPDX-License-Identifier: Apache-2.0
"""RADIO: one antenna, half duplex, packets in a buffer of the program."""

from emulator.peripherals.peripheral import Peripheral

RAMP_US = 140.0
TURN_OFF_US = 6.0
US_PER_BYTE = 8.0
AROUND = 1 + 5 + 1 + 3
"""Bytes of preamble, address, length and checksum."""
OWNED = 0
"""The range of memory that the radio owns, among those of the meter."""


def airtime_us(size: int) -> float:
    """How long a packet with so many bytes of content is on the air."""
    return (AROUND + size) * US_PER_BYTE


class Radio(Peripheral):
    """The states are those of the hardware."""

    name = "RADIO"
    interrupt = 1

    def __init__(self, board) -> None:
        super().__init__(board)
        self.mode = "disabled"
        self.pointer = 0
        self.configured: set[str] = set()
        self.sent_packets = 0

    def _config(self, register: str) -> None:
        self.require(self.mode == "disabled", f"{register} changed in mode {self.mode}")
        self.configured.add(register)

    def on_MODE(self, value: int) -> None:
        """Configure."""
        self._config("MODE")

    def on_FREQUENCY(self, value: int) -> None:
        """Configure."""
        self._config("FREQUENCY")
        self.require(value <= 100, f"channel {value}")

    def on_TXPOWER(self, value: int) -> None:
        """Configure."""
        self._config("TXPOWER")
        power = (value & 0xFF) - (0x100 if value & 0x80 else 0)
        allowed = (*range(2, 9), 0, -4, -8, -12, -16, -20, -40)
        self.require(power in allowed, f"a power of {power} dBm")

    def on_PCNF0(self, value: int) -> None:
        """Configure."""
        self._config("PCNF0")

    def on_PCNF1(self, value: int) -> None:
        """Configure."""
        self._config("PCNF1")

    def on_CRCCNF(self, value: int) -> None:
        """Configure."""
        self._config("CRCCNF")

    def on_CRCPOLY(self, value: int) -> None:
        """Configure."""
        self._config("CRCPOLY")

    def on_PACKETPTR(self, value: int) -> None:
        """Set the buffer of the next packet."""
        self.require(self.mode != "tx", "the buffer changed while it is sent")

    def on_SHORTS(self, value: int) -> None:
        """Connect events and tasks."""
        self.require(value & ~0b11 == 0, f"shorts {value:#x} are not in the model")

    def _ramp(self, to: str) -> None:
        self.require(self.mode == "disabled", f"enabled in mode {self.mode}")
        self.require(self.board.clock.crystal_runs, "enabled without the crystal")
        needed = {"MODE", "FREQUENCY", "TXPOWER", "PCNF0", "PCNF1", "CRCCNF", "CRCPOLY"}
        self.require(self.configured >= needed, "enabled without configuration")
        self.mode = to + "ru"
        self.board.in_us(RAMP_US, "radio_ready", to)

    def on_TASKS_RXEN(self, value: int) -> None:
        """Begin to listen."""
        self._ramp("rx")

    def on_TASKS_TXEN(self, value: int) -> None:
        """Begin to send."""
        self._ramp("tx")

    def ready(self, to: str) -> None:
        """The ramp is over."""
        self.event("EVENTS_READY")
        self.mode = to + "idle"
        if self.get("SHORTS") & 1:
            self._start()

    def on_TASKS_START(self, value: int) -> None:
        """Listen, or send."""
        self.require(self.mode in ("rxidle", "txidle"), f"started in mode {self.mode}")
        self._start()

    def _start(self) -> None:
        self.mode = self.mode.removesuffix("idle")
        self.pointer = self.get("PACKETPTR")
        size = 1 + (self.get("PCNF1") & 0xFF)
        self.check_pointer(self.pointer, size)
        self.board.own(OWNED, self.pointer, size, may_read=self.mode == "tx")
        if self.mode == "tx":
            length = self.buffer(self.pointer, 1)[0]
            self.require(length < size, f"a packet of {length} bytes")
            self.board.in_us(airtime_us(length), "radio_sent")
            self.board.began_to_send(self.buffer(self.pointer + 1, length))

    def sent(self) -> None:
        """A packet has left."""
        self.mode = "txidle"
        self.sent_packets += 1
        self.board.disown(OWNED)
        self.event("EVENTS_END")
        if self.get("SHORTS") & 2:
            self._disable()

    def on_TASKS_DISABLE(self, value: int) -> None:
        """End what it does."""
        self._disable()

    def _disable(self) -> None:
        if self.mode == "disabled":
            return
        for method in ("radio_ready", "radio_sent", "radio_disabled"):
            self.board.cancel(method)
        self.board.disown(OWNED)
        self.mode = "txdisable"
        self.board.in_us(TURN_OFF_US, "radio_disabled")

    def disabled(self) -> None:
        """It is off."""
        self.mode = "disabled"
        self.event("EVENTS_DISABLED")

    @property
    def listens(self) -> bool:
        """A packet that begins now would be received."""
        return self.mode == "rx"

    def receive(self, data: bytes, crc_ok: bool = True) -> None:
        """A packet has arrived as a whole."""
        self.fill_buffer(bytes([len(data)]) + data, crc_ok)

    def fill_buffer(self, content: bytes, crc_ok: bool = True) -> None:
        """A packet has arrived: its length and its bytes, which may be damaged, in the buffer."""
        assert self.listens
        most = self.get("PCNF1") & 0xFF
        self.board.set_bytes(self.pointer, content[: 1 + most])
        self.put("CRCSTATUS", int(crc_ok))
        self.mode = "rxidle"
        self.board.disown(OWNED)
        self.event("EVENTS_END")

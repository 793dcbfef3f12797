# SPDX-License-Identifier: Apache-2.0
"""Frames on a serial line, of radio bridges and motor boards (docs/reference/wire.md)."""

from typing import Any, Literal, NamedTuple, TypeAlias

import palmbots._core as _core
from palmbots.errors import PalmbotsError

FrameKind = Literal[
    "packet", "bridge_report", "board_hello", "board_identity", "board_command", "board_reading"
]
FRAME_NUMBERS: dict[FrameKind, int] = dict(_core.serial.kinds)
"""The first byte of a frame of each kind."""
MAX_CONTENT: int = _core.serial.max_content
"""Greatest size of the content of a frame [bytes]."""
BOARD_VERSION: int = _core.serial.board_version
"""Version of the commands and readings of a motor board."""


class BridgeReport(NamedTuple):
    """What a radio bridge has done since its boot; all counts are modulo 2³²."""

    sent: int = 0
    """Packets from the serial line that the radio has sent."""
    received: int = 0
    """Packets from the radio that were written to the serial line."""
    radio_full: int = 0
    """Dropped packets from the serial line: the radio was busy for too long."""
    serial_full: int = 0
    """Dropped packets from the radio: the serial line was busy for too long."""
    radio_damaged: int = 0
    """Dropped packets from the radio with a wrong checksum."""
    serial_damaged: int = 0
    """Dropped frames from the serial line that were damaged or of an unknown kind."""


class BoardIdentity(NamedTuple):
    """What a motor board is."""

    version: int = BOARD_VERSION
    has_encoders: bool = False
    measures_palm: bool = False
    measures_battery: bool = False
    switches: int = 0
    """Number of switches on the palm, at most 16."""
    longest_watchdog_ms: int = 0
    """A command may ask for at most this time."""


class BoardCommand(NamedTuple):
    """A command to a motor board."""

    number: int
    """Number of the command, modulo 256."""
    wheels: bool
    """The wheels may turn; if false they stop at once."""
    palm: bool
    """The palm is to go to `palm_angle`; if false it keeps its angle."""
    watchdog_ms: int
    """The board stops the wheels when no further command arrives within this time; at least 1."""
    left_speed: int = 0
    """Of the left wheel [mrad/s]; > 0: the robot drives forward."""
    right_speed: int = 0
    """Of the right wheel [mrad/s]."""
    palm_angle: int = 0
    """Of the servo of the palm [mrad]."""


class BoardReading(NamedTuple):
    """What a motor board senses."""

    number: int = 0
    """Number of the newest command that has arrived."""
    watchdog_acts: bool = False
    """The board has stopped the wheels because no command came in time."""
    time_ms: int = 0
    """Of the board's clock, modulo 65536."""
    switches: int = 0
    """Bit i: switch i is pressed."""
    palm_angle: int = 0
    """Of the servo of the palm [mrad]; 0 if it is not measured."""
    left_count: int = 0
    """Of the left encoder, signed, modulo 2³²; 0 if there is none."""
    right_count: int = 0
    """Of the right encoder."""
    battery_mv: int = 0
    """Voltage of the battery; 0 if it is not measured."""
    damaged: int = 0
    """Frames that the board has dropped, modulo 65536."""


Content: TypeAlias = BridgeReport | BoardIdentity | BoardCommand | BoardReading
_WRITERS: dict[type[Content], tuple[FrameKind, Any]] = {
    BridgeReport: ("bridge_report", _core.serial.bridge_report),
    BoardIdentity: ("board_identity", _core.serial.board_identity),
    BoardCommand: ("board_command", _core.serial.board_command),
    BoardReading: ("board_reading", _core.serial.board_reading),
}
_READERS: dict[int, tuple[Any, Any]] = {
    FRAME_NUMBERS["bridge_report"]: (BridgeReport, _core.serial.bridge_report_in),
    FRAME_NUMBERS["board_identity"]: (BoardIdentity, _core.serial.board_identity_in),
    FRAME_NUMBERS["board_command"]: (BoardCommand, _core.serial.board_command_in),
    FRAME_NUMBERS["board_reading"]: (BoardReading, _core.serial.board_reading_in),
}


def encode_frame(kind: FrameKind, content: bytes = b"") -> bytes:
    """A frame with its final zero.

    Raises:
        PalmbotsError: the content is longer than `MAX_CONTENT`.
    """
    encoded = _core.serial.encode(FRAME_NUMBERS[kind], content)
    if encoded is None:
        raise PalmbotsError(f"frame: has {len(content)} bytes; allowed: at most {MAX_CONTENT}")
    return encoded


def frame_of(content: Content) -> bytes:
    """The frame of a report, an identity, a command or a reading.

    Raises:
        PalmbotsError: a number does not fit into its field.
    """
    kind, write = _WRITERS[type(content)]
    try:
        written = write(*content)
    except TypeError:
        raise PalmbotsError(f"{kind}: a number in {content} does not fit into its field") from None
    return encode_frame(kind, written)


def content_of(kind: int, content: bytes) -> Content | None:
    """The content of a frame that `FrameDecoder` has found; None: malformed, or another kind."""
    if kind not in _READERS:
        return None
    make, read = _READERS[kind]
    fields = read(content)
    return None if fields is None else make(*fields)


class FrameDecoder:
    """Finds frames in the bytes of a serial line."""

    def __init__(self) -> None:
        self._core = _core.serial.Decoder()

    def take(self, data: bytes) -> list[tuple[int, bytes]]:
        """The frames that these bytes complete: the number of the kind, and the content."""
        return self._core.take(data)

    @property
    def damaged(self) -> int:
        """Byte sequences between two zeros that were no frame, so far."""
        return self._core.damaged

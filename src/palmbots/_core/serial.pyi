"""Frames on a serial line."""



kinds: tuple = ...

max_content: int = 64

board_version: int = 1

def encode(kind: int, content: bytes) -> bytes | None:
    """A frame with its final zero; None: too long."""

class Decoder:
    """Finds frames in the bytes of a serial line."""

    def __init__(self) -> None: ...

    def take(self, bytes: bytes) -> list[tuple[int, bytes]]:
        """The frames that these bytes complete: kind and content."""

    @property
    def frames(self) -> int:
        """Frames so far."""

    @property
    def damaged(self) -> int:
        """Byte sequences between two zeros that were no frame."""

def bridge_report(sent: int, received: int, radio_full: int, serial_full: int, radio_damaged: int, serial_damaged: int) -> bytes:
    """The content of a bridge's report."""

def bridge_report_in(content: bytes) -> tuple[int, int, int, int, int, int] | None:
    """A bridge's report, in the order of `bridge_report`; None: malformed."""

def board_identity(version: int, has_encoders: bool, measures_palm: bool, measures_battery: bool, switches: int, longest_watchdog: int) -> bytes:
    """The content of a motor board's identity."""

def board_identity_in(content: bytes) -> tuple[int, bool, bool, bool, int, int] | None:
    """An identity, in the order of `board_identity`; None: malformed."""

def board_command(number: int, wheels: bool, palm: bool, watchdog: int, left_speed: int, right_speed: int, palm_angle: int) -> bytes:
    """The content of a command to a motor board."""

def board_command_in(content: bytes) -> tuple[int, bool, bool, int, int, int, int] | None:
    """A command, in the order of `board_command`; None: malformed."""

def board_reading(number: int, watchdog_acts: bool, time: int, switches: int, palm_angle: int, left_count: int, right_count: int, battery: int, damaged: int) -> bytes:
    """The content of a motor board's reading."""

def board_reading_in(content: bytes) -> tuple[int, bool, int, int, int, int, int, int, int] | None:
    """A reading, in the order of `board_reading`; None: malformed."""

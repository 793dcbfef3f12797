"""Packets, and one end of the wire."""



packet_kinds: tuple = ...

roles: tuple = ('left', 'right', 'station')

verdicts: tuple = ...

def layout() -> list[tuple[str, int, int]]:
    """The fields of a packet: name, offset and size [bytes]."""

def encode(key: bytes, kind: int, sender: int, receiver: int, pair: int, sent: tuple[int, int], heard: tuple[int, int], payload: int) -> bytes | None:
    """The bytes of a packet, or None if it is not well formed."""

def decode(bytes: bytes, key: bytes, pair: int, receiver: int) -> tuple[str, tuple[int, int, int, int, tuple[int, int], tuple[int, int], int]]:
    """
    The verdict on some bytes, and the fields, all 0 unless accepted: kind, sender, receiver, pair, (epoch, sequence) sent and heard, payload.
    """

def report(sign: int, palm: int, palm_at_target: bool) -> int:
    """The payload of a report."""

def report_of(payload: int) -> tuple[int, int, bool]:
    """A report: sign, palm, palm at target."""

def beacon(letter: str, stopped: bool, ready: bool) -> int:
    """The payload of a beacon."""

def beacon_of(payload: int) -> tuple[str, bool, bool]:
    """A beacon: letter, stopped, ready."""

def command(palm: int, move: int) -> int:
    """The payload of a command."""

def command_of(payload: int) -> tuple[int, int]:
    """A command: palm, move."""

def sign(sign: int, palm: int) -> int:
    """The payload of a sign."""

def sign_of(payload: int) -> tuple[int, int]:
    """A sign: sign, palm."""

class Endpoint:
    """One end of the wire."""

    def __init__(self, key: bytes, pair: int, role: int, epoch: int) -> None: ...

    def send(self, receiver: int, kind: int, payload: int) -> bytes | None:
        """The next packet, or None if it is not well formed."""

    def receive(self, bytes: bytes) -> tuple[str, tuple[int, int, int, int, tuple[int, int], tuple[int, int], int]]:
        """The verdict and the fields, as decode."""

    @property
    def counts(self) -> list[tuple[str, int]]: ...

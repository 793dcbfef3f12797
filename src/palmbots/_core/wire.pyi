"""Packets, and one end of the wire."""



packet_kinds: tuple = ...

roles: tuple = ('left', 'right', 'station')

verdicts: tuple = ...

languages: tuple = ('none', 'messages', 'beacons', 'signs')

words: tuple = ...

robot_modes: tuple = ...

fault_codes: tuple = ...

operations: tuple = ...

status_numbers: tuple = ('progress', 'battery', 'overruns', 'sent')

cases: str = ' abcd12345678'

def layout() -> list[tuple[str, int, int]]:
    """The fields of a packet: name, offset and size [bytes]."""

def encode(key: bytes, kind: int, sender: int, receiver: int, pair: int, sent: tuple[int, int], heard: tuple[int, int], payload: bytes) -> bytes | None:
    """The bytes of a packet, or None if it is not well formed."""

def decode(bytes: bytes, key: bytes, pair: int, receiver: int) -> tuple[str, tuple[int, int, int, int, tuple[int, int], tuple[int, int], bytes]]:
    """
    The verdict on some bytes, and the fields, all 0 unless accepted: kind, sender, receiver, pair, (epoch, sequence) sent and heard, payload.
    """

def hello(settings: int, stop: bool) -> bytes:
    """The payload of a hello."""

def hello_of(payload: bytes) -> tuple[int, bool]:
    """A hello: settings, stop."""

def state(language: int, word: int, mode: int, ready: bool, at_rest: bool, stop: bool) -> bytes:
    """The payload of a state."""

def state_of(payload: bytes) -> tuple[int, int, int, bool, bool, bool]:
    """A state: language, word, mode, ready, at rest, stop."""

def status(mode: int, fault: int, sign: int, palm: int, palm_at_target: bool, activity: str, item: int, value: int, ready: bool, at_rest: bool, stop: bool) -> bytes:
    """The payload of a status."""

def status_of(payload: bytes) -> tuple[int, int, int, int, bool, str, int, int, bool, bool, bool]:
    """
    A status: mode, fault, sign, palm, palm at target, case, item, value, ready, at rest, stop.
    """

def operate(operation: int, stop: bool) -> bytes:
    """The payload of a wish of the operator."""

def operate_of(payload: bytes) -> tuple[int, bool]:
    """A wish of the operator: operation, stop."""

def report(sign: int, palm: int, palm_at_target: bool, stop: bool) -> bytes:
    """The payload of a report."""

def report_of(payload: bytes) -> tuple[int, int, bool, bool]:
    """A report: sign, palm, palm at target, stop."""

def command(palm: int, move: int, stop: bool) -> bytes:
    """The payload of a command."""

def command_of(payload: bytes) -> tuple[int, int, bool]:
    """A command: palm, move, stop."""

class Endpoint:
    """One end of the wire."""

    def __init__(self, key: bytes, pair: int, role: int, epoch: int) -> None: ...

    def send(self, receiver: int, kind: int, payload: bytes) -> bytes | None:
        """The next packet, or None if it is not well formed."""

    def receive(self, bytes: bytes) -> tuple[str, tuple[int, int, int, int, tuple[int, int], tuple[int, int], bytes]]:
        """The verdict and the fields, as decode."""

    def skip_to(self, receiver: int, sequence: int) -> None:
        """
        The next packet to this receiver gets this sequence number, unless it has been used.
        """

    def claimed_epoch(self, other: int) -> int:
        """The highest epoch of this end that the other end has named."""

    @property
    def counts(self) -> list[tuple[str, int]]: ...

"""The wire from Python: the packets that robots and station send each other, by the shipped core.

A packet has 28 bytes (docs/wire.md says what each of them is). ``encode`` and ``decode`` turn one
into bytes and back; an ``Endpoint`` is what a robot or the station keeps between packets, and tells
new packets from old ones.

>>> from palmbots import wire
>>> left = wire.Endpoint(key=bytes(16), pair=7, role="left", epoch=1)
>>> right = wire.Endpoint(key=bytes(16), pair=7, role="right", epoch=1)
>>> right.receive(left.send("right")).verdict  # the first packet after a boot only introduces
'unanswered'
>>> left.receive(right.send("left", "TiltUp")).packet.body
'TiltUp'
"""

from dataclasses import dataclass
from typing import Literal, get_args

from palmbots import _core
from palmbots.controllers import Letter, Move, Palm
from palmbots.errors import PalmbotsError, show

__all__ = [
    "KEY_SIZE",
    "MAX_EPOCH",
    "MAX_SEQUENCE",
    "PACKET_SIZE",
    "Beacon",
    "Body",
    "Command",
    "Decoded",
    "Endpoint",
    "Kind",
    "Packet",
    "Report",
    "Role",
    "Verdict",
    "decode",
    "encode",
]

PACKET_SIZE = sum(size for _, _, size in _core.wire_layout())
"""Bytes of a packet."""
KEY_SIZE = 16
"""Bytes of a pair's key."""
MAX_EPOCH = 2**24 - 1
"""The last epoch."""
MAX_SEQUENCE = 2**32 - 1
"""The last packet of an epoch."""

Role = Literal["left", "right", "station"]
Kind = Literal["hello", "letter", "beacon", "report", "command"]
Verdict = Literal[
    "accepted",
    "other_version",
    "too_short",
    "too_long",
    "stranger",
    "misdirected",
    "forged",
    "malformed",
    "stale",
    "unanswered",
]

_ROLES: tuple[Role, ...] = get_args(Role)
_KINDS: tuple[Kind, ...] = get_args(Kind)
_VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
_LETTERS: tuple[Letter, ...] = get_args(Letter)  # as payload: 1, 2, 3
_BEACONS = ("I", "R", "G", "D", "W")
_PALMS: tuple[Palm, ...] = get_args(Palm)
_MOVES: tuple[Move, ...] = get_args(Move)
_Fields = tuple[int, int, int, int, tuple[int, int], tuple[int, int], int]
_SIGNS: tuple[Literal[-1, 0, 1], ...] = (-1, 0, 1)


@dataclass(frozen=True, slots=True)
class Beacon:
    """What a robot says all the time in the resilient algorithm."""

    letter: Literal["I", "R", "G", "D", "W"]
    rests: bool = False
    """The robot does not travel."""
    ready: bool = False
    """Nothing keeps the robot from travelling."""


@dataclass(frozen=True, slots=True)
class Report:
    """What a robot tells the station."""

    sign: Literal[-1, 0, 1]
    """Tactile sign of the contact coordinate p; p > 0 is outward."""
    palm: Palm
    """The angle the palm was last commanded to …"""
    turned: bool
    """… and whether it is there."""


@dataclass(frozen=True, slots=True)
class Command:
    """What the station tells a robot."""

    palm: Palm
    move: Move


Body = Letter | Beacon | Report | Command | None
"""What a packet says: a letter of the distributed algorithm, a beacon of the resilient one, a
report or a command of the centralized one, or nothing but hello."""


@dataclass(frozen=True, slots=True)
class Packet:
    """One packet, without its tag."""

    sender: Role
    receiver: Role
    pair: int
    """Identity of the pair, 0 to 65535."""
    epoch: int
    """The sender's boots so far, 1 to ``MAX_EPOCH``."""
    sequence: int
    """The packets it has sent in this epoch, this one included, 1 to ``MAX_SEQUENCE``."""
    heard: tuple[int, int] = (0, 0)
    """Epoch and sequence of the newest packet from the receiver that the sender had heard since its
    boot; (0, 0): none."""
    body: Body = None

    @property
    def kind(self) -> Kind:
        """What sort of thing the packet says."""
        return _KINDS[_payload(self.body)[0]]


@dataclass(frozen=True, slots=True)
class Decoded:
    """What became of some bytes."""

    verdict: Verdict
    packet: Packet | None
    """The packet, if it was accepted."""


def encode(packet: Packet, key: bytes) -> bytes:
    """The packet's bytes, tagged with the key of the pair.

    Raises:
        PalmbotsError: a field is out of range, or such a sender does not say such a thing to such a
            receiver.
    """
    _check_key(key)
    kind, payload = _payload(packet.body)
    _check_talk(packet.sender, packet.receiver, _KINDS[kind])
    encoded = _core.wire_encode(
        key,
        kind,
        _ROLES.index(packet.sender),
        _ROLES.index(packet.receiver),
        _whole("pair", packet.pair, 0, 0xFFFF),
        _stamp("", (packet.epoch, packet.sequence)),
        packet.heard if packet.heard == (0, 0) else _stamp("heard ", packet.heard),
        payload,
    )
    assert encoded is not None  # all that the core refuses has been refused with a reason
    return encoded


def decode(data: bytes, key: bytes, pair: int, receiver: Role) -> Decoded:
    """What a receiver of a pair makes of some bytes, whether new or not.

    Raises:
        PalmbotsError: key, pair or receiver is none. Bytes that are no packet raise nothing: the
            verdict says why.
    """
    _check_key(key)
    role = _index("receiver", _ROLES, receiver)
    return _decoded(*_core.wire_decode(data, key, _whole("pair", pair, 0, 0xFFFF), role))


class Endpoint:
    """One end of the wire: numbers what it sends, and accepts from the others only what is new.

    A packet is accepted if it decodes, is newer than all before it from the same sender, and was
    sent after the sender had heard this end in its present epoch. `epoch` counts this end's boots
    and must be higher at each of them.
    """

    def __init__(self, key: bytes, pair: int, role: Role, epoch: int) -> None:
        _check_key(key)
        self._role: Role = role
        self._core = _core.WireEndpoint(
            key,
            _whole("pair", pair, 0, 0xFFFF),
            _index("role", _ROLES, role),
            _whole("epoch", epoch, 1, MAX_EPOCH),
        )

    def send(self, receiver: Role, body: Body = None) -> bytes:
        """The next packet.

        Raises:
            PalmbotsError: this end does not say such a thing to such a receiver, or has used up its
                numbers and must enter its next epoch.
        """
        kind, payload = _payload(body)
        _check_talk(self._role, receiver, _KINDS[kind])
        sent = self._core.send(_ROLES.index(receiver), kind, payload)
        if sent is None:
            raise PalmbotsError(
                f"sequence: all {MAX_SEQUENCE} are used up; needed: an Endpoint with the next epoch"
            )
        return sent

    def receive(self, data: bytes) -> Decoded:
        """What becomes of some bytes; counted in any case."""
        return _decoded(*self._core.receive(data))

    @property
    def counts(self) -> dict[Verdict, int]:
        """How many packets got each verdict."""
        return dict(zip(_VERDICTS, (count for _, count in self._core.counts), strict=True))


def _payload(body: Body) -> tuple[int, int]:
    """Kind and payload, in numbers."""
    match body:
        case None:
            return 0, 0
        case Report():
            sign = _SIGNS[_index("sign", _SIGNS, body.sign)]
            return 3, _core.wire_report(sign, _index("palm", _PALMS, body.palm), bool(body.turned))
        case Command():
            palm, move = _index("palm", _PALMS, body.palm), _index("move", _MOVES, body.move)
            return 4, _core.wire_command(palm, move)
        case Beacon():
            _index("letter of a beacon", _BEACONS, body.letter)
            return 2, _core.wire_beacon(body.letter, bool(body.rests), bool(body.ready))
        case _:
            return 1, 1 + _index(
                "body", _LETTERS, body, also=", or a Beacon, Report, Command or None"
            )


def _body(kind: int, payload: int) -> Body:
    """What a payload of an accepted packet means."""
    match _KINDS[kind]:
        case "hello":
            return None
        case "letter":
            return _LETTERS[payload - 1]
        case "beacon":
            letter, rests, ready = _core.wire_beacon_of(payload)
            return Beacon(letter, rests, ready)  # type: ignore[arg-type]
        case "report":
            sign, palm, turned = _core.wire_report_of(payload)
            return Report(_SIGNS[sign + 1], _PALMS[palm], turned)
        case "command":
            palm, move = _core.wire_command_of(payload)
            return Command(_PALMS[palm], _MOVES[move])


def _decoded(verdict: str, fields: _Fields) -> Decoded:
    known = _VERDICTS[_VERDICTS.index(verdict)]
    if known != "accepted":
        return Decoded(known, None)
    kind, sender, receiver, pair, (epoch, sequence), heard, payload = fields
    packet = Packet(
        _ROLES[sender], _ROLES[receiver], pair, epoch, sequence, heard, _body(kind, payload)
    )
    return Decoded(known, packet)


def _check_key(key: bytes) -> None:
    if not isinstance(key, bytes) or len(key) != KEY_SIZE:
        raise PalmbotsError(f"key: is not {KEY_SIZE} bytes; allowed: bytes of length {KEY_SIZE}")


def _check_talk(sender: Role, receiver: Role, kind: Kind) -> None:
    """Whether one says such a thing to the other."""
    _index("sender", _ROLES, sender)
    to: tuple[Role, ...] = tuple(role for role in _ROLES if role != sender)
    match kind:
        case "letter" | "beacon":
            _index("sender of a " + kind, ("left", "right"), sender)
            to = tuple(role for role in to if role != "station")
        case "report":
            _index("sender of a report", ("left", "right"), sender)
            to = ("station",)
        case "command":
            _index("sender of a command", ("station",), sender)
        case "hello":
            pass
    _index("receiver", to, receiver)


def _index(what: str, legal: tuple[object, ...], value: object, also: str = "") -> int:
    if type(value) in (str, int) and value in legal:
        return legal.index(value)
    allowed = ", ".join(show(one) for one in legal) + also
    raise PalmbotsError(f"{what}: value is {_shown(value)}; allowed: {allowed}")


def _whole(what: str, value: int, least: int, most: int) -> int:
    if type(value) is int and least <= value <= most:
        return value
    raise PalmbotsError(f"{what}: value is {_shown(value)}; allowed: {least} to {most}")


def _stamp(what: str, stamp: tuple[int, int]) -> tuple[int, int]:
    epoch, sequence = stamp
    return (
        _whole(what + "epoch", epoch, 1, MAX_EPOCH),
        _whole(what + "sequence", sequence, 1, MAX_SEQUENCE),
    )


def _shown(value: object) -> str:
    return "None" if value is None else show(value)

# SPDX-License-Identifier: Apache-2.0
"""Packets and endpoints: what robots and station send each other, computed by the compiled core.

A packet has 28 bytes; docs/reference/wire.md describes each of them. `encode` and `decode` convert
a packet to bytes and back. An `Endpoint` keeps what a robot or the station must remember between
packets, and distinguishes new packets from old ones.

>>> from palmbots import wire
>>> left = wire.Endpoint(key=bytes(16), pair=7, role="left", epoch=1)
>>> right = wire.Endpoint(key=bytes(16), pair=7, role="right", epoch=1)
>>> right.receive(left.send("right")).verdict  # the first packet after a boot opens the session
'no_session'
>>> left.receive(right.send("left", "TiltUp")).packet.body
'TiltUp'
"""

from dataclasses import dataclass
from typing import Literal

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.arguments import show
from palmbots._util.renamed_names import RenamedKeys, renamed_fields
from palmbots.control.interface import MESSAGE_KINDS, MOVES, PALMS, MessageKind, Move, Palm
from palmbots.errors import PalmbotsError

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
    "SignWord",
    "Verdict",
    "decode",
    "encode",
]


def __dir__() -> list[str]:
    return sorted(__all__)


PACKET_SIZE = sum(size for _, _, size in _core.wire.layout())
"""Bytes of a packet."""
KEY_SIZE = 16
"""Bytes of a pair's key."""
MAX_EPOCH = 2**24 - 1
"""The last epoch."""
MAX_SEQUENCE = 2**32 - 1
"""The last packet of an epoch."""

Role = Literal["left", "right", "station"]
Kind = Literal["hello", "message", "beacon", "report", "command", "sign"]
Verdict = Literal[
    "accepted",
    "wrong_version",
    "too_short",
    "too_long",
    "wrong_pair",
    "wrong_receiver",
    "bad_tag",
    "malformed",
    "stale",
    "no_session",
]

# In the order of the core's numbers.
_ROLES: tuple[Role, ...] = _core.wire.roles
_KINDS: tuple[Kind, ...] = _core.wire.packet_kinds
_VERDICTS: tuple[Verdict, ...] = _core.wire.verdicts
_MESSAGES = MESSAGE_KINDS[1:]  # the payload counts them from 1
_RENAMED_VERDICTS: dict[str, Verdict] = {
    "forged": "bad_tag",
    "misdirected": "wrong_receiver",
    "other_version": "wrong_version",
    "stranger": "wrong_pair",
    "unanswered": "no_session",
}
_BEACONS = ("I", "R", "G", "D", "W")
_Fields = tuple[int, int, int, int, tuple[int, int], tuple[int, int], int]
_SIGNS: tuple[Literal[-1, 0, 1], ...] = (-1, 0, 1)


@renamed_fields(rests="stopped")
@dataclass(frozen=True, slots=True)
class Beacon:
    """What a robot sends periodically in the resilient algorithm."""

    letter: Literal["I", "R", "G", "D", "W"]
    stopped: bool = False
    """The robot does not travel."""
    ready: bool = False
    """The robot is free to travel."""


@renamed_fields(turned="palm_at_target")
@dataclass(frozen=True, slots=True)
class Report:
    """What a robot reports to the station."""

    sign: Literal[-1, 0, 1]
    """Tactile sign of the contact coordinate p; p > 0 is outward."""
    palm: Palm
    """The palm angle that was commanded last."""
    palm_at_target: bool
    """The palm has reached that angle."""


@dataclass(frozen=True, slots=True)
class Command:
    """What the station commands a robot to do."""

    palm: Palm
    move: Move


@dataclass(frozen=True, slots=True)
class SignWord:
    """What a robot sends periodically with the controller shared-sign."""

    sign: Literal[-1, 0, 1]
    """Tactile sign of the contact coordinate p; p > 0 is outward."""
    palm: Palm = "steep"
    """The palm angle that was commanded last. It counts where both robots have the same sign; with
    sign 0 it is not sent and is always "steep"."""


Body = MessageKind | Beacon | Report | Command | SignWord | None
"""Content of a packet: a message of the distributed algorithm, a beacon of the resilient one, a
report or a command of the centralized one, a sign, or None for a hello."""


@renamed_fields(heard="acknowledged")
@dataclass(frozen=True, slots=True)
class Packet:
    """One packet, without its tag."""

    sender: Role
    receiver: Role
    pair: int
    """Identity of the pair, 0 to 65535."""
    epoch: int
    """Number of boots of the sender, 1 to ``MAX_EPOCH``."""
    sequence: int
    """Number of packets that it has sent in this epoch, this one included, 1 to ``MAX_SEQUENCE``.
    """
    acknowledged: tuple[int, int] = (0, 0)
    """Epoch and sequence of the newest packet that the sender had received from the receiver since
    its boot; (0, 0): none."""
    body: Body = None

    @property
    def kind(self) -> Kind:
        """The kind of content."""
        return _KINDS[_payload(self.body)[0]]


@dataclass(frozen=True, slots=True)
class Decoded:
    """The result of decoding bytes."""

    verdict: Verdict
    packet: Packet | None
    """The packet if it was accepted, otherwise None."""


def encode(packet: Packet, key: bytes) -> bytes:
    """The bytes of a packet, with a tag computed from the key of the pair.

    Raises:
        PalmbotsError: a field is out of range, or this sender never sends such a packet to this
            receiver.
    """
    _check_key(key)
    kind, payload = _payload(packet.body)
    _check_talk(packet.sender, packet.receiver, _KINDS[kind])
    encoded = _core.wire.encode(
        key,
        kind,
        _ROLES.index(packet.sender),
        _ROLES.index(packet.receiver),
        _whole("pair", packet.pair, 0, 0xFFFF),
        _stamp("", (packet.epoch, packet.sequence)),
        (0, 0) if packet.acknowledged == (0, 0) else _stamp("acknowledged ", packet.acknowledged),
        payload,
    )
    assert encoded is not None  # the checks above cover everything that the core refuses
    return encoded


def decode(data: bytes, key: bytes, pair: int, receiver: Role) -> Decoded:
    """Decode bytes for a receiver, without checking whether the packet is new.

    Bytes that are no packet raise no error; the verdict states what is wrong with them.

    Raises:
        PalmbotsError: key, pair or receiver is not valid.
    """
    _check_key(key)
    role = _index("receiver", _ROLES, receiver)
    return _decoded(*_core.wire.decode(data, key, _whole("pair", pair, 0, 0xFFFF), role))


class Endpoint:
    """One end of the wire: it numbers the packets that it sends and accepts only new packets.

    A packet is accepted if it decodes, is newer than all earlier packets of its sender, and was
    sent after the sender had received a packet of this endpoint's present epoch. `epoch` counts the
    boots of this endpoint and must increase at each boot.
    """

    def __init__(self, key: bytes, pair: int, role: Role, epoch: int) -> None:
        _check_key(key)
        self._role: Role = role
        self._core = _core.wire.Endpoint(
            key,
            _whole("pair", pair, 0, 0xFFFF),
            _index("role", _ROLES, role),
            _whole("epoch", epoch, 1, MAX_EPOCH),
        )

    def send(self, receiver: Role, body: Body = None) -> bytes:
        """The next packet.

        Raises:
            PalmbotsError: this role never sends such a packet to this receiver, or the sequence
                numbers of this epoch are used up.
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
        """Decode bytes and check that the packet is new; every call is counted."""
        return _decoded(*self._core.receive(data))

    @property
    def counts(self) -> dict[Verdict, int]:
        """Number of received packets by verdict."""
        counts = ((_verdict(name), count) for name, count in self._core.counts)
        return RenamedKeys(counts, _RENAMED_VERDICTS)


def _payload(body: Body) -> tuple[int, int]:
    """Kind and payload, in numbers."""
    match body:
        case None:
            return 0, 0
        case Report():
            sign = _SIGNS[_index("sign", _SIGNS, body.sign)]
            return 3, _core.wire.report(
                sign, _index("palm", PALMS, body.palm), bool(body.palm_at_target)
            )
        case Command():
            palm, move = _index("palm", PALMS, body.palm), _index("move", MOVES, body.move)
            return 4, _core.wire.command(palm, move)
        case SignWord():
            sign = _SIGNS[_index("sign", _SIGNS, body.sign)]
            palms = PALMS if sign else ("steep",)
            palm = _index("palm of a sign", palms, body.palm)
            return 5, _core.wire.sign(sign, palm)
        case Beacon():
            _index("letter of a beacon", _BEACONS, body.letter)
            return 2, _core.wire.beacon(body.letter, bool(body.stopped), bool(body.ready))
        case _:
            return 1, 1 + _index(
                "body", _MESSAGES, body, also=", or a Beacon, Report, Command, SignWord or None"
            )


def _body(kind: int, payload: int) -> Body:
    """The content of an accepted packet."""
    match _KINDS[kind]:
        case "hello":
            return None
        case "message":
            return _MESSAGES[payload - 1]
        case "beacon":
            letter, stopped, ready = _core.wire.beacon_of(payload)
            return Beacon(letter, stopped, ready)  # type: ignore[arg-type]
        case "report":
            sign, palm, palm_at_target = _core.wire.report_of(payload)
            return Report(_SIGNS[sign + 1], PALMS[palm], palm_at_target)
        case "command":
            palm, move = _core.wire.command_of(payload)
            return Command(PALMS[palm], MOVES[move])
        case "sign":
            sign, palm = _core.wire.sign_of(payload)
            return SignWord(_SIGNS[sign + 1], PALMS[palm])


def _decoded(verdict: str, fields: _Fields) -> Decoded:
    if verdict != "accepted":
        return Decoded(_verdict(verdict), None)
    kind, sender, receiver, pair, (epoch, sequence), acknowledged, payload = fields
    body = _body(kind, payload)
    packet = Packet(_ROLES[sender], _ROLES[receiver], pair, epoch, sequence, acknowledged, body)
    return Decoded("accepted", packet)


def _verdict(name: str) -> Verdict:
    return _VERDICTS[_VERDICTS.index(name)]


def _check_key(key: bytes) -> None:
    if not isinstance(key, bytes) or len(key) != KEY_SIZE:
        raise PalmbotsError(f"key: is not {KEY_SIZE} bytes; allowed: bytes of length {KEY_SIZE}")


def _check_talk(sender: Role, receiver: Role, kind: Kind) -> None:
    """Refuse a packet that this sender never sends to this receiver."""
    _index("sender", _ROLES, sender)
    to: tuple[Role, ...] = tuple(role for role in _ROLES if role != sender)
    match kind:
        case "message" | "beacon" | "sign":
            _index("sender of a " + kind, SIDES, sender)
            to = tuple(role for role in to if role != "station")
        case "report":
            _index("sender of a report", SIDES, sender)
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

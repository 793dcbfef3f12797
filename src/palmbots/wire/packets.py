# SPDX-License-Identifier: Apache-2.0
"""Packets, and one end of the wire (docs/reference/wire.md)."""

from dataclasses import dataclass
from typing import TypeAlias

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.wire.bodies import BODIES, Body, Hello, Verdict, body_of, index, payload_of, whole

PACKET_SIZE = sum(size for _, _, size in _core.wire.layout())
"""Bytes of a packet."""
KEY_SIZE = 16
"""Bytes of a pair's key."""
MAX_EPOCH = 2**24 - 1
"""The last epoch."""
MAX_SEQUENCE = 2**32 - 1
"""The last packet of an epoch."""

Role: TypeAlias = _core.wire.Role
Kind: TypeAlias = _core.wire.Kind
# In the order of the core's numbers.
ROLES: tuple[Role, ...] = _core.wire.roles
_KINDS: tuple[Kind, ...] = _core.wire.packet_kinds
_VERDICTS: tuple[Verdict, ...] = _core.wire.verdicts
_HELLO = Hello()
_Fields = tuple[int, int, int, int, tuple[int, int], tuple[int, int], bytes]


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
    """Number of the packet among those to this receiver in this epoch, 1 to ``MAX_SEQUENCE``.
    Between robots it is the control tick."""
    acknowledged: tuple[int, int] = (0, 0)
    """Epoch and sequence of the newest packet that the sender had received from the receiver since
    its boot; (0, 0): none."""
    body: Body = _HELLO

    @property
    def kind(self) -> Kind:
        """The kind of content."""
        return _kind(self.body)


@dataclass(frozen=True, slots=True)
class Decoded:
    """The result of decoding bytes."""

    verdict: Verdict
    authentic: Packet | None
    """The packet if its tag is right, whether or not it is new; otherwise None."""

    @property
    def packet(self) -> Packet | None:
        """The packet if it was accepted, otherwise None."""
        return self.authentic if self.verdict == "accepted" else None


def encode(packet: Packet, key: bytes) -> bytes:
    """The bytes of a packet, with a tag computed from the key of the pair.

    Raises:
        PalmbotsError: a field is out of range, or this sender never sends such a packet to this
            receiver.
    """
    _check_key(key)
    payload = payload_of(packet.body)
    _check_talk(packet.sender, packet.receiver, packet.kind)
    encoded = _core.wire.encode(
        key,
        _KINDS.index(packet.kind),
        ROLES.index(packet.sender),
        ROLES.index(packet.receiver),
        whole("pair", packet.pair, 0, 0xFFFF),
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
    role = index("receiver", ROLES, receiver)
    return _decoded(*_core.wire.decode(data, key, whole("pair", pair, 0, 0xFFFF), role))


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
            whole("pair", pair, 0, 0xFFFF),
            index("role", ROLES, role),
            whole("epoch", epoch, 1, MAX_EPOCH),
        )

    def send(self, receiver: Role, body: Body = _HELLO) -> bytes:
        """The next packet.

        Raises:
            PalmbotsError: this role never sends such a packet to this receiver, or the sequence
                numbers of this epoch are used up.
        """
        payload = payload_of(body)
        kind = _kind(body)
        _check_talk(self._role, receiver, kind)
        sent = self._core.send(ROLES.index(receiver), _KINDS.index(kind), payload)
        if sent is None:
            raise PalmbotsError(
                f"sequence: all {MAX_SEQUENCE} are used up; needed: an Endpoint with the next epoch"
            )
        return sent

    def receive(self, data: bytes) -> Decoded:
        """Decode bytes and check that the packet is new; every call is counted."""
        return _decoded(*self._core.receive(data))

    def newest(self, receiver: Role) -> tuple[int, int]:
        """Epoch and sequence of the newest packet to this receiver; sequence 0: there is none."""
        return self._core.newest(index("receiver", ROLES, receiver))

    def skip_to(self, receiver: Role, sequence: int) -> None:
        """Number the next packet to this receiver `sequence`, unless that number has been used.

        Robots number their packets to each other by the control tick.
        """
        role = index("receiver", ROLES, receiver)
        self._core.skip_to(role, whole("sequence", sequence, 1, MAX_SEQUENCE))

    def claimed_epoch(self, other: Role) -> int:
        """The highest epoch of this endpoint that the other end has named; 0: none.

        If it exceeds the own epoch, the counter of boots is behind: this endpoint runs elsewhere
        too, or did so before.
        """
        return self._core.claimed_epoch(index("other", ROLES, other))

    @property
    def counts(self) -> dict[Verdict, int]:
        """Number of received packets by verdict."""
        return {_verdict(name): count for name, count in self._core.counts}


def _kind(body: Body) -> Kind:
    return _KINDS[BODIES.index(type(body))]


def _decoded(verdict: str, fields: _Fields) -> Decoded:
    if verdict not in _core.wire.authentic:
        return Decoded(_verdict(verdict), None)
    kind, sender, receiver, pair, (epoch, sequence), acknowledged, payload = fields
    body = body_of(kind, payload)
    packet = Packet(ROLES[sender], ROLES[receiver], pair, epoch, sequence, acknowledged, body)
    return Decoded(_verdict(verdict), packet)


def _verdict(name: str) -> Verdict:
    return _VERDICTS[_VERDICTS.index(name)]


def _check_key(key: bytes) -> None:
    if not isinstance(key, bytes) or len(key) != KEY_SIZE:
        raise PalmbotsError(f"key: is not {KEY_SIZE} bytes; allowed: bytes of length {KEY_SIZE}")


def _check_talk(sender: Role, receiver: Role, kind: Kind) -> None:
    """Refuse a packet that this sender never sends to this receiver."""
    index("sender", ROLES, sender)
    to: tuple[Role, ...] = tuple(role for role in ROLES if role != sender)
    match kind:
        case "state" | "phase":
            index("sender of a " + kind, SIDES, sender)
            to = tuple(role for role in to if role != "station")
        case "status" | "report":
            index("sender of a " + kind, SIDES, sender)
            to = ("station",)
        case "operate":
            index("sender of an operation", ("station",), sender)
        case "command":
            index("sender of a command", ("station",), sender)
        case "hello":
            pass
    index("receiver", to, receiver)


def _stamp(what: str, stamp: tuple[int, int]) -> tuple[int, int]:
    epoch, sequence = stamp
    return (
        whole(what + "epoch", epoch, 1, MAX_EPOCH),
        whole(what + "sequence", sequence, 1, MAX_SEQUENCE),
    )

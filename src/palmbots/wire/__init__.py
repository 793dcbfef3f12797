# SPDX-License-Identifier: Apache-2.0
"""Packets and endpoints: what robots and station send each other, computed by the compiled core.

A packet has 32 bytes; docs/reference/wire.md describes each of them. `encode` and `decode` convert
a packet to bytes and back. An `Endpoint` keeps what a robot or the station must remember between
packets, and distinguishes new packets from old ones.

>>> from palmbots import wire
>>> left = wire.Endpoint(key=bytes(16), pair=7, role="left", epoch=1)
>>> right = wire.Endpoint(key=bytes(16), pair=7, role="right", epoch=1)
>>> right.receive(left.send("right")).verdict  # the first packet after a boot opens the session
'no_session'
>>> answer = right.send("left", wire.State("messages", "TiltUp", mode="carrying"))
>>> left.receive(answer).packet.body.word
'TiltUp'
"""

from palmbots.wire.bodies import (
    Body,
    Command,
    FaultCode,
    Hello,
    Language,
    Operate,
    Operation,
    Report,
    RobotMode,
    State,
    Status,
    StatusItem,
    Verdict,
    Word,
)
from palmbots.wire.packets import (
    KEY_SIZE,
    MAX_EPOCH,
    MAX_SEQUENCE,
    PACKET_SIZE,
    Decoded,
    Endpoint,
    Kind,
    Packet,
    Role,
    decode,
    encode,
)

__all__ = [
    "KEY_SIZE",
    "MAX_EPOCH",
    "MAX_SEQUENCE",
    "PACKET_SIZE",
    "Body",
    "Command",
    "Decoded",
    "Endpoint",
    "FaultCode",
    "Hello",
    "Kind",
    "Language",
    "Operate",
    "Operation",
    "Packet",
    "Report",
    "RobotMode",
    "Role",
    "State",
    "Status",
    "StatusItem",
    "Verdict",
    "Word",
    "decode",
    "encode",
]


def __dir__() -> list[str]:
    return sorted(__all__)

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
>>> left.receive(answer).packet.body.message
'TiltUp'
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.wire.bodies import Body as Body
    from palmbots.wire.bodies import Command as Command
    from palmbots.wire.bodies import FaultCode as FaultCode
    from palmbots.wire.bodies import Hello as Hello
    from palmbots.wire.bodies import Language as Language
    from palmbots.wire.bodies import MessageName as MessageName
    from palmbots.wire.bodies import Operate as Operate
    from palmbots.wire.bodies import Operation as Operation
    from palmbots.wire.bodies import Phase as Phase
    from palmbots.wire.bodies import Report as Report
    from palmbots.wire.bodies import RobotMode as RobotMode
    from palmbots.wire.bodies import State as State
    from palmbots.wire.bodies import Status as Status
    from palmbots.wire.bodies import StatusItem as StatusItem
    from palmbots.wire.bodies import Verdict as Verdict
    from palmbots.wire.packets import KEY_SIZE as KEY_SIZE
    from palmbots.wire.packets import MAX_EPOCH as MAX_EPOCH
    from palmbots.wire.packets import MAX_SEQUENCE as MAX_SEQUENCE
    from palmbots.wire.packets import PACKET_SIZE as PACKET_SIZE
    from palmbots.wire.packets import Decoded as Decoded
    from palmbots.wire.packets import Endpoint as Endpoint
    from palmbots.wire.packets import Kind as Kind
    from palmbots.wire.packets import Packet as Packet
    from palmbots.wire.packets import Role as Role
    from palmbots.wire.packets import decode as decode
    from palmbots.wire.packets import encode as encode
else:
    __getattr__, __dir__ = lazy_names(__name__)

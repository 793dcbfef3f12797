# SPDX-License-Identifier: Apache-2.0
"""The section `radio` of a scene: the links, and what happens to messages."""

from palmbots._types import Side
from palmbots.scene.core_keys import key, keys_with_holders, records
from palmbots.scene.fields import FileName
from palmbots.scene.section import Section, override_of


class Outage(Section):
    """A time during which nothing that the sender transmits arrives."""

    sender: str = key("radio.outages[].sender")
    start_s: float = key("radio.outages[].start_s")
    end_s: float = key("radio.outages[].end_s")


class MessageFault(Section):
    """What happens to one message."""

    sender: str = key("radio.script[].sender")
    receiver: Side | None = key("radio.script[].receiver")
    """Receiver of a message of the station; not for a message of a robot."""
    message: int = key("radio.script[].message")
    """Number of the message among all that the sender transmits to this receiver, from 1."""
    effect: str = key("radio.script[].effect")
    """The message is lost, delayed by `delay_s`, or duplicated after `delay_s`."""
    delay_s: float | None = key("radio.script[].delay_s")
    """Delay of the message or of its duplicate; not for a lost message."""


class RadioParameters(Section):
    """The links between the robots, and between each robot and the station."""

    latency_s: float = key("radio.latency_s")
    """Shortest time from sending to receiving. The tables radio.left, radio.right and radio.station
    override latency_s, jitter_s and loss for what one sender transmits."""
    jitter_s: float = key("radio.jitter_s")
    """Longest additional time; random for each packet."""
    reorder: bool = key("radio.reorder")
    """Whether jitter lets a packet overtake another on the same link."""
    sessions: bool = key("radio.sessions")
    """Whether robots and station number their packets and ignore those that are old, copied, or not
    sent in answer to their present boot, as on the wire. false: the bare channel of the paper, on
    which `centralized` and `distributed` act on everything that arrives."""
    loss: float = key("radio.loss")
    """Probability that a packet is lost, independent for each packet."""
    burst_fraction: float = key("radio.burst_fraction")
    """Fraction of the time in which a link is dead in bursts (Gilbert-Elliott model), in addition
    to `loss`."""
    burst_s: float = key("radio.burst_s")
    """Mean duration of such a burst."""
    duplicate: float = key("radio.duplicate")
    """Probability that a packet arrives twice; the copy has its own delay."""
    corruption: float = key("radio.corruption")
    """Probability that the bytes of a packet are damaged. The receiver ignores such a packet."""
    airtime_s: float = key("radio.airtime_s")
    """Duration of a packet on the air. If both robots send in the same control period, at random
    instants less than this time apart, both packets are lost. 0: no collisions."""
    outages: tuple[Outage, ...] = records("radio.outages")
    """Times during which one sender is not heard: a list of tables {sender, start_s, end_s}."""
    script: tuple[MessageFault, ...] = records("radio.script")
    """What happens to single messages in every carry: a list of tables {sender, message, effect,
    delay_s}. If the sender is the station, receiver is required, too."""
    trace: FileName | None = None
    """A file with recorded packets, which were lost or arrived late (docs/guide/fit.md). They
    replace losses and bursts, and latency and jitter as far as delays were recorded. Each link
    begins at a random place. Time limits still use latency_s and jitter_s. The name is relative to
    the scene file."""
    replay: float = key("radio.replay")
    """Probability that an attacker records a packet, and sends it again after `replay_within_s` at
    the latest."""
    replay_within_s: float = key("radio.replay_within_s")
    """Longest time until a recorded packet is sent again."""
    beacon_s: float = key("radio.beacon_s")
    """Controllers resilient and shared-sign: time between two beacons of a robot whose state stays
    the same; shared-sign leaves out most of them."""
    lease_s: float | None = key("radio.lease_s")
    """Controllers resilient and shared-sign: longest age at which a beacon is valid. Not set:
    resilient 0.5, longer if the latency requires it, shorter if the palms and the noise leave less
    room; shared-sign a round trip and three beacons. With control.brake, it is proved for
    shared-sign only up to 0.39 (in the default scene) that no contact leaves its palm."""


@override_of(RadioParameters, keys_with_holders("radio"))
class DirectionOverride(Section):
    """What differs in the packets of one sender."""


class Radio(RadioParameters):
    """[radio] The links; [radio.left], [radio.right] and [radio.station] override one sender's."""

    left: DirectionOverride = DirectionOverride()
    """Packets of the left robot."""
    right: DirectionOverride = DirectionOverride()
    """Packets of the right robot."""
    station: DirectionOverride = DirectionOverride()
    """Packets of the station."""

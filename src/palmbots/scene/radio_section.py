# SPDX-License-Identifier: Apache-2.0
"""The section `radio` of a scene: the links, and what happens to messages."""

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, model_validator

from palmbots._types import Side
from palmbots.scene.fields import (
    Fraction,
    Lasting,
    Moment,
    Range,
    Switch,
    field_error,
    from_list,
    whole,
)
from palmbots.scene.section import Section

Delay = Annotated[float, BeforeValidator(Range("s", least=0, most=10))]
Share = Annotated[float, BeforeValidator(Range(least=0, most=0.99))]
Ordinal = Annotated[int, BeforeValidator(whole(1, 1_000_000))]


class Outage(Section):
    """A time during which nothing that the sender transmits arrives."""

    sender: Literal["left", "right", "station"]
    start_s: Moment
    end_s: Moment

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.end_s <= self.start_s:
            raise field_error(
                self.end_s,
                f"is not more than start_s, which is {self.start_s:g}",
                f"a number in s, more than {self.start_s:g}",
                "end_s",
            )
        return self


Outages = Annotated[
    tuple[Outage, ...],
    BeforeValidator(from_list("a list of at most 16 tables {sender, start_s, end_s}", 0, 16)),
]


class MessageFault(Section):
    """What happens to one message."""

    sender: Literal["left", "right", "station"]
    receiver: Side | None = None
    """Receiver of a message of the station; not for a message of a robot."""
    message: Ordinal
    """Number of the message among all that the sender transmits to this receiver, from 1."""
    effect: Literal["lost", "delayed", "duplicated"]
    """The message is lost, delayed by `delay_s`, or duplicated after `delay_s`."""
    delay_s: Delay | None = None
    """Delay of the message or of its duplicate; not for a lost message."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.receiver is None) != (self.sender != "station"):
            raise field_error(
                self.model_dump(),
                "has no receiver" if self.sender == "station" else "has a receiver",
                'receiver = "left" or "right" with the sender station, not with a robot',
            )
        if (self.delay_s is None) != (self.effect == "lost"):
            raise field_error(
                self.model_dump(),
                "has a delay" if self.effect == "lost" else "has no delay",
                "delay_s with the effect delayed or duplicated, not with lost",
            )
        return self


MessageFaults = Annotated[
    tuple[MessageFault, ...],
    BeforeValidator(from_list("a list of at most 16 tables {sender, message, effect}", 0, 16)),
]


class DirectionOverride(Section):
    """[radio.left], [radio.right], [radio.station] What differs for the packets of one sender."""

    latency_s: Delay | None = None
    jitter_s: Delay | None = None
    loss: Fraction | None = None


class Radio(Section):
    """[radio] The links between the robots, and between each robot and the station."""

    latency_s: Delay = 0.05
    """Shortest time from sending to receiving. The tables radio.left, radio.right and radio.station
    override latency_s, jitter_s and loss for what one sender transmits."""
    jitter_s: Delay = 0.0
    """Longest additional time; random for each packet."""
    reorder: Switch = False
    """Whether jitter lets a packet overtake another on the same link."""
    sessions: Switch = True
    """Whether robots and station number their packets and ignore those that are old, copied, or not
    sent in answer to their present boot, as on the wire. false: the bare channel of the paper, on
    which `centralized` and `distributed` act on everything that arrives."""
    loss: Fraction = 0.0
    """Probability that a packet is lost, independent for each packet."""
    burst_fraction: Share = 0.0
    """Fraction of the time in which a link is dead in bursts (Gilbert-Elliott model), in addition
    to `loss`."""
    burst_s: Lasting = 0.1
    """Mean duration of such a burst."""
    duplicate: Fraction = 0.0
    """Probability that a packet arrives twice; the copy has its own delay."""
    corruption: Fraction = 0.0
    """Probability that the bytes of a packet are damaged. The receiver ignores such a packet."""
    airtime_s: Delay = 0.0
    """Duration of a packet on the air. If both robots send in the same control period, at random
    instants less than this time apart, both packets are lost. 0: no collisions."""
    outages: Outages = ()
    """Times during which one sender is not heard: a list of tables {sender, start_s, end_s}."""
    script: MessageFaults = ()
    """What happens to single messages in every carry: a list of tables {sender, message, effect,
    delay_s}. If the sender is the station, receiver is required, too."""
    replay: Fraction = 0.0
    """Probability that an attacker records a packet, and sends it again after `replay_within_s` at
    the latest."""
    replay_within_s: Lasting = 1.0
    """Longest time until a recorded packet is sent again."""
    beacon_s: Lasting = 0.05
    """Controllers resilient and shared-sign: time between two beacons of a robot whose state stays
    the same."""
    lease_s: Lasting | None = None
    """Controllers resilient and shared-sign: longest age at which a beacon is valid. Not set:
    resilient 0.5, longer if the latency requires it, shorter if the palms and the noise leave less
    room; shared-sign a round trip and four beacons. With control.brake, it is proved for
    shared-sign only up to 0.3 (in the default scene) that no contact leaves its palm."""
    left: DirectionOverride = DirectionOverride()
    """Packets of the left robot."""
    right: DirectionOverride = DirectionOverride()
    """Packets of the right robot."""
    station: DirectionOverride = DirectionOverride()
    """Packets of the station."""

    def of(self, sender: Literal["left", "right", "station"]) -> "Radio":
        """The links of one sender."""
        override: DirectionOverride = getattr(self, sender)
        given = {name: getattr(override, name) for name in type(override).model_fields}
        return self.model_copy(update={k: v for k, v in given.items() if v is not None})

    @property
    def longest_delay_s(self) -> float:
        """The longest delay of any sender's packets."""
        senders: tuple[Literal["left", "right", "station"], ...] = ("left", "right", "station")
        return max(self.of(sender).latency_s + self.of(sender).jitter_s for sender in senders)

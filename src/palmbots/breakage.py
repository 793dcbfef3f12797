"""The sections of a scene that say what goes wrong: the radio, and faults of robots and sensors.

As in `sections`: every key with its meaning, unit, limits and default.
"""

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, model_validator

from palmbots.quantities import Fraction, Range, Switch, fault, from_list, whole
from palmbots.section import Section
from palmbots.sections import Moment, Side

__all__ = ["Fault", "Faults", "Mishap", "Outage", "Radio"]

Delay = Annotated[float, BeforeValidator(Range("s", least=0, most=10))]
Lasting = Annotated[float, BeforeValidator(Range("s", least=0.0001, most=1_000_000))]
Share = Annotated[float, BeforeValidator(Range(least=0, most=0.99))]
Ordinal = Annotated[int, BeforeValidator(whole(1, 1_000_000))]
Few = Annotated[int, BeforeValidator(whole(0, 8))]


class Outage(Section):
    """A time in which nothing that one of them sends arrives."""

    sender: Literal["left", "right", "station"]
    start_s: Moment
    end_s: Moment

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.end_s <= self.start_s:
            raise fault(
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


class Mishap(Section):
    """What befalls one message of a robot."""

    sender: Side
    message: Ordinal
    """Which of all that it sends, from 1."""
    fate: Literal["lost", "late", "copied"]
    """It is lost; it comes later than it should; it comes, and once more later."""
    late_s: Delay | None = None
    """How much later; not where it is lost."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.late_s is None) != (self.fate == "lost"):
            raise fault(
                self.model_dump(),
                "says how late" if self.fate == "lost" else "does not say how late",
                "late_s where the fate is late or copied, not where it is lost",
            )
        return self


Mishaps = Annotated[
    tuple[Mishap, ...],
    BeforeValidator(from_list("a list of at most 16 tables {sender, message, fate}", 0, 16)),
]


class Radio(Section):
    """[radio] Every link between the robots, and between a robot and the station."""

    latency_s: Delay = 0.05
    """Least time from sending to receiving."""
    jitter_s: Delay = 0.0
    """Greatest additional time, random for each packet."""
    reorder: Switch = False
    """Whether jitter lets a packet overtake another on the same link."""
    loss: Fraction = 0.0
    """Probability that a packet is lost, each by itself."""
    burst_share: Share = 0.0
    """Share of the time in which a link is dead, in bursts (Gilbert, Elliott), besides `loss`."""
    burst_s: Lasting = 0.1
    """Mean length of such a burst."""
    duplicate: Fraction = 0.0
    """Probability that a packet comes twice, the copy with a delay of its own."""
    corruption: Fraction = 0.0
    """Probability that a packet's bytes are damaged on the way; its receiver ignores it."""
    airtime_s: Delay = 0.0
    """Half duplex: two robots that send in the same control period, at random instants of it, lose
    both packets if they are closer than this; 0: no collisions."""
    outages: Outages = ()
    """Times in which one direction is dead."""
    script: Mishaps = ()
    """What befalls single messages in every carry."""
    beacon_s: Lasting = 0.05
    """Resilient algorithm: time between two beacons of a robot that has nothing new to say."""
    lease_s: Lasting | None = None
    """Resilient algorithm: how old a beacon may be to count; not set: 0.5, or more where the
    latency asks for more and the palms leave room."""


class Fault(Section):
    """Something that breaks for a while."""

    kind: Literal["reboot", "freeze", "stuck", "flicker", "station"]
    """A robot is off and boots; a robot's controller does not step; a sensor reads one sign; a
    sensor's readings are random now and then; the station neither hears nor sends."""
    robot: Side | None = None
    """Which one; not for the station."""
    at_s: Moment
    for_s: Lasting
    reads: Literal["-", "0", "+"] | None = None
    """What a stuck sensor reads."""
    rate: Fraction | None = None
    """Probability that a reading of a flickering sensor is random."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        wanted = {"stuck": {"robot", "reads"}, "flicker": {"robot", "rate"}, "station": set()}
        needs = wanted.get(self.kind, {"robot"})
        given = {name for name in ("robot", "reads", "rate") if getattr(self, name) is not None}
        if given != needs:
            names = ", ".join(sorted(needs)) or "none of robot, reads and rate"
            raise fault(
                self.model_dump(),
                "does not say what breaks how",
                f"with kind {self.kind}, besides at_s and for_s: {names}",
            )
        return self


FaultScript = Annotated[
    tuple[Fault, ...],
    BeforeValidator(from_list("a list of at most 32 tables {kind, robot, at_s, for_s}", 0, 32)),
]


class Faults(Section):
    """[faults] What breaks."""

    script: FaultScript = ()
    """Faults that happen in every carry."""
    reboots: Few = 0
    """Random reboots in every carry: of either robot, at any time of the way."""
    reboot_s: Lasting = 0.5
    """How long one of them takes."""

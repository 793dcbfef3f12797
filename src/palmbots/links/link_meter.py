# SPDX-License-Identifier: Apache-2.0
"""What a link does to the packets of one end: sent, received, lost, round trips.

The meter lies between a program and its link. It decodes what passes, and changes nothing.

LOST are the numbers that are missing in what an end sends to this one. Packets between station and
robots are numbered without gaps. Packets between robots are numbered by control ticks, so their
losses cannot be seen from one end: subtract what the partner has received from what was sent.
A ROUND TRIP ends with the first packet that acknowledges the newest packet sent. It includes the
time until the other end sends its next packet.
"""

import math
from collections import deque
from time import monotonic
from typing import Any, TypedDict

from palmbots.links.link import Link
from palmbots.links.round_trips import RoundTrips, Stamp, quantile
from palmbots.wire import Role, decode

_RECENT = 1000  # round trips
_WINDOW = 64  # numbers below the newest one, in which an overtaken packet is recognized


class EndTable(TypedDict):
    """What was exchanged with one other end, as JSON has it; None: unknown."""

    sent: int
    received: int
    lost: int | None
    copies: int
    overtaken: int
    round_trip_median_s: float | None
    round_trip_p99_s: float | None
    round_trip_longest_s: float | None


class MeterTable(TypedDict, total=False):
    """What was exchanged with each other end, and what the link says about itself."""

    left: EndTable
    right: EndTable
    station: EndTable
    details: dict[str, Any]


class EndCounts:
    """What was exchanged with one other end."""

    def __init__(self, *, is_numbered: bool) -> None:
        self._is_numbered = is_numbered  # without gaps
        self.sent = 0
        """Packets to it."""
        self.received = 0
        """Packets from it with the right tag, copies included."""
        self.copies = 0
        """Packets from it that had arrived before."""
        self.overtaken = 0
        """Packets from it that arrived after one that was sent later."""
        self._missing = 0
        self._newest = (0, 0)
        self._seen: set[int] = set()
        self._trips = RoundTrips()
        self.round_trips_s: deque[float] = deque(maxlen=_RECENT)
        """The newest round trips."""
        self.longest_s = math.nan
        """The longest of all round trips [s]; NaN: there was none."""

    @property
    def lost(self) -> int | None:
        """Packets from it that have not arrived; None: unknown (see above)."""
        return self._missing if self._is_numbered else None

    def note_sent(self, stamp: Stamp) -> None:
        """A packet with this epoch and sequence is being sent to it."""
        self.sent += 1
        self._trips.note_sent(stamp, monotonic())

    def note_received(self, epoch: int, sequence: int, acknowledged: Stamp) -> None:
        """A packet from it has arrived."""
        self.received += 1
        self._count(epoch, sequence)
        trip_s = self._trips.answered(acknowledged, monotonic())
        if trip_s is not None:
            self.round_trips_s.append(trip_s)
            self.longest_s = trip_s if math.isnan(self.longest_s) else max(trip_s, self.longest_s)

    def _count(self, epoch: int, sequence: int) -> None:
        known, newest = self._newest
        if epoch > known:  # it has booted, or is heard for the first time
            self._newest, self._seen = (epoch, sequence), {sequence}
        elif epoch == known and sequence > newest:
            self._missing += sequence - newest - 1
            self._newest = (epoch, sequence)
            self._seen = {number for number in self._seen if number > sequence - _WINDOW}
            self._seen.add(sequence)
        elif epoch == known and sequence not in self._seen and sequence > newest - _WINDOW:
            self._seen.add(sequence)
            self.overtaken += 1
            self._missing = max(0, self._missing - 1)
        else:
            self.copies += 1

    def round_trip_s(self, fraction: float) -> float:
        """A quantile of the newest round trips [s]; NaN: there was none."""
        return quantile(self.round_trips_s, fraction)

    def summary(self) -> EndTable:
        """The same as a table; what is not known is None."""

        def known(trip_s: float) -> float | None:
            return None if math.isnan(trip_s) else trip_s

        return {
            "sent": self.sent,
            "received": self.received,
            "lost": self.lost,
            "copies": self.copies,
            "overtaken": self.overtaken,
            "round_trip_median_s": known(self.round_trip_s(0.5)),
            "round_trip_p99_s": known(self.round_trip_s(0.99)),
            "round_trip_longest_s": known(self.longest_s),
        }


class LinkMeter:
    """A link that counts.

    Args:
        link: the link.
        role: this end.
        key: of the pair.
        pair: its number.
    """

    def __init__(self, link: Link, role: Role, key: bytes, pair: int) -> None:
        self._link, self._key, self._pair = link, key, pair
        self._role: Role = role
        ends: tuple[Role, ...] = ("left", "right", "station")
        self.ends: dict[Role, EndCounts] = {
            end: EndCounts(is_numbered="station" in (end, role)) for end in ends if end != role
        }
        """What was exchanged with each other end."""

    def send(self, receiver: Role, data: bytes) -> None:
        """Send a packet."""
        packet = decode(data, self._key, self._pair, receiver).packet
        if packet is not None:
            self.ends[receiver].note_sent((packet.epoch, packet.sequence))
        self._link.send(receiver, data)

    def receive(self) -> list[bytes]:
        """The packets that have arrived."""
        arrived = self._link.receive()
        for data in arrived:
            packet = decode(data, self._key, self._pair, self._role).packet
            if packet is not None:
                stamps = packet.epoch, packet.sequence, packet.acknowledged
                self.ends[packet.sender].note_received(*stamps)
        return arrived

    @property
    def details(self) -> dict[str, Any]:
        """What the link says about itself."""
        return getattr(self._link, "details", {})

    def summary(self) -> MeterTable:
        """All counts as a table."""
        found: MeterTable = {end: counts.summary() for end, counts in self.ends.items()}  # type: ignore[assignment,misc]
        if self.details:
            found["details"] = self.details
        return found

    def close(self) -> None:
        """Close the link."""
        self._link.close()

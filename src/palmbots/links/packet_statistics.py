# SPDX-License-Identifier: Apache-2.0
"""What the radio does to the packets of one end: which are lost, copied and overtaken, and when
they are answered.

The endpoint of a program judges each packet and states its sender and stamp. These statistics
decode nothing, and each of them is defined here only.

RECEIVED are all packets with the right tag. A COPY has arrived before. An OVERTAKEN packet arrives
after one that was sent later. LOST are the numbers that are missing in what an end sends to this
one. Packets between station and robots are numbered without gaps, from 1 at every boot. Packets
between robots are numbered by control ticks, so their losses cannot be seen from one end: subtract
what the partner has received from what was sent.
A ROUND TRIP ends with the first packet that acknowledges the packet that began it. It includes the
time until the other end sends its next packet.
"""

import math
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import palmbots._core as _core
from palmbots._types import MaybeNaN
from palmbots._util import process_clock
from palmbots.wire import Role, Status
from palmbots.wire.serial_frames import BridgeReport

Stamp = tuple[int, int]
"""Epoch and sequence number of a packet."""
Kind = Literal["boot", "new", "copy", "overtaken", "other", "old"]
"""How a packet relates to the earlier ones of its sender. ``boot``: the first of an epoch.
``other``: from another program that claims to be the sender, because two different packets have one
number, or the packets of an earlier boot go on. ``old``: of an earlier epoch."""

_WINDOW = 64
"""By how many numbers an overtaken packet may be behind."""
_REMEMBERED = 600  # packets
_TRIPS = 1000
_RECENT_S = 10.0
_MODULUS = 65536
_PHASE = bytes([_core.wire.packet_kinds.index("phase")])  # the second byte of such a packet
_OF_NOW = ("progress", "battery", "overruns", "phase")  # no counts


def quantile(values: Iterable[float], fraction: float) -> float:
    """The smallest value that is not exceeded by this fraction of them; NaN: there is none."""
    ordered = sorted(values)
    if not ordered:
        return math.nan
    return ordered[max(0, math.ceil(fraction * len(ordered)) - 1)]


@dataclass(frozen=True)
class EndCounts:
    """What was exchanged with one other end, as JSON has it."""

    sent: int
    received: int
    lost: int | None
    """None: unknown."""
    copies: int
    overtaken: int
    round_trip_median_s: MaybeNaN
    round_trip_p99_s: MaybeNaN
    round_trip_longest_s: MaybeNaN


@dataclass(frozen=True, kw_only=True)
class LinkCounts:
    """What was exchanged with each other end; None: it is this end."""

    left: EndCounts | None = None
    right: EndCounts | None = None
    station: EndCounts | None = None
    details: dict[str, bool | int | float | str | BridgeReport | None]
    """What the link says about itself."""


@dataclass(frozen=True)
class Recent:
    """The packets of the last seconds."""

    count: int
    """Different packets that arrived."""
    lost: float
    """Fraction of those sent that did not arrive."""
    copies: float
    """Fraction of the arrivals that were copies."""
    overtaken: float
    """Fraction of the arrivals that were overtaken."""


class EndStatistics:
    """What was exchanged with one other end."""

    def __init__(self, *, is_numbered: bool = True) -> None:
        self._is_numbered = is_numbered  # without gaps
        self.sent = 0
        """Packets to it."""
        self.received = 0
        """Packets from it with the right tag, copies included."""
        self.copies = 0
        """Packets from it that had arrived before."""
        self.overtaken = 0
        """Packets from it that arrived after one that was sent later."""
        self.newest: Stamp = (0, 0)
        """Stamp of its newest packet; (0, 0): none has arrived."""
        self.longest_s = math.nan
        """The longest of all round trips [s]; NaN: there was none."""
        self._missing = 0
        self._known: dict[Stamp, bytes] = {}
        self._other_newest: Stamp = (0, 0)
        self._arrived: deque[tuple[float, int, Kind]] = deque()
        self._sent_s: dict[Stamp, float] = {}
        self._trips: deque[tuple[float, float]] = deque(maxlen=_TRIPS)

    @property
    def lost(self) -> int | None:
        """Packets from it that have not arrived; None: unknown (see above)."""
        return self._missing if self._is_numbered else None

    @property
    def round_trips_s(self) -> list[float]:
        """The newest round trips."""
        return [trip_s for _, trip_s in self._trips]

    def note_sent(self, stamp: Stamp, now_s: float) -> None:
        """A packet with this stamp is being sent to it."""
        self.sent += 1
        self._sent_s[stamp] = now_s
        if len(self._sent_s) > _REMEMBERED:
            del self._sent_s[next(iter(self._sent_s))]

    def take(self, stamp: Stamp, data: bytes, acknowledged: Stamp, now_s: float) -> Kind:
        """An authentic packet from it has arrived; returns how it relates to the earlier ones.

        Args:
            stamp: of the packet.
            data: its bytes.
            acknowledged: the stamp of the newest packet that its sender had received.
            now_s: the time.
        """
        kind = self._kind_of(stamp, data)
        self.received += 1
        if kind == "boot":
            self._other_newest, self.newest = self.newest, stamp
            self._arrived.clear()
        elif kind == "new":
            self._missing += stamp[1] - self.newest[1] - 1
            self.newest = stamp
        elif kind == "overtaken":
            self.overtaken += 1
            self._missing = max(0, self._missing - 1)
        elif kind == "copy":
            self.copies += 1
        self._known[stamp] = data
        if len(self._known) > _REMEMBERED:
            del self._known[next(iter(self._known))]
        if self._is_numbered and kind not in ("other", "old"):
            self._arrived.append((now_s, stamp[1], kind))
            self._forget(now_s)
        sent_s = self._sent_s.pop(acknowledged, None)
        if sent_s is not None:
            trip_s = now_s - sent_s
            self._trips.append((now_s, trip_s))
            self.longest_s = trip_s if math.isnan(self.longest_s) else max(trip_s, self.longest_s)
        return kind

    def _kind_of(self, stamp: Stamp, data: bytes) -> Kind:
        if stamp[0] > self.newest[0]:
            return "boot"
        known = self._known.get(stamp)
        if known is not None:
            return "copy" if known == data else "other"
        if stamp > self.newest:
            return "new"
        if stamp[0] == self.newest[0] and self.newest[1] - stamp[1] < _WINDOW:
            return "overtaken"
        # One that has never been seen, of a stream that is not the newest one: it lives.
        if stamp > self._other_newest or stamp[0] == self.newest[0]:
            self._other_newest = max(stamp, self._other_newest)
            return "other"
        return "old"

    def _forget(self, now_s: float) -> None:
        while self._arrived and now_s - self._arrived[0][0] > _RECENT_S:
            self._arrived.popleft()

    def recent(self, now_s: float, within_s: float = _RECENT_S) -> Recent | None:
        """The packets of the last seconds, at most 10; None: fewer than two."""
        self._forget(now_s)
        arrived = [one for one in self._arrived if now_s - one[0] <= within_s]
        kinds = [kind for *_, kind in arrived]
        numbers = {number for _, number, kind in arrived if kind != "copy"}
        if len(numbers) < 2:
            return None
        return Recent(
            len(numbers),
            1 - len(numbers) / (max(numbers) - min(numbers) + 1),
            kinds.count("copy") / len(kinds),
            kinds.count("overtaken") / len(kinds),
        )

    def loss(self, now_s: float) -> float | None:
        """Fraction of the packets of the last 10 s that were lost; None: too few arrived to say."""
        recent = self.recent(now_s)
        return None if recent is None else recent.lost

    def round_trip_s(self, now_s: float) -> float | None:
        """Median of the round trips of the last 10 s; None: there was none."""
        trips = [trip_s for at_s, trip_s in self._trips if now_s - at_s <= _RECENT_S]
        return quantile(trips, 0.5) if trips else None

    def counts(self, more: "EndStatistics | None" = None) -> EndCounts:
        """All that has been counted so far, here and in further statistics of the same end."""
        more = more or EndStatistics()
        trips_s = self.round_trips_s + more.round_trips_s
        longest_s = [one for one in (self.longest_s, more.longest_s) if not math.isnan(one)]
        return EndCounts(
            self.sent + more.sent,
            self.received + more.received,
            self.lost,
            self.copies + more.copies,
            self.overtaken + more.overtaken,
            quantile(trips_s, 0.5),
            quantile(trips_s, 0.99),
            max(longest_s, default=math.nan),
        )


class PacketStatistics:
    """What one end has exchanged with the others.

    Args:
        role: this end.
        clock: the time [s].
    """

    def __init__(self, role: Role, clock: Callable[[], float] = process_clock.monotonic) -> None:
        self._clock = clock
        ends: tuple[Role, ...] = ("left", "right", "station")
        self.ends: dict[Role, EndStatistics] = {
            end: EndStatistics(is_numbered="station" in (end, role)) for end in ends if end != role
        }
        """What was exchanged with each other end, but for phases."""
        self._phases: dict[Role, EndStatistics] = {
            end: EndStatistics(is_numbered=False) for end in self.ends
        }

    def _of(self, end: Role, data: bytes) -> EndStatistics:
        """The statistics to which a packet belongs: phases are numbered by themselves."""
        return (self._phases if data[1:2] == _PHASE else self.ends)[end]

    def note_sent(self, receiver: Role, stamp: Stamp, data: bytes = b"") -> None:
        """A packet with this stamp is being sent."""
        self._of(receiver, data).note_sent(stamp, self._clock())

    def take(self, sender: Role, stamp: Stamp, data: bytes, acknowledged: Stamp) -> Kind:
        """An authentic packet has arrived (`EndStatistics.take`)."""
        return self._of(sender, data).take(stamp, data, acknowledged, self._clock())

    def counts(self, details: Mapping[str, Any]) -> LinkCounts:
        """All that has been counted so far, and what the link says about itself."""
        ends = {end: one.counts(self._phases[end]) for end, one in self.ends.items()}
        return LinkCounts(**ends, details=dict(details))


class ReportedCounts:
    """Adds up the counts that a robot reports to the station, one with each status, modulo 65536
    (docs/reference/wire.md)."""

    def __init__(self) -> None:
        self._newest: dict[str, int] = {}
        self.totals: dict[str, int] = {}
        """How many packets the robot has sent, and received with each verdict."""

    def note(self, status: Status) -> None:
        """A status has arrived."""
        if status.item in _OF_NOW:
            return
        before = self._newest.get(status.item, 0)
        self._newest[status.item] = status.value
        # A robot that has rebooted begins anew at 0: the difference would be nearly the modulus.
        rise = (status.value - before) % _MODULUS
        rise = status.value if rise > _MODULUS // 2 else rise
        self.totals[status.item] = self.totals.get(status.item, 0) + rise

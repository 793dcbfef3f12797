# SPDX-License-Identifier: Apache-2.0
"""What the numbers in a robot's packets show about its program and its radio.

Packets to the station are numbered without gaps, from 1 at every boot. So a missing number is a
loss, and a number that comes twice is a copy. If two different packets bear one number, or if the
packets of an earlier boot go on while those of a later one arrive, two programs claim to be the
robot.
"""

from collections import deque
from dataclasses import dataclass, field

from palmbots.links.round_trips import RoundTrips, Stamp, quantile

_WINDOW_S = 5.0
_REMEMBERED = 600  # packets
_CLAIMS = 5
"""So many packets of the other program within `_CLAIM_S` count; a few old ones may be under way."""
_CLAIM_S = 1.0
_NEAR = 40
"""By how many numbers an overtaken packet may be behind: two seconds."""
_TRIPS = 40
_SLOW_S = 0.12
"""A packet of the station and the answer take up to two periods of the status on a fast radio."""


@dataclass
class _Fault:
    """A fault that begins above one share of the packets, and ends below another."""

    text: str
    begins: float
    ends: float
    is_on: bool = False

    def line(self, share: float) -> str | None:
        """A line if the fault begins now."""
        if self.is_on:
            self.is_on = share >= self.ends
            return None
        self.is_on = share >= self.begins
        return self.text.format(100 * share) if self.is_on else None


@dataclass
class RobotStream:
    """The stream of packets of one robot, as the station receives it."""

    newest: Stamp = (0, 0)
    """Epoch and number of the newest packet; (0, 0): none has arrived."""
    _tags: dict[Stamp, bytes] = field(default_factory=dict)
    _others: deque[tuple[float, Stamp]] = field(default_factory=deque)
    _other_newest: Stamp = (0, 0)
    _arrived: deque[tuple[float, int, str]] = field(default_factory=deque)
    _claim_said_s: float = -1e9

    def __post_init__(self) -> None:
        self._sent = RoundTrips()
        self._trips: deque[float] = deque(maxlen=_TRIPS)
        self._slow = _Fault("", _SLOW_S, 0.8 * _SLOW_S)
        self._faults = {
            "lost": _Fault("{:.0f} % of its packets are lost", 0.1, 0.05),
            "copy": _Fault("{:.0f} % of its packets arrive twice", 0.1, 0.05),
            "late": _Fault("{:.0f} % of its packets are overtaken by others", 0.05, 0.02),
        }

    def take(self, stamp: Stamp, data: bytes, now_s: float) -> list[str]:
        """An authentic packet has arrived; returns what there is to say about it."""
        lines = []
        kind = self._kind_of(stamp, data)
        if kind == "boot":
            if self.newest[0]:
                lines.append(f"has started again (boot {stamp[0]})")
                self._other_newest = self.newest
            self._arrived.clear()
            kind = "new"
        if kind == "other":
            self._others.append((now_s, stamp))
        if kind == "new":
            self.newest = stamp
        self._tags[stamp] = data
        if len(self._tags) > _REMEMBERED:
            del self._tags[next(iter(self._tags))]
        if kind != "other":
            self._arrived.append((now_s, stamp[1], kind))
        return lines + self._claim_lines(now_s) + self._link_lines(now_s)

    def note_sent(self, stamp: Stamp, now_s: float) -> None:
        """The station has sent a packet with this epoch and number to the robot."""
        self._sent.note_sent(stamp, now_s)

    def answer(self, acknowledged: Stamp, now_s: float) -> list[str]:
        """A new packet acknowledges this one of the station; returns what there is to say."""
        trip_s = self._sent.answered(acknowledged, now_s)
        if trip_s is not None:
            self._trips.append(trip_s)
        if len(self._trips) < _TRIPS:
            return []
        median_s = quantile(self._trips, 0.5)
        is_new = self._slow.line(median_s) is not None
        return [f"a packet and its answer take {median_s:.2f} s"] if is_new else []

    def is_claimed_twice(self, now_s: float) -> bool:
        """Two programs claim to be this robot."""
        while self._others and now_s - self._others[0][0] > _CLAIM_S:
            self._others.popleft()
        return len(self._others) >= _CLAIMS

    def _kind_of(self, stamp: Stamp, data: bytes) -> str:
        """``new``, ``boot``, ``copy``, ``late``, ``other`` (of another program), or ``old``."""
        if stamp[0] > self.newest[0]:
            return "boot"
        known = self._tags.get(stamp)
        if known is not None:
            return "copy" if known == data else "other"
        if stamp > self.newest:
            return "new"
        if stamp[0] == self.newest[0] and self.newest[1] - stamp[1] < _NEAR:
            return "late"
        # One that has never been seen, of a stream that is not the newest one: it lives.
        if stamp > self._other_newest or stamp[0] == self.newest[0]:
            self._other_newest = max(stamp, self._other_newest)
            return "other"
        return "old"

    def _claim_lines(self, now_s: float) -> list[str]:
        if not self.is_claimed_twice(now_s) or now_s - self._claim_said_s < 2 * _WINDOW_S:
            return []
        self._claim_said_s = now_s
        names = [f"boot {e}, packet {n}" for e, n in (self.newest, self._others[-1][1])]
        return [f"two programs claim to be this robot: {names[0]}, and {names[1]}"]

    def _link_lines(self, now_s: float) -> list[str]:
        while self._arrived and now_s - self._arrived[0][0] > _WINDOW_S:
            self._arrived.popleft()
        numbers = [number for _, number, kind in self._arrived if kind != "copy"]
        if len(numbers) < 40:
            return []
        sent = max(numbers) - min(numbers) + 1
        kinds = [kind for *_, kind in self._arrived]
        shares = {
            "lost": 1 - len(set(numbers)) / sent,
            "copy": kinds.count("copy") / len(kinds),
            "late": kinds.count("late") / len(kinds),
        }
        lines = (self._faults[name].line(share) for name, share in shares.items())
        return [line for line in lines if line is not None]

# SPDX-License-Identifier: Apache-2.0
"""What the statistics of a robot's packets mean for the operator: one line when a fault begins."""

from collections import deque
from dataclasses import dataclass

from palmbots.links.packet_statistics import EndStatistics, Kind, Stamp, quantile

_WINDOW_S = 5.0
_LEAST = 40
"""Packets within the window, or round trips, without which nothing is said."""
_CLAIMS = 5
"""So many packets of the other program within `_CLAIM_S` count; a few old ones may be under way."""
_CLAIM_S = 1.0
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


class RobotStream:
    """The stream of packets of one robot, as the station receives it.

    Args:
        end: the statistics of these packets.
    """

    def __init__(self, end: EndStatistics) -> None:
        self._end = end
        self._others: deque[tuple[float, Stamp]] = deque()
        self._claim_said_s = -1e9
        self._boots = 0
        self._slow = _Fault("", _SLOW_S, 0.8 * _SLOW_S)
        self._faults = {
            "lost": _Fault("{:.0f} % of its packets are lost", 0.1, 0.05),
            "copies": _Fault("{:.0f} % of its packets arrive twice", 0.1, 0.05),
            "overtaken": _Fault("{:.0f} % of its packets are overtaken by others", 0.05, 0.02),
        }

    @property
    def is_heard(self) -> bool:
        """A packet of the robot has arrived."""
        return self._end.newest != (0, 0)

    def lines(self, kind: Kind, stamp: Stamp, now_s: float) -> list[str]:
        """What there is to say about a packet that has arrived."""
        if kind == "other":
            self._others.append((now_s, stamp))
        lines = [f"has started again (boot {stamp[0]})"] if kind == "boot" and self._boots else []
        self._boots += kind == "boot"
        return lines + self._claim_lines(now_s) + self._link_lines(now_s) + self._slow_lines()

    def is_claimed_twice(self, now_s: float) -> bool:
        """Two programs claim to be this robot."""
        while self._others and now_s - self._others[0][0] > _CLAIM_S:
            self._others.popleft()
        return len(self._others) >= _CLAIMS

    def _claim_lines(self, now_s: float) -> list[str]:
        if not self.is_claimed_twice(now_s) or now_s - self._claim_said_s < 2 * _WINDOW_S:
            return []
        self._claim_said_s = now_s
        names = [f"boot {e}, packet {n}" for e, n in (self._end.newest, self._others[-1][1])]
        return [f"two programs claim to be this robot: {names[0]}, and {names[1]}"]

    def _link_lines(self, now_s: float) -> list[str]:
        recent = self._end.recent(now_s, _WINDOW_S)
        if recent is None or recent.count < _LEAST:
            return []
        lines = (fault.line(getattr(recent, name)) for name, fault in self._faults.items())
        return [line for line in lines if line is not None]

    def _slow_lines(self) -> list[str]:
        trips_s = self._end.round_trips_s[-_LEAST:]
        if len(trips_s) < _LEAST:
            return []
        median_s = quantile(trips_s, 0.5)
        is_new = self._slow.line(median_s) is not None
        return [f"a packet and its answer take {median_s:.2f} s"] if is_new else []

# SPDX-License-Identifier: Apache-2.0
"""Whether another station talks to the robots, or has done so: seen from what they have heard.

Every packet of a robot names the newest packet of a station that it knows, by the station's epoch
and number (docs/reference/wire.md). A station that has just started compares this with its own.
While the robots know of packets that it has not sent, it listens and sends nothing. If ever newer
packets are named meanwhile, another station is in use; otherwise one was, and this station takes
the next epoch.
"""

from dataclasses import dataclass
from typing import Literal

from palmbots._types import SIDES, Side

_LISTEN_S = 1.0
_STILL_S = 0.4
"""Another station is silent if no robot has named a newer packet of it for so long; packets that
it sent earlier may be under way for a while."""

Found = Literal["alone", "listening", "behind", "other"]
"""``behind``: the next epoch is to be taken; ``other``: another station is in use."""


@dataclass
class _Heard:
    """What one robot has named."""

    newest: tuple[int, int] = (0, 0)
    first_s: float = 0.0
    news_s: float = 0.0


class StationEpochs:
    """What the robots know of stations, compared with one station's own epoch."""

    def __init__(self, epoch: int) -> None:
        self._epoch = epoch
        self._foreign: dict[Side, _Heard] = {}
        self._in_session: set[Side] = set()
        self._taken_over = False

    @property
    def newest(self) -> int:
        """The highest epoch that a robot has named."""
        return max((heard.newest[0] for heard in self._foreign.values()), default=0)

    def take(self, side: Side, named: tuple[int, int], sent: int, now: float) -> None:
        """A robot has named a packet of a station.

        Args:
            side: which robot.
            named: epoch and number of the packet; (0, 0): it knows none.
            sent: how many packets this station has sent to it in its own epoch.
            now: the time [s].
        """
        epoch, number = named
        if epoch == self._epoch and number <= sent:
            self._in_session.add(side)
            self._foreign.pop(side, None)
            return
        if epoch in (0, self._epoch - 1):  # no station, or this one before its boot
            return
        if side in self._in_session:
            # It knew this station, and now knows a newer one.
            self._taken_over = self._taken_over or named > (self._epoch, sent)
            if not self._taken_over:
                return
        heard = self._foreign.setdefault(side, _Heard(named, now, now))
        if named > heard.newest:
            heard.newest, heard.news_s = named, now

    def found(self, now: float) -> Found:
        """What follows from all that has been heard."""
        if self._taken_over:
            return "other"
        found: Found = "alone"
        for side in SIDES:
            heard = self._foreign.get(side)
            if heard is None:
                continue
            if now - heard.first_s < _LISTEN_S:
                found = "listening"
            elif now - heard.news_s < _STILL_S:
                return "other"
            elif found == "alone" and heard.newest[0] >= self._epoch:
                found = "behind"
        return found

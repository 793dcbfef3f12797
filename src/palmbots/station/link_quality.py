# SPDX-License-Identifier: Apache-2.0
"""How good the radio between the station and a robot was in the last seconds."""

from collections import deque

from palmbots.links.round_trips import RoundTrips, Stamp, quantile

_WINDOW_S = 10.0


class LinkQuality:
    """Losses and round trips of one robot, from the numbers in its packets."""

    def __init__(self) -> None:
        self._arrived: deque[tuple[float, int, float | None]] = deque()
        self._trips = RoundTrips()
        self._epoch = 0

    def note_sent(self, stamp: Stamp, now: float) -> None:
        """The station has sent a packet with this epoch and sequence number."""
        self._trips.note_sent(stamp, now)

    def note_received(self, stamp: Stamp, acknowledged: Stamp, now: float) -> None:
        """A packet of the robot has arrived. Packets to the station leave no gap in the sequence,
        so a gap is a loss."""
        epoch, number = stamp
        if epoch != self._epoch:  # the robot has booted, and counts anew
            self._arrived.clear()
            self._epoch = epoch
        self._arrived.append((now, number, self._trips.answered(acknowledged, now)))

    def loss(self, now: float) -> float | None:
        """Fraction of the robot's packets that were lost; None: too few arrived to say."""
        self._forget(now)
        if len(self._arrived) < 2:
            return None
        sent = self._arrived[-1][1] - self._arrived[0][1] + 1
        return max(0.0, 1 - len(self._arrived) / sent)

    def round_trip_s(self, now: float) -> float | None:
        """Median time from a packet of the station to the first packet that acknowledges it. It
        contains the time until the robot reports and the station looks. None: unknown."""
        self._forget(now)
        trips = [trip for _, _, trip in self._arrived if trip is not None]
        return quantile(trips, 0.5) if trips else None

    def _forget(self, now: float) -> None:
        while self._arrived and now - self._arrived[0][0] > _WINDOW_S:
            self._arrived.popleft()

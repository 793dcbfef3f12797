# SPDX-License-Identifier: Apache-2.0
"""Times from a packet to the first one that acknowledges it."""

import math
from collections.abc import Sequence

Stamp = tuple[int, int]
"""Epoch and sequence number of a packet."""
_MOST_UNANSWERED = 600


class RoundTrips:
    """Measures the round trips of packets that are answered out of order, or never."""

    def __init__(self) -> None:
        self._sent_s: dict[Stamp, float] = {}

    def note_sent(self, stamp: Stamp, now_s: float) -> None:
        """A packet is being sent."""
        self._sent_s[stamp] = now_s
        if len(self._sent_s) > _MOST_UNANSWERED:
            del self._sent_s[next(iter(self._sent_s))]

    def answered(self, acknowledged: Stamp, now_s: float) -> float | None:
        """The round trip [s] that this acknowledgement ends; None: it ends none."""
        sent_s = self._sent_s.pop(acknowledged, None)
        return None if sent_s is None else now_s - sent_s


def quantile(values: Sequence[float], fraction: float) -> float:
    """The smallest value that is not exceeded by this fraction of them; NaN: there is none."""
    ordered = sorted(values)
    if not ordered:
        return math.nan
    return ordered[max(0, math.ceil(fraction * len(ordered)) - 1)]

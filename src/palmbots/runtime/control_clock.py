# SPDX-License-Identifier: Apache-2.0
"""The ticks of a control loop on the monotonic clock.

A loop that is late never catches up in bursts: it learns how many ticks have passed, and continues
with the next one that is still to come.
"""

import time
from collections import deque

_RECENT_TICKS = 100


class ControlClock:
    """Waits for the ticks of a control loop.

    Args:
        period_s: time between two ticks.
    """

    def __init__(self, period_s: float) -> None:
        self._period_s = period_s
        self._next_s = time.monotonic() + period_s
        self.overruns = 0
        """Ticks that were missed."""
        self._recent: deque[int] = deque([0] * _RECENT_TICKS, maxlen=_RECENT_TICKS)
        self.jitter_s: list[int] = [0] * 6
        """How many ticks began late by less than 0.1, 0.3, 1, 3, 10 ms, and by more."""

    @property
    def recent_overruns(self) -> int:
        """Ticks that were missed in the last 100 calls of `wait`."""
        return sum(self._recent)

    def wait(self) -> int:
        """Wait for the next tick; returns the number of ticks since the last call, at least 1."""
        now = time.monotonic()
        if now < self._next_s:
            time.sleep(self._next_s - now)
            now = time.monotonic()
        late_s = now - self._next_s
        self.jitter_s[sum(late_s >= limit for limit in (1e-4, 3e-4, 1e-3, 3e-3, 1e-2))] += 1
        missed = int(late_s / self._period_s)
        self.overruns += missed
        self._recent.append(missed)
        self._next_s += (1 + missed) * self._period_s
        return 1 + missed

# SPDX-License-Identifier: Apache-2.0
"""The ticks of a control loop on the monotonic clock.

A loop that is late never catches up in bursts: it learns how many ticks have passed, and continues
with the next one that is still to come.
"""

import time
from collections import deque
from collections.abc import Sequence

from palmbots.clocks.clock import Clock
from palmbots.clocks.stepped_clock import SteppedClock, stepper_address
from palmbots.links.link import Link

JITTER_LIMITS_MS = (0.1, 0.3, 1.0, 3.0, 10.0)
_RECENT_TICKS = 100


class ControlClock:
    """Waits for the ticks of a control loop.

    Args:
        period_s: time between two ticks.
        stride: ticks between two steps of the loop.
    """

    is_stepped = False

    def __init__(self, period_s: float, stride: int = 1) -> None:
        self._period_s, self._stride = stride * period_s, stride
        self._next_s: float | None = None
        self.overruns = 0
        """Steps that were missed."""
        self._recent: deque[int] = deque([0] * _RECENT_TICKS, maxlen=_RECENT_TICKS)
        self.jitter: list[int] = [0] * (len(JITTER_LIMITS_MS) + 1)
        """How many ticks began late by less than each of `JITTER_LIMITS_MS`, and by more."""

    @property
    def recent_overruns(self) -> int:
        """Steps that were missed in the last 100 calls of `wait`."""
        return sum(self._recent)

    def wait(self) -> int:
        """Wait for the next step; returns the number of ticks since the last one."""
        now = time.monotonic()
        if self._next_s is None:
            self._next_s = now + self._period_s
        if now < self._next_s:
            time.sleep(self._next_s - now)
            now = time.monotonic()
        late_s = now - self._next_s
        self.jitter[sum(1e3 * late_s >= limit for limit in JITTER_LIMITS_MS)] += 1
        missed = int(late_s / self._period_s)
        self.overruns += missed
        self._recent.append(missed)
        self._next_s += (1 + missed) * self._period_s
        return self._stride * (1 + missed)

    def run_at(self, rate: float) -> None:
        """Run faster than the clock of this computer, as the wrong clock of a simulated robot."""
        self._period_s /= rate

    def forget(self) -> None:
        """Start the count of `recent_overruns` anew, as a program does at a boot."""
        self._recent.extend([0] * _RECENT_TICKS)

    def link(self, link: Link) -> Link:
        """The link as this clock needs it."""
        return link


def control_clock(name: str, period_s: float, stride: int = 1) -> Clock:
    """The clock of a program: the system's, or one that another program steps.

    Args:
        name: of the program.
        period_s: time between two ticks.
        stride: ticks between two steps of the program.
    """
    address = stepper_address()
    if address is None:
        return ControlClock(period_s, stride)
    return SteppedClock(name, address, stride)


def jitter_table(counts: Sequence[int]) -> dict[str, int]:
    """The histogram of `ControlClock.jitter` with its limits as names."""
    names = [f"< {limit:g} ms" for limit in JITTER_LIMITS_MS]
    return dict(zip([*names, f">= {JITTER_LIMITS_MS[-1]:g} ms"], counts, strict=True))

# SPDX-License-Identifier: Apache-2.0
"""How much of a work in parts is done, by the time that its parts take on this machine."""

from __future__ import annotations

import time
from collections.abc import Callable

from palmbots._util.text import duration

_WAIT_S = 2.0
_EARLY = 0.04  # of the work: then its pace is known
_LEAST_LEFT = 0.2  # of what a part was expected to take, while its own pace is not known


class TimeLeft:
    """The completed fraction: the time spent, as a share of it and of the time that is left.

    What is left of a part follows from the pace of that part. Parts that have not begun take as
    long as expected, and may be expected anew whenever more is known. The fraction never falls, and
    stays as it is while nothing is known of the time that is left.

    Args:
        report: called with the fraction.
        parts: in their order.
        clock: in s.
    """

    def __init__(
        self,
        report: Callable[[float], None],
        parts: tuple[str, ...],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._report, self._clock = report, clock
        self._begin = self._part_begin = clock()
        self._expected_s = dict.fromkeys(parts, 0.0)
        self._fraction = 0.0

    def expect(self, **seconds: float) -> None:
        """Parts that have not begun take so long."""
        self._expected_s |= {part: s for part, s in seconds.items() if part in self._expected_s}

    @property
    def total_s(self) -> float:
        """The time spent, and what the parts that have not begun are expected to take."""
        return self._clock() - self._begin + sum(self._expected_s.values())

    def begin(self, part: str) -> Callable[[float], None]:
        """A part begins; returns what to call with the completed fraction of it."""
        expected_s = self._expected_s.pop(part)
        self._part_begin = self._clock()

        def report(done: float) -> None:
            spent_s = self._clock() - self._part_begin
            if done > 0.05:
                self._show(spent_s * (1 - done) / done)
            elif expected_s > 0:
                self._show(max(expected_s - spent_s, _LEAST_LEFT * expected_s))
            else:
                self._report(self._fraction)

        report(0.0)
        return report

    def spent_s(self) -> float:
        """The time since the present part began."""
        return self._clock() - self._part_begin

    def _show(self, left_s: float) -> None:
        spent_s = self._clock() - self._begin
        left_s += sum(self._expected_s.values())
        if spent_s > 0:
            self._fraction = max(self._fraction, spent_s / (spent_s + left_s))
        self._report(self._fraction)


def announced(
    report: Callable[[float], None],
    on_line: Callable[[str], None],
    what: str,
    clock: Callable[[], float] = time.monotonic,
) -> Callable[[float], None]:
    """Report the completed fraction, and state once how long the whole work takes, as soon as its
    pace is known; nothing for work of up to two seconds.

    Args:
        report: called with the fraction, which has to follow the time.
        on_line: called with the line.
        what: the work.
        clock: in s.
    """
    begin, is_known = clock(), False

    def pass_on(fraction: float) -> None:
        nonlocal is_known
        report(fraction)
        if is_known or not _EARLY <= fraction < 1:
            return
        is_known = True
        total_s = (clock() - begin) / fraction
        if total_s > _WAIT_S:
            on_line(f"{what} takes about {duration(float(f'{total_s:.2g}'))}")

    return pass_on

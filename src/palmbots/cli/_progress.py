# SPDX-License-Identifier: Apache-2.0
"""Progress on stderr: a bar in a terminal, a line a minute in a log file or batch job."""

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import TextIO

from palmbots.cli._warnings import print_held_warnings

_LINE_INTERVAL_S = 60.0
_CHECKS = ("checking the policy", "checking scenes", "forecasting the drift")
"""Stages after which the input may still be refused."""

StageReport = Callable[..., None]
"""Called with the name of the present stage, the fraction of it that is complete, and optionally a
note that the bar shows beside the name."""


class Estimate:
    """The time that is left of a stage: as long as the rest takes at the pace so far.

    Args:
        clock: in s.
        of: words after the time, such as " of this part"; empty: it is that of the whole work.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic, of: str = "") -> None:
        self._clock, self._of = clock, of
        self.begin()

    def begin(self) -> None:
        """A stage begins."""
        self._start = self._last = self._clock()
        self._fraction = 0.0

    def report(self, fraction: float) -> None:
        """So much of the stage is complete."""
        if fraction > self._fraction:
            self._fraction, self._last = fraction, self._clock()

    @property
    def spent_s(self) -> float:
        """The time since the stage began."""
        return self._clock() - self._start

    def text(self) -> str:
        """The time that is left, in words. It counts down between two reports, and claims
        nothing once more time has passed than was left."""
        if self._fraction >= 1:
            return "finishing"
        if self._fraction <= 0:
            return "time left unknown"
        worked_s = self._last - self._start
        left_s = worked_s / self._fraction - self.spent_s
        if left_s <= 0:
            return "takes longer than expected"
        return f"about {_duration(max(left_s, 1.0))} left{self._of}"


class LineProgress:
    """Prints at most one line a minute; prints nothing for work that takes less.

    Args:
        stream: where to.
        clock: in s.
        of: as of `Estimate`.
    """

    def __init__(
        self, stream: TextIO, clock: Callable[[], float] = time.monotonic, of: str = ""
    ) -> None:
        self._stream, self._clock, self._estimate = stream, clock, Estimate(clock, of)
        self._stage = ""
        self._last_line = clock()

    def report(self, stage: str, fraction: float, note: str = "") -> None:
        """Print the stage, its fraction and an estimate of the time left, if a line is due."""
        if stage != self._stage:
            if self._stage:  # the first one began when this was made
                self._estimate.begin()
            self._stage = stage
        self._estimate.report(fraction)
        now = self._clock()
        if now - self._last_line < _LINE_INTERVAL_S:
            return
        self._last_line = now
        percent = int(100 * min(fraction, 1.0))
        spent = _duration(self._estimate.spent_s)
        line = f"palmbots: {stage}: {percent} % after {spent}, {self._estimate.text()}"
        with contextlib.suppress(OSError):  # a full disk, or a closed pipe
            print(line, file=self._stream, flush=True)


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes}:{rest:02} min"
    return f"{minutes // 60}:{minutes % 60:02} h"


@contextmanager
def staged_progress(quiet: bool = False, of: str = " of this part") -> Iterator[StageReport]:
    """Show the progress of work in stages; yields the function to call with stage and fraction.

    The time left is that of the present stage, which the words `of` state. `quiet` suppresses the
    bar, not the lines of a batch job. Warnings that are held are printed when a stage begins that
    does more than check the input.
    """
    with _display(quiet, of) as show:

        def report(stage: str, fraction: float, note: str = "") -> None:
            if stage not in _CHECKS:
                print_held_warnings()
            show(stage, fraction, note)

        yield report


@contextmanager
def _display(quiet: bool, of: str) -> Iterator[StageReport]:
    """A bar in a terminal, lines elsewhere."""
    terminal = sys.stderr is not None and sys.stderr.isatty()
    if sys.stderr is not None and not terminal:
        yield LineProgress(sys.stderr, of=of).report
        return
    if quiet or not terminal:
        yield lambda stage, fraction, note="": None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn
    from rich.text import Text

    estimate = Estimate(of=of)

    class Left(ProgressColumn):
        """The estimate; Rich's own column takes only the last seconds into account."""

        def render(self, task: Task) -> Text:
            return Text(estimate.text(), style="progress.remaining")

    columns = (TextColumn("{task.description}"), BarColumn(), Left())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        tasks = {}
        present = ""

        def report(stage: str, fraction: float, note: str = "") -> None:
            nonlocal present
            if stage not in tasks:
                for task in tasks.values():
                    bar.update(task, visible=False)
                tasks[stage] = bar.add_task(stage, total=1.0)
            if stage != present:
                if present:
                    estimate.begin()
                present = stage
            estimate.report(fraction)
            bar.update(tasks[stage], completed=fraction, description=stage + note)

        yield report


@contextmanager
def progress(stage: str, quiet: bool = False) -> Iterator[Callable[[float], None]]:
    """Show the progress of one stage; yields the function to call with the fraction."""
    with staged_progress(quiet, of="") as report:
        yield partial(report, stage)

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


class LineProgress:
    """Prints at most one line a minute; prints nothing for work that takes less."""

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream, self._clock = stream, clock
        self._stage = ""
        self._last_fraction = 0.0
        self._stage_start = self._last_line = clock()

    def report(self, stage: str, fraction: float, note: str = "") -> None:
        """Print the stage, its fraction and an estimate of the time left, if a line is due."""
        now = self._clock()
        if stage != self._stage:
            self._stage, self._stage_start, self._last_fraction = stage, now, 0.0
        if now - self._last_line < _LINE_INTERVAL_S:
            return
        self._last_line = now
        spent = now - self._stage_start
        left = ", time left unknown"
        if self._last_fraction < fraction < 1:
            left = f", about {_duration(spent * (1 - fraction) / fraction)} left"
        self._last_fraction = fraction
        percent = int(100 * min(fraction, 1.0))
        line = f"palmbots: {stage}: {percent} % after {_duration(spent)}{left}"
        with contextlib.suppress(OSError):  # a full disk, or a closed pipe
            print(line, file=self._stream, flush=True)


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes}:{rest:02} min"
    return f"{minutes // 60}:{minutes % 60:02} h"


@contextmanager
def staged_progress(quiet: bool = False) -> Iterator[StageReport]:
    """Show the progress of work in stages; yields the function to call with stage and fraction.

    `quiet` suppresses the bar, not the lines of a batch job. Warnings that are held are printed
    when a stage begins that does more than check the input.
    """
    with _display(quiet) as show:

        def report(stage: str, fraction: float, note: str = "") -> None:
            if stage not in _CHECKS:
                print_held_warnings()
            show(stage, fraction, note)

        yield report


@contextmanager
def _display(quiet: bool) -> Iterator[StageReport]:
    """A bar in a terminal, lines elsewhere."""
    terminal = sys.stderr is not None and sys.stderr.isatty()
    if sys.stderr is not None and not terminal:
        yield LineProgress(sys.stderr).report
        return
    if quiet or not terminal:
        yield lambda stage, fraction, note="": None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        tasks = {}

        def report(stage: str, fraction: float, note: str = "") -> None:
            if stage not in tasks:
                for task in tasks.values():
                    bar.update(task, visible=False)
                tasks[stage] = bar.add_task(stage, total=1.0)
            bar.update(tasks[stage], completed=fraction, description=stage + note)

        yield report


@contextmanager
def progress(stage: str, quiet: bool = False) -> Iterator[Callable[[float], None]]:
    """Show the progress of one stage; yields the function to call with the fraction."""
    with staged_progress(quiet) as report:
        yield partial(report, stage)

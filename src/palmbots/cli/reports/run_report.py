# SPDX-License-Identifier: Apache-2.0
"""The verification of the logs of a run, as text."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from palmbots.cli.reports.console import (
    BAD,
    GOOD,
    plain_table,
    print_written_files,
    report_console,
)

if TYPE_CHECKING:
    from palmbots.views.run_replay import RunReplay


def run_replay_report(result: "RunReplay", written: Sequence[Path]) -> None:
    """Print for each log whether the program decides the same, and how its clock relates."""
    console = report_console()
    ticks = sum(log.verified for log in result.logs)
    if result.identical:
        head = Text("IDENTICAL", style=GOOD)
        console.print(head.append(f"  {ticks} decisions agree bit for bit", "default"))
    else:
        console.print(Text("DIFFERS", style=BAD))
    table = plain_table("log", "ticks", "equal", "clock against the first log", right=("ticks",))
    clocks = ["", *(_clock(clock) for clock in result.clocks)]
    for log, clock in zip(result.logs, clocks, strict=True):
        name = Path(log.file).name + (" (cut off)" if log.is_cut else "")
        equal = "" if log.end == "station" else str(log.verified)
        table.add_row(name, str(log.ticks) if log.ticks else "", equal, clock)
    console.print(table)
    for log in result.logs:
        if log.difference is not None:
            console.print(f"{Path(log.file).name}: {log.difference}", soft_wrap=True)
    print_written_files(console, written)


def _clock(clock: object) -> str:
    offset: float | None = clock.offset_s  # type: ignore[attr-defined]
    if offset is None:
        return "unknown: no packets connect them"
    rate: float = clock.rate  # type: ignore[attr-defined]
    margin: float = clock.uncertainty_s  # type: ignore[attr-defined]
    return f"{offset:+.3f} ± {margin:.3f} s, rate {1e6 * (rate - 1):+.0f} ppm"

# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots bound`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from palmbots.cli.reports.console import (
    QUIET,
    plain_table,
    print_written_files,
    report_console,
)

if TYPE_CHECKING:
    from palmbots.optimum.drop_bound import Bound


def bound_report(result: "Bound", scene: str, written: Sequence[Path]) -> None:
    """Print the noise, what it means, and the least drop rate over the duration."""
    console = report_console()
    head = Text(f"σ* at most {100 * result.sigma_star_m_s:.3g} cm/s", style="bold")
    error = 100 * result.grid_error
    console.print(head.append(f", error of the grids {error:.2f} %", "not bold"))
    console.print(f"{scene}, {result.speeds}", style=QUIET)
    console.print(
        f"at more noise, every controller drops the object in more than {100 * result.rate:g} % of "
        "carries"
    )
    console.print(
        f"least drop rate at the scene's noise of {100 * result.noise_m_s:g} cm/s: "
        f"{_rate(result.drop_rate)}"
    )
    console.print(
        f"u = {100 * result.opening_speed_m_s:.3g} cm/s, L = {100 * result.usable_m:.3g} cm: the "
        f"law √(uL/11τ) gives {100 * result.law_m_s:.3g} cm/s",
        style=QUIET,
    )
    if result.front:
        heads = ("mean duration (s)", "least drop rate (%)")
        table = plain_table(*heads, right=heads)
        for point in result.front:
            table.add_row(f"{point.time_s:.1f}", f"{100 * point.drop_rate:.3g}")
        console.print(table)
        console.print(f"at the noise of {100 * result.sigma_star_m_s:.3g} cm/s", style=QUIET)
    elif result.speeds == "corrections":
        console.print(
            f"for carries that take at least their nominal time, {result.time_s:.1f} s", style=QUIET
        )
    print_written_files(console, written)


def _rate(rate: float) -> str:
    return f"{rate:.2g}" if rate >= 1e-9 else "below 1e-9"

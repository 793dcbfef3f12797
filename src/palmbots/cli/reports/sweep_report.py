# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots compare`, `drop-rate` and `noise-limit`."""

import math
import re
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from palmbots._util.text import format_number, plural
from palmbots.cli.reports.console import (
    QUIET,
    plain_table,
    print_written_files,
    report_console,
)

if TYPE_CHECKING:
    from palmbots.simulation.noise_limit import NoiseLimit
    from palmbots.simulation.rare_events import DropRate
    from palmbots.simulation.sweep import Comparison, Row

_RADIO_BITS_S = 250_000  # of a small packet radio, for example IEEE 802.15.4
_LONGEST_HEAD = 17


def compare_report(comparison: "Comparison", written: Sequence[Path]) -> None:
    """Print one row for each controller and value."""
    console = report_console()
    rows = comparison.rows
    console.print(
        f"{plural(rows[0].n, 'carry')} per value and controller, seeds from {comparison.seed}; "
        "intervals: 95 %"
    )
    key_head = _key_head(comparison.key)
    heads = (key_head, "dropped [%]", "contact\nrms [mm]", "messages\nper m", "B/s")
    table = plain_table("controller", *heads, right=heads, gap=2)
    previous = None
    for row in rows:
        is_first = row.controller != previous
        if is_first and previous is not None:
            table.add_section()
        table.add_row(row.controller if is_first else "", *_cells(row))
        previous = row.controller
    console.print(table)
    stalled = sum(round(row.stall_rate * row.n) for row in rows)
    if stalled:
        console.print(f"{plural(stalled, 'carry')} stalled: neither delivered nor dropped in time")
    busiest = max(row.bytes_per_s for row in rows)
    if busiest > 0:
        from palmbots.wire import PACKET_SIZE

        console.print(
            f"B/s: bytes on the air in packets of {PACKET_SIZE} bytes; at most "
            f"{8e2 * busiest / _RADIO_BITS_S:.1f} % of a {_RADIO_BITS_S // 1000} kbit/s radio",
            style=QUIET,
        )
    for line in refusal_lines(comparison):
        console.print(line)
    print_written_files(console, written)


def refusal_lines(comparison: "Comparison") -> list[str]:
    """One line for each reason of a refusal, with all values to which it applies.

    Reasons that differ only in their numbers count as one; the line quotes the first.
    """
    groups: dict[tuple[str, str], list[tuple[str, str]]] = defaultdict(list)
    for one in comparison.refusals:
        template = re.sub(r"[-+\d.e]+", "", one.reason)
        groups[one.controller, template].append((format_number(one.value), one.reason))
    lines = []
    for (controller, _), found in groups.items():
        values = ", ".join(value for value, _ in found)
        first_value, first = found[0]
        at_first = f"at {first_value}: " if len({reason for _, reason in found}) > 1 else ""
        lines.append(f"{controller} refuses {comparison.key} = {values}: {at_first}{first}")
    return lines


def _key_head(key: str) -> str:
    """The key as the head of a column; a long one takes two lines."""
    section, _, name = key.rpartition(".")
    return key if len(key) <= _LONGEST_HEAD or not section else f"{section}.\n{name}"


def _cells(row: "Row") -> list[str]:
    low, high = (100 * end for end in row.interval)
    half = 0.5 * (row.rms_interval_m[1] - row.rms_interval_m[0])
    spread = "" if math.isnan(half) else f" ± {1e3 * half:.1f}"
    return [
        format_number(row.value),
        f"{100 * row.drop_rate:.1f} ({low:.1f}–{high:.1f})",
        f"{1e3 * row.rms_m:.1f}{spread}",
        f"{row.messages_per_m:.0f}",
        f"{row.bytes_per_s:.0f}",
    ]


def noise_limit_report(result: "NoiseLimit", scene: str, written: Sequence[Path]) -> None:
    """Print the noise, its interval, and the drop rates it was fitted to."""
    console = report_console()
    low, high = (100 * end for end in result.interval)
    head = Text(f"σ* = {100 * result.sigma_star_m_s:.3g} cm/s", style="bold")
    console.print(head.append(f", 95 % {low:.3f} to {high:.3f}", "not bold"))
    console.print(f"{scene}, {result.controller}, seed {result.seed}", style=QUIET)
    console.print(f"at robot.noise_m_s = σ*, {100 * result.rate:g} % of carries drop the object")
    heads = ("noise (cm/s)", "carries", "dropped % (95 %)")
    table = plain_table(*heads, right=heads)
    for point in result.points:
        if point.counts:
            ends = "–".join(f"{100 * end:.2f}" for end in point.interval)
            table.add_row(
                f"{100 * point.noise_m_s:.3f}",
                f"{point.carries:,}",
                f"{100 * point.drop_rate:.2f} ({ends})",
            )
    console.print(table)
    console.print(
        f"fitted to these carries; {result.pilot_carries:,} carries of a pilot run found where",
        style=QUIET,
    )
    print_written_files(console, written)


def drop_rate_report(result: "DropRate", scene: str) -> None:
    """Print the rate, and the levels of the splitting."""
    console = report_console()
    low, high = result.interval
    head = Text(f"drop rate {result.drop_rate:.2g}", style="bold")
    console.print(head.append(f", 95 % {low:.2g} to {high:.2g}", "not bold"))
    console.print(f"{scene}, {result.controller}, seed {result.seed}", style=QUIET)
    if 0 < result.drop_rate < 0.1:
        console.print(f"one carry in {1 / result.drop_rate:,.0f} drops the object")
    if result.levels:
        heads = ("level (% of the palm's half-length)", "reached from the level before")
        table = plain_table(*heads, right=heads)
        for level, part in zip(result.levels, result.conditional_probabilities, strict=True):
            table.add_row(f"{100 * level:.0f} %", f"{100 * part:.1f} %")
        console.print(table)
    console.print(
        f"{plural(result.replicates, 'replicate')} of {plural(result.effort, 'carry')} per stage; "
        f"cost: as {result.equivalent_carries:,.0f} whole carries",
        style=QUIET,
    )

# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots validate` and `palmbots speed-limits`."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from palmbots._util.optional_imports import install_command
from palmbots._util.text import plural
from palmbots.cli.reports.console import (
    BAD,
    GOOD,
    QUIET,
    plain_table,
    print_written_files,
    report_console,
)

if TYPE_CHECKING:
    from rich.console import Console

    from palmbots.mujoco.validation.speed_limits import SpeedLimits
    from palmbots.mujoco.validation.validation import Validation


def validation_report(validation: "Validation", written: Sequence[Path]) -> None:
    """Print how well the MuJoCo world agrees with the quasistatic one."""
    console = report_console()
    own = validation.agreement[0]
    head = Text(
        "AGREES" if validation.holds else "DIFFERS", style=GOOD if validation.holds else BAD
    )
    head.append(
        f"  {100 * own.decisive_rate:.1f} % of {own.decisive_n} states with a margin above 1°",
        style="bold",
    )
    console.print(head)
    _agreement(console, validation)
    creep = max(map(abs, validation.creep_m))
    console.print(f"a sticking contact drifts {1e3 * creep:.2f} mm in 25 s at 5° and 15°")
    errors = [
        abs(line.seen_m - line.known_m)
        for line in validation.lines
        if line.seen_m is not None and line.known_m is not None
    ]
    if errors:
        console.print(f"switch lines agree within {1e3 * max(errors):.1f} mm of COM")
    error = max(
        abs(seen - known)
        for t in validation.tilts
        for seen, known in zip(t.seen_m, t.known_m, strict=True)
    )
    console.print(f"displacements caused by a tilt agree within {1e3 * error:.1f} mm")
    _paired_carries(console, validation)
    print_written_files(console, written)


def _agreement(console: "Console", validation: "Validation") -> None:
    heads = ("margin > 1°", "95 % interval", "all states")
    table = plain_table("which contact slides", *heads, right=heads)
    for one in validation.agreement:
        low, high = one.decisive_interval
        table.add_row(
            one.engine,
            f"{100 * one.decisive_rate:.1f} % of {one.decisive_n}",
            f"{100 * low:.1f} to {100 * high:.1f} %",
            f"{100 * one.rate:.1f} % of {one.n}",
        )
    console.print(table)
    for one in validation.agreement:
        causes = Counter(
            t.cause for t in validation.trials if t.engine == one.engine and t.cause is not None
        )
        for cause, n in sorted(causes.items()):
            console.print(f"  {one.engine}: {plural(n, 'difference')}: {cause}", style=QUIET)
    if validation.missing:
        console.print(
            f"  not installed: {', '.join(validation.missing)} (run: {install_command('bench')})",
            style=QUIET,
        )


def _paired_carries(console: "Console", validation: "Validation") -> None:
    pairs = validation.pairs
    heads = ("quasistatic", "mujoco")
    table = plain_table(f"{plural(len(pairs), 'carry')} paired by seed", *heads, right=heads)
    for name, value in (
        ("delivered", lambda p, k: p.outcome[k] == "delivered"),
        ("contact rms, mean [mm]", lambda p, k: 1e3 * p.rms_m[k] / len(pairs)),
        ("corrections, mean", lambda p, k: p.corrections[k] / len(pairs)),
    ):
        sums = [sum(value(p, k) for p in pairs) for k in (0, 1)]
        table.add_row(name, *(f"{s}" if isinstance(s, int) else f"{s:.1f}" for s in sums))
    peaks = [1e3 * max(p.peak_m[k] for p in pairs) for k in (0, 1)]
    table.add_row("contact peak, largest [mm]", *(f"{peak:.1f}" for peak in peaks))
    console.print(table)
    delivery = validation.delivery
    low, high = delivery.interval
    console.print(
        f"delivered: mujoco {100 * low:.0f} to {100 * high:.0f} % (95 %), quasistatic "
        f"{100 * delivery.known:.1f} %"
    )
    different = sum(p.outcome[0] != p.outcome[1] for p in pairs)
    if different:
        console.print(f"  {plural(different, 'pair')} with different outcomes", style=QUIET)


def speed_report(limits: "SpeedLimits", written: Sequence[Path]) -> None:
    """Print the largest acceleration, and carries at several speeds."""
    console = report_console()
    console.print(
        "Largest acceleration at which the same contact slides as at constant speed, at "
        "p = 0 [m/s²]",
        style="bold",
    )
    heads = ("friction", "closed form", "mujoco")
    table = plain_table("", *heads, right=heads)
    for limit in limits.limits:
        motion = "closing" if limit.closing else "opening"
        phase = "accelerating" if limit.forward else "braking"
        numbers = ("4 or more" if x is None else f"{x:.2f}" for x in (limit.known, limit.seen))
        table.add_row(f"{motion}, {phase}", f"{limit.friction:g}", *numbers)
    console.print(table)
    if limits.analyzed is not None:
        console.print(
            f"both properties hold on the whole palms up to {limits.analyzed:.2f} m/s² "
            "(palmbots analyze)"
        )
    heads = ("delivered", "contact rms [mm]", "contact peak [mm]")
    table = plain_table("speed", *heads, right=heads)
    for pace in limits.paces:
        delivered, rms, peak = pace.delivered, pace.rms_m, pace.peak_m
        table.add_row(
            f"{pace.speed_m_s:g} m/s",
            f"{delivered[0]}, {delivered[1]} of {pace.n}",
            f"{1e3 * rms[0]:.1f}, {1e3 * rms[1]:.1f}",
            f"{1e3 * peak[0]:.1f}, {1e3 * peak[1]:.1f}",
        )
    console.print(table)
    console.print("pairs of numbers: quasistatic, mujoco", style=QUIET)
    print_written_files(console, written)

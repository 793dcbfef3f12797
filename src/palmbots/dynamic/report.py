"""What the commands of the dynamic world print for people."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from palmbots.report import console_for_people, counted, files_written

if TYPE_CHECKING:
    from palmbots.dynamic.speed import SpeedLimits
    from palmbots.dynamic.validation import Validation

__all__ = ["speed_report", "validation_report"]

_GOOD, _BAD, _QUIET = "bold green", "bold red", "dim"


def _table(*heads: str) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 3, 0, 0), show_header=True)
    for k, head in enumerate(heads):
        table.add_column(head, justify="left" if k == 0 else "right", header_style="bold")
    return table


def validation_report(done: "Validation", written: Sequence[Path]) -> None:
    """How far the dynamic world agrees with the quasistatic one."""
    console = console_for_people()
    own = done.agreement[0]
    head = Text("AGREES" if done.holds else "DIFFERS", style=_GOOD if done.holds else _BAD)
    head.append(
        f"  {100 * own.decisive_rate:.1f} % of {own.decisive_n} decisive states", style="bold"
    )
    console.print(head)
    table = _table("which contact slides", "margin > 1°", "95 % interval", "all states")
    for one in done.agreement:
        low, high = one.decisive_interval
        table.add_row(
            one.engine,
            f"{100 * one.decisive_rate:.1f} % of {one.decisive_n}",
            f"{100 * low:.1f} to {100 * high:.1f} %",
            f"{100 * one.rate:.1f} % of {one.n}",
        )
    console.print(table)
    for one in done.agreement:
        causes = Counter(
            t.cause for t in done.trials if t.engine == one.engine and t.cause is not None
        )
        for cause, n in sorted(causes.items()):
            console.print(f"  {one.engine}: {n} differ, {cause}", style=_QUIET)
    if done.missing:
        console.print(
            f"  not installed: {', '.join(done.missing)} (pip install 'palmbots[bench]')",
            style=_QUIET,
        )
    creep = max(map(abs, done.creep_m))
    console.print(f"a sticking contact drifts {1e3 * creep:.2f} mm in 25 s at 5° and 15°")
    off = [
        abs(line.seen_m - line.known_m)
        for line in done.lines
        if line.seen_m is not None and line.known_m is not None
    ]
    if off:
        console.print(f"switch lines lie within {1e3 * max(off):.1f} mm of COM")
    apart = max(
        abs(seen - known)
        for t in done.tilts
        for seen, known in zip(t.seen_m, t.known_m, strict=True)
    )
    console.print(f"slides caused by a tilt agree within {1e3 * apart:.1f} mm")
    pairs = done.pairs
    alike = sum(p.outcome[0] == p.outcome[1] for p in pairs)
    table = _table(f"{counted(len(pairs), 'carry')} paired by seed", "quasistatic", "mujoco")
    for k_name, value in (
        ("delivered", lambda p, k: p.outcome[k] == "delivered"),
        ("contact rms, mean (mm)", lambda p, k: 1e3 * p.rms_m[k] / len(pairs)),
        ("corrections, mean", lambda p, k: p.corrections[k] / len(pairs)),
    ):
        sums = [sum(value(p, k) for p in pairs) for k in (0, 1)]
        table.add_row(k_name, *(f"{s}" if isinstance(s, int) else f"{s:.1f}" for s in sums))
    peaks = [1e3 * max(p.peak_m[k] for p in pairs) for k in (0, 1)]
    table.add_row("contact peak, largest (mm)", *(f"{peak:.1f}" for peak in peaks))
    console.print(table)
    told = done.delivery
    low, high = told.interval
    console.print(
        f"mujoco delivers {100 * low:.0f} to {100 * high:.0f} % (95 %), the quasistatic world "
        f"{100 * told.known:.1f} %"
    )
    if alike < len(pairs):
        console.print(f"  {len(pairs) - alike} of them ended otherwise", style=_QUIET)
    files_written(console, written)


def speed_report(done: "SpeedLimits", written: Sequence[Path]) -> None:
    """How hard the pair may accelerate, and how fast it may go."""
    console = console_for_people()
    console.print("The same contact slides as at rest, at p = 0, up to (m/s²)", style="bold")
    table = _table("", "friction", "closed form", "mujoco")
    for limit in done.limits:
        what = "closing" if limit.closing else "opening"
        way = "accelerating" if limit.forward else "braking"
        found = ("4 or more" if x is None else f"{x:.2f}" for x in (limit.known, limit.seen))
        table.add_row(f"{what}, {way}", f"{limit.friction:g}", *found)
    console.print(table)
    if done.analyzed is not None:
        console.print(
            f"both properties hold everywhere on the palms up to {done.analyzed:.2f} m/s² "
            "(palmbots analyze)"
        )
    table = _table("carries", "delivered", "mujoco", "rms (mm)", "mujoco", "peak (mm)", "mujoco")
    for pace in done.paces:
        table.add_row(
            f"{pace.speed_m_s:g} m/s",
            *(f"{n} of {pace.n}" for n in pace.delivered),
            *(f"{1e3 * rms:.1f}" for rms in pace.rms_m),
            *(f"{1e3 * peak:.1f}" for peak in pace.peak_m),
        )
    console.print(table)
    files_written(console, written)

"""What the commands print for people."""

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from palmbots.bounds import Bounds
    from palmbots.compare import Comparison
    from palmbots.modes import ContactModes
    from palmbots.rare import DropRate
    from palmbots.replay import Replay
    from palmbots.result import Carry
    from palmbots.touching import Contact, Motions

__all__ = [
    "carry_report",
    "compare_report",
    "console_for_people",
    "counted",
    "files_written",
    "modes_report",
    "rare_report",
    "replay_report",
]

_SIDES = ("left", "right")
_GOOD, _BAD, _QUIET = "bold green", "bold red", "dim"
_ANY_WIDTH = 10_000  # columns: a pipe or a file has no edge at which to break or cut a line

_LEAST_WIDTH = 80  # columns; for the widest table but that of `compare`, which finds its own

_REASONS = {
    "off-palm": "a contact ran past an end or a side of its palm",
    "sliding": "no squeeze balances the object: it slides on both palms",
    "flush": "a palm and an edge of the object are in the same place",
    "tip": "the end of a palm is in the object",
    "tipping": "the centre of mass went past a contact",
    "jammed": "no motion that the palms allow is in balance",
    "lifting": "the object lifted off a palm",
}

_CASES = {
    "a": "own p > 0, partner assists (c)",
    "b": "both p > 0",
    "d": "own p < 0",
    "1": "p_L > 0",
    "2": "p_R > 0",
    "3": "p_L < 0",
    "4": "p_R < 0",
    "5": "both > 0",
    "6": "both < 0",
    "7": "p_L > 0, p_R < 0",
    "8": "p_L < 0, p_R > 0",
}


def counted(n: int, noun: str) -> str:
    """A number with its noun: 1 correction, 2 corrections, 2 carries."""
    many = f"{noun[:-1]}ies" if noun.endswith("ry") else f"{noun}s"
    return f"{n} {noun if n == 1 else many}"


def console_for_people() -> Console:
    """Stdout; what is no terminal has lines of any length.

    A terminal that is too narrow may break lines, but no table cuts numbers to fit into it.
    """
    console = Console(highlight=False)
    console.width = max(console.width, _LEAST_WIDTH) if console.is_terminal else _ANY_WIDTH
    return console


def _plain() -> Table:
    return Table(box=None, show_header=False, pad_edge=False, padding=(0, 3, 0, 0))


def _mm(metres: float) -> str:
    return f"{1e3 * metres:.1f} mm"


def carry_report(
    done: "Carry",
    scene_name: str,
    warnings: Sequence[str],
    written: Sequence[Path],
    removed: Sequence[Path] = (),
    hint: str | None = None,
) -> None:
    """The outcome of a carry at a glance: result, hint, contacts, corrections, files."""
    console = console_for_people()
    good = done.outcome == "delivered"
    head = Text(done.outcome.upper(), style=_GOOD if good else _BAD)
    head.append(
        f"  {done.distance_m:.2f} of {done.scene.task.distance_m:.2f} m in {done.time_s:.1f} s",
        style="bold",
    )
    head.append(
        f"   {scene_name}, {done.controller}, seed {done.seed}, "
        f"{done.precision if done.world == 'quasistatic' else done.world}",
        style=_QUIET,
    )
    console.print(head)
    if done.reason is not None:
        console.print(f"  {done.reason}: {_REASONS[done.reason]}")
        if hint is not None:
            console.print(f"  {hint}", soft_wrap=True, markup=False)
    elif done.outcome == "stalled":
        given = done.scene.task.timeout_s is not None
        usual = "" if given else ", the default: twice the time at nominal speed"
        console.print(f"  time is up: task.timeout_s is {done.scene.timeout_s:g} s{usual}")

    table = _plain()
    table.add_row("", Text("left", style="bold"), Text("right", style="bold"))
    table.add_row("contact rms", *(_mm(done.contact_rms_m[s]) for s in _SIDES))
    table.add_row("contact peak", *(_mm(done.contact_peak_m[s]) for s in _SIDES))
    if done.across_peak_m is not None and done.scene.task.path.is_curved:
        table.add_row("across, at most", *(_mm(done.across_peak_m[s]) for s in _SIDES))
    if done.messages and done.controller != "centralized":
        table.add_row("waited", *(f"{done.waiting_s[s]:.1f} s" for s in _SIDES))
    console.print(table)

    if done.corrections:
        listed = len(done.corrections)
        first = f", of the first {listed}:" if listed < done.correction_count else ""
        console.print(f"{counted(done.correction_count, 'correction')}{first}")
        counts = Counter((c.case, c.robot) for c in done.corrections)
        alone = Counter(c.case for c in done.corrections if c.assistant is None)
        cases = _plain()
        for case in sorted({case for case, _ in counts}):
            by_robot = "   ".join(
                f"{robot} {counts[case, robot]}"
                for robot in (*_SIDES, "both")
                if counts[case, robot]
            )
            if case in ("a", "b") and alone[case] and done.controller != "resilient":
                by_robot += f"   ({alone[case]} unanswered)"
            cases.add_row(f"  ({case})", Text(_CASES.get(case, ""), style=_QUIET), by_robot)
        console.print(cases)
    if done.bounds is not None:
        _bounds(console, done.bounds)
    if done.touches:
        first = done.touches[0]
        console.print(
            f"{counted(len(done.touches), 'time')} upon more than two vertices, first {first.kind} "
            f"{first.robot} at {first.start_s:.2f} s, "
            f"{sum(t.end_s - t.start_s for t in done.touches):.2f} s in all"
        )
    lost = f", {done.messages_lost} lost" if done.messages_lost else ""
    if done.scene.radio.corruption > 0:
        lost += f", {sum(link.rejected for link in done.links.values())} rejected"
    bumps = f"   {counted(done.bumps, 'bump')}" if done.bumps else ""
    messages = counted(done.messages, "message")
    console.print(f"{messages}{lost}{bumps}   trace {done.trace_hash}", style=_QUIET)
    for warning in warnings:
        console.print(Text("warning: ", style="bold yellow").append(warning, style="default"))
    files_written(console, written)
    for path in removed:
        console.print(f"removed {path}, of an earlier carry", soft_wrap=True)


def _bounds(console: Console, b: "Bounds") -> None:
    """The resilient algorithm's bounds, in two lines."""
    console.print(
        f"lease {b.lease_s:g} s (at least {b.shortest_lease_s:g}): {b.losses} beacons in a row may "
        f"be lost   a palm is held up for {b.hold_s:g} s of silence",
        style=_QUIET,
    )
    console.print(
        f"no robot travels alone for more than {b.alone_s:g} s, {_mm(b.skew_m)} of {_mm(b.room_m)}",
        style=_QUIET,
    )


def files_written(console: Console, written: Sequence[Path]) -> None:
    """The files that a command wrote, with their sizes."""
    for path in written:
        console.print(f"wrote {path}  {_size(path.stat().st_size)}", soft_wrap=True)


def _size(n: int) -> str:
    return f"{n / 1e6:.1f} MB" if n >= 1e6 else f"{n / 1e3:.0f} kB"


def modes_report(found: "ContactModes") -> None:
    """The nine modes as a 3 × 3 table, and what happens."""
    console = console_for_people()
    console.print(
        f"palms {found.theta_left_deg:g}°, {found.theta_right_deg:g}°   "
        f"contacts {_mm(found.p_left_m)}, {_mm(found.p_right_m)}   object {found.object_deg:.2f}°"
    )
    if found.motions_closing is not None and found.motions_opening is not None:
        _several(console, found.contacts, bool(found.held))
        _outcomes(console, "closing", found.contacts, found.motions_closing)
        _outcomes(console, "opening", found.contacts, found.motions_opening)
        console.print("ST sticks, SL slides left, SR slides right, BR breaks", style=_QUIET)
        console.print("\nif the two contact vertices alone touched the palms:")
    table = Table()
    table.add_column("left ↓  right →")
    for right in ("ST", "SL", "SR"):
        table.add_column(right, justify="center")
    for left in ("ST", "SL", "SR"):
        row = [_mark(found, (left, right)) for right in ("ST", "SL", "SR")]
        table.add_row(Text(left, style="bold"), *row)
    console.print(table)
    console.print("ST sticks, SL slides left, SR slides right", style=_QUIET)
    for what, mode, wedged in (
        ("closing", found.closing, all(found.wedged.values())),
        ("opening", found.opening, False),
    ):
        if mode is not None:
            console.print(f"{what}: left [bold]{mode[0]}[/bold], right [bold]{mode[1]}[/bold]")
        else:
            held = any(m == ("ST", "ST") for m in found.feasible)
            why = "jammed: no contact lets go" if held or wedged else "the object is not held"
            console.print(f"{what}: [bold red]none[/bold red] ({why})")
    for side in _SIDES:
        low, high = found.squeeze[side]
        wedged = "   wedged: no squeeze frees it" if found.wedged[side] else ""
        console.print(f"squeeze {side:5}  {_end(low)} … {_end(high)} of the weight{wedged}")
    console.print(f"friction cone margin  {math.degrees(found.margin_rad):.2f}°")


def _several(console: Console, contacts: "Sequence[Contact]", held: bool) -> None:
    """More than two contacts: where they are, and whether they hold the object."""
    table = Table()
    for head in ("contact", "kind"):
        table.add_column(head)
    for head in ("on the palm", "object x", "object y"):
        table.add_column(head, justify="right")
    for contact in contacts:
        x, y = contact.point_m
        table.add_row(contact.side, contact.kind, _mm(contact.place_m), _mm(x), _mm(y))
    console.print(table)
    answer = "[bold green]yes[/bold green]" if held else "[bold red]no[/bold red]"
    console.print(f"held with all {len(contacts)} sticking: {answer}")


def _outcomes(
    console: Console, what: str, contacts: "Sequence[Contact]", motions: "Sequence[Motions]"
) -> None:
    """What several contacts may do, one line for each way, grouped by palm."""
    if not motions:
        console.print(f"{what}: [bold red]none[/bold red] (no motion is possible and in balance)")
    for k, motion in enumerate(motions):
        pairs = list(zip(contacts, motion, strict=True))
        parts = []
        for side in _SIDES:
            names = " ".join(name for contact, name in pairs if contact.side == side)
            parts.append(f"{side} [bold]{names}[/bold]")
        console.print(f"{what if k == 0 else '     or'}: {', '.join(parts)}")


def _mark(found: "ContactModes", mode: tuple[str, str]) -> Text:
    if mode not in found.feasible:
        return Text("–", style=_QUIET)
    happens = [
        word
        for word, one in (("closing", found.closing), ("opening", found.opening))
        if one == mode
    ]
    return Text(", ".join(["balanced", *happens]), style=_GOOD if happens else "")


def _end(value: float) -> str:
    return f"{value:+.3f}" if math.isfinite(value) else ("unbounded" if value > 0 else "-unbounded")


def compare_report(done: "Comparison", written: Path | None) -> None:
    """One row for each controller and value."""
    console = console_for_people()
    carries = counted(done.rows[0].n, "carry")
    title = f"{done.key}: {carries} a value, seeds from {done.seed}"
    table = Table(title=title, min_width=len(title))
    columns: tuple[tuple[str, Literal["left", "right"]], ...] = (
        ("controller", "left"),
        ("value", "right"),
        ("dropped (95 %)", "right"),
        ("rms (95 %)", "right"),
        ("messages/m", "right"),
        ("B/s", "right"),
    )
    for name, justify in columns:
        table.add_column(name, justify=justify, no_wrap=True)
    last = None
    for row in done.rows:
        if last is not None and row.controller != last:
            table.add_section()
        half_rms = 0.5 * (row.rms_interval_m[1] - row.rms_interval_m[0])
        spread = "" if math.isnan(half_rms) else f" ± {1e3 * half_rms:.1f}"
        table.add_row(
            row.controller if row.controller != last else "",
            _exactly(row.value),
            _rate(row.drop_rate, row.interval),
            f"{1e3 * row.rms_m:.1f}{spread} mm",
            f"{row.messages_per_m:.0f}",
            f"{row.bytes_per_s:.0f}",
        )
        last = row.controller
    # A terminal that is too narrow may break lines, but nobody cuts numbers.
    widest = console.options.update(width=_ANY_WIDTH)
    console.width = max(console.width, Measurement.get(console, widest, table).maximum)
    console.print(table)
    stalled = sum(round(row.stall_rate * row.n) for row in done.rows)
    if stalled:
        console.print(f"{counted(stalled, 'carry')} stalled: neither arrived nor dropped in time")
    busiest = max(row.bytes_per_s for row in done.rows)
    console.print(
        f"B/s: packets of 28 bytes on the air; the most is {8e2 * busiest / _RADIO_BITS_S:.1f} % "
        f"of a radio of {_RADIO_BITS_S // 1000} kbit/s",
        style=_QUIET,
        soft_wrap=True,
    )
    for refusal in done.refused:
        console.print(f"resilient refused {refusal}", soft_wrap=True)
    if written is not None:
        files_written(console, [written])


_RADIO_BITS_S = 250_000  # of a small packet radio, IEEE 802.15.4 for example


def _exactly(value: float) -> str:
    return short if float(short := f"{value:g}") == value else repr(value)


def _rate(rate: float, interval: tuple[float, float]) -> str:
    low, high = (100 * end for end in interval)
    return f"{100 * rate:.1f} % ({low:.1f}–{high:.1f})"


def rare_report(found: "DropRate", scene: str) -> None:
    """The rate, and the levels by which carries came to it."""
    console = console_for_people()
    low, high = found.interval
    console.print(
        f"[bold]{found.drop_rate:.2g}[/bold] of all carries dropped, 95 % {low:.2g} to {high:.2g}"
        f"   {scene}, {found.controller}, seed {found.seed}",
        soft_wrap=True,
    )
    if 0 < found.drop_rate < 0.1:
        console.print(f"one in {1 / found.drop_rate:,.0f}")
    if found.levels:
        table = Table()
        table.add_column("farthest contact", justify="right")
        table.add_column("of those before", justify="right")
        for level, part in zip(found.levels, found.reached, strict=True):
            table.add_row(f"{100 * level:.0f} % of the palm's half", f"{100 * part:.1f} %")
        console.print(table)
    console.print(
        f"{counted(found.replicates, 'replicate')} of {counted(found.effort, 'carry')} a stage, "
        f"the time of {found.carries:,.0f} whole carries",
        soft_wrap=True,
    )


def replay_report(result: "Replay", log: Path) -> None:
    """Whether the new run is the logged one."""
    console = console_for_people()
    if result.identical:
        console.print(
            Text("IDENTICAL", style=_GOOD).append(
                f"  {result.samples} samples, every bit   trace {result.trace_hash}",
                style="default",
            )
        )
    else:
        console.print(Text("DIFFERS", style=_BAD).append(f"  {result.difference}", style="default"))
    console.print(
        f"{log}: {result.log.controller}, seed {result.log.seed}, {result.log.precision}, "
        f"version {result.log.version}",
        style=_QUIET,
        soft_wrap=True,
    )

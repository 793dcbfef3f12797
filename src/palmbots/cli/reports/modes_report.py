# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots modes`."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table
from rich.text import Text

from palmbots._types import SIDES
from palmbots._util.text import millimetres
from palmbots.cli.reports.console import GOOD, QUIET, report_console

if TYPE_CHECKING:
    from palmbots.mechanics.contact_points import Contact, Motions
    from palmbots.mechanics.mode_analysis import ContactModes


def modes_report(found: "ContactModes") -> None:
    """Print the nine modes as a 3 × 3 table, and those that occur."""
    from palmbots.mechanics.contact_points import MOTION_CODES
    from palmbots.mechanics.mode_words import (
        MOTION_MEANINGS,
        decision_sentence,
        margin_sentence,
        mode_sentence,
    )

    symbols = ", ".join(f"{symbol}: {meaning}" for symbol, meaning in MOTION_MEANINGS.items())
    console = report_console()
    console.print(
        f"palms {found.theta_left_deg:g}°, {found.theta_right_deg:g}°   "
        f"contacts {millimetres(found.p_left_m)}, {millimetres(found.p_right_m)}   "
        f"object {found.object_deg:.2f}°"
    )
    if found.motions_closing is not None and found.motions_opening is not None:
        _list_contacts(console, found.contacts, bool(found.held))
        _outcomes(console, "closing", found.contacts, found.motions_closing)
        _outcomes(console, "opening", found.contacts, found.motions_opening)
        console.print(f"{symbols}, BR: breaks contact", style=QUIET)
        console.print("\nIf only the two contact vertices touched the palms:")
    table = Table()
    table.add_column("left ↓  right →")
    slides = MOTION_CODES[:3]
    for right in slides:
        table.add_column(right, justify="center")
    for left in slides:
        row = [_verdict_mark(found, (left, right)) for right in slides]
        table.add_row(Text(left, style="bold"), *row)
    console.print(table)
    console.print(symbols, style=QUIET)
    held = ("ST", "ST") in found.feasible
    for what, mode in (("closing", found.closing), ("opening", found.opening)):
        if mode is not None:
            name = f"left [bold]{mode[0]}[/bold], right [bold]{mode[1]}[/bold]"
        else:
            name = "[bold red]none[/bold red]"
        console.print(f"{what}: {name}", markup=True)
        console.print(mode_sentence(mode, held=held))
        decision = decision_sentence(found.squeeze, closing=what == "closing", held=held)
        console.print(decision, style=QUIET)
    for side in SIDES:
        low, high = found.squeeze[side]
        wedged = "   wedged: no squeeze force frees it" if found.wedged[side] else ""
        console.print(f"squeeze force {side:5}  {_end(low)} … {_end(high)} of the weight{wedged}")
    console.print(margin_sentence(found.margin_rad))


def _list_contacts(console: Console, contacts: "Sequence[Contact]", held: bool) -> None:
    """Print more than two contacts: their places, and whether they hold the object."""
    table = Table()
    for head in ("contact", "kind"):
        table.add_column(head)
    for head in ("on the palm", "object x", "object y"):
        table.add_column(head, justify="right")
    for contact in contacts:
        x, y = contact.point_m
        table.add_row(
            contact.side, contact.kind, millimetres(contact.place_m), millimetres(x), millimetres(y)
        )
    console.print(table)
    answer = "[bold green]yes[/bold green]" if held else "[bold red]no[/bold red]"
    console.print(f"held with all {len(contacts)} sticking: {answer}", markup=True)


def _outcomes(
    console: Console, what: str, contacts: "Sequence[Contact]", motions: "Sequence[Motions]"
) -> None:
    """Print the possible motions of several contacts, one combination per line, by palm."""
    if not motions:
        none = "[bold red]none[/bold red] (no motion is possible and in balance)"
        console.print(f"{what}: {none}", markup=True)
    for k, motion in enumerate(motions):
        pairs = list(zip(contacts, motion, strict=True))
        parts = []
        for side in SIDES:
            names = " ".join(name for contact, name in pairs if contact.side == side)
            parts.append(f"{side} [bold]{names}[/bold]")
        console.print(f"{what if k == 0 else '     or'}: {', '.join(parts)}", markup=True)


def _verdict_mark(found: "ContactModes", mode: tuple[str, str]) -> Text:
    if mode not in found.feasible:
        return Text("–", style=QUIET)
    happens = [
        word
        for word, one in (("closing", found.closing), ("opening", found.opening))
        if one == mode
    ]
    return Text(", ".join(["balanced", *happens]), style=GOOD if happens else "")


def _end(value: float) -> str:
    return f"{value:+.3f}" if math.isfinite(value) else ("unbounded" if value > 0 else "-unbounded")

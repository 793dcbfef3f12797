# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots certify`, `check` and `design`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from palmbots._types import SIDES
from palmbots._util.text import millimetres
from palmbots.cli.reports.console import (
    indented,
    plain_table,
    print_written_files,
    report_console,
)
from palmbots.cli.reports.stability_report import PROPERTIES, friction_note
from palmbots.stability.linear_conditions import text_of

if TYPE_CHECKING:
    from palmbots.stability.certificates.checker.verify import CheckResult
    from palmbots.stability.certificates.prover import Certificate
    from palmbots.stability.palm_angles import Design

__all__ = ["certificate_report", "check_report", "design_report"]


def certificate_report(certificate: "Certificate", written: Sequence[Path]) -> None:
    """Print what was proved, or where it fails."""
    console = report_console()
    style = {"holds": "bold green", "fails": "bold red", "undecided": "bold yellow"}
    words = {
        "holds": "CERTIFIED TO HOLD",
        "fails": "CERTIFIED TO FAIL",
        "undecided": "UNDECIDED",
    }
    head = Text(words[certificate.verdict], style=style[certificate.verdict])
    claims = certificate.data["claims"]
    quantifier = "at least one of " if certificate.verdict == "fails" and len(claims) > 1 else ""
    head.append(f"  {quantifier}{', '.join(claims)}", style="bold")
    console.print(head)
    if certificate.verdict == "holds":
        console.print(f"{certificate.parts} boxes proved at their corners", style="dim")
    elif certificate.verdict == "fails":
        _witness(console, certificate.data["witness"])
    else:
        console.print(
            f"neither proved nor refuted: {certificate.undecided} (try narrower intervals)"
        )
    print_written_files(console, written)


def _witness(console: Console, witness: dict[str, Any]) -> None:
    """Print the point at which a claim fails, and how."""
    name = witness["claim"]
    if witness["fails"] == "clearance":
        console.print(
            f"the {name.split()[1]} palm touches edge {witness['edge']} of the outline "
            "(counted counter-clockwise from the left contact, which is 0)"
        )
    else:
        number, side = int(name[0]), name.split()[1]
        console.print(f"{PROPERTIES[number]}, {side}: {text_of(number, witness['fails'])}")
    table = plain_table()
    for label, key, unit in (
        ("palm angles", "angle_deg", "°"),
        ("friction", "friction", ""),
        ("contacts", "contacts_m", " m"),
        ("palm half-length", "half_length_m", " m"),
        ("pivot offset", "offset_m", " m"),
    ):
        if key in witness:
            pair = witness[key]
            left, right = (f"{side} {pair[side]}{unit}" for side in SIDES)
            table.add_row(f"  {label}", left, right)
    if "com_m" in witness:
        x, y = witness["com_m"]
        table.add_row("  COM", f"x {x} m", f"y {y} m")
    console.print(table)


def check_report(result: "CheckResult", path: Path) -> None:
    """Print whether a certificate proves its claim."""
    console = report_console()
    word, style = ("VALID", "bold green") if result.valid else ("INVALID", "bold red")
    console.print(Text(word, style=style).append(f"  {path}", style="default"), soft_wrap=True)
    if not result.valid:
        console.print(indented(result.reason))
    console.print(indented(Text(result.claim, style="dim")))
    table = plain_table()
    for name, text in result.facts().items():
        table.add_row(f"  {name}", Text(text))
    console.print(table)
    if result.valid and result.outside:
        console.print(indented(f"the scene is not in the box: {'; '.join(result.outside)}"))


def design_report(design: "Design", scene_name: str, written: Sequence[Path]) -> None:
    """Print the angles, the tolerance and the conditions under which it holds."""
    from palmbots.stability.angle_grid import QUANTITIES

    console = report_console()
    name = QUANTITIES[design.quantity][-1]
    head = Text(f"{design.shallow_deg:g}° and {design.steep_deg:g}°", style="bold green")
    head.append(f"  largest tolerance: {name}", style="bold")
    head.append(f"   {scene_name}", style="dim")
    console.print(head)

    table = plain_table()
    ratio = ""
    if design.paper_tolerance:
        gain = design.tolerance / design.paper_tolerance
        ratio = f"{gain:.2f} × that of 5° and 15°, {design.tolerance_text(design.paper_tolerance)}"
    table.add_row("  tolerance", design.tolerance_text(design.tolerance), ratio)
    table.add_row("  clearance", f"{design.clearance_deg:.2f}°", "until a palm touches an edge")
    low, high = design.region_m
    table.add_row("  contacts", f"{1e3 * low:.1f} to {millimetres(high)}", "for which this holds")
    if design.friction is not None:
        note = friction_note([design.friction], design.shallow_deg, design.steep_deg)
        low, high = design.friction
        table.add_row("  friction", f"{low:.3f} to {high:.3f}", f"the same on both palms{note}")
    own, asked = design.reaction_s["own"], design.reaction_s["asked"]
    table.add_row("  reaction", f"{own:.2f} s, {asked:.2f} s", "own case (d), assisting case (a)")
    console.print(table)
    verdict = design.certificate.verdict
    if verdict == "holds":
        console.print("certified: properties 0, 1 and 2 and clearance, under these conditions")
    else:
        console.print(
            Text(f"certificate: {verdict} ({design.certificate.undecided})", "bold yellow")
        )
    print_written_files(console, written)

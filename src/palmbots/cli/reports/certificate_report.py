# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots certify`, `check` and `design`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from palmbots._types import SIDES
from palmbots._util.text import millimetres
from palmbots.cli.console import (
    indented,
    plain_table,
    print_written_files,
    report_console,
)
from palmbots.stability.analysis_lines import PROPERTIES, friction_note
from palmbots.stability.linear_conditions import text_of

if TYPE_CHECKING:
    from palmbots.stability.certificates.checker.verify import CheckResult
    from palmbots.stability.certificates.prover import Certificate
    from palmbots.stability.palm_angles import Design


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
    elif name.startswith("jam"):
        console.print(f"{name}: both contacts are wedged, and neither slides")
    elif name == "0 turning":
        console.print(f"both palms turning: {_any_palm(text_of(0, witness['fails']))}")
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


def _any_palm(reason: str) -> str:
    """A reason in which the left palm is called the shallow one, since either may be it."""
    return reason.replace("shallow", "left").replace("steep", "right")


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


def design_report(
    design: "Design", scene_name: str, written: Sequence[Path], changes: Sequence[str]
) -> None:
    """Print the angles, what they tolerate beside the scene's own, and how to use them."""
    from palmbots.stability.angle_grid import NOISE, QUANTITIES
    from palmbots.stability.certificates.obligations import BOTH_TURN

    console = report_console()
    name = QUANTITIES[design.quantity][-1]
    aim = "most noise" if design.objective == NOISE else f"largest tolerance: {name}"
    head = Text(f"{design.shallow_deg:g}° and {design.steep_deg:g}°", style="bold green")
    console.print(head.append(f"  {aim}", style="bold").append(f"   {scene_name}", style="dim"))
    _design_comparison(console, design, name)

    table = plain_table()
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
        claims = design.certificate.data["claims"]
        console.print(f"certified under these conditions: {', '.join(claims)}")
        if missing := [claim for claim in BOTH_TURN if claim not in claims]:
            console.print(
                f"not certified for palms that turn at the same time: {', '.join(missing)}"
            )
    else:
        console.print(
            Text(f"certificate: {verdict} ({design.certificate.undecided})", "bold yellow")
        )
    settings = " ".join(f"--set {key}={angle:g}" for key, angle in design.angle_keys.items())
    console.print(f"to use these angles: {settings}", soft_wrap=True)
    files = [str(path) for path in written if path.suffix == ".toml"]
    given = "".join(f" --set {change}" for change in changes)
    following = files[0] if files else f"{scene_name}{given} {settings}"
    console.print(f"to try them, run: palmbots carry {following}", soft_wrap=True)
    print_written_files(console, written)


def _design_comparison(console: Console, design: "Design", name: str) -> None:
    """Print noise limit and tolerance of the designed angles and of the scene's own."""
    from palmbots.stability.design_result import limit_text

    own = design.own
    heads = ("", f"designed, {design.shallow_deg:g}° and {design.steep_deg:g}°", own.name())
    table = plain_table(*heads)
    if design.noise_limit is not None or own.noise_limit is not None:
        limits = (design.noise_limit, own.noise_limit)
        table.add_row(
            "  σ* (95 %)", *("none" if one is None else limit_text(one) for one in limits)
        )
    tolerance = "none: a property fails"
    if own.tolerance is not None:
        tolerance = design.tolerance_text(own.tolerance)
    elif own.angles_deg is None:
        tolerance = "the palms differ"
    table.add_row(
        f"  tolerance, {name.split(' along')[0]}",
        design.tolerance_text(design.tolerance),
        tolerance,
    )
    console.print(table)
    limit = design.noise_limit or own.noise_limit
    if limit is not None:
        console.print(
            f"  σ*: robot.noise_m_s at which 1 % of carries drop the object, {limit.controller}",
            style="dim",
        )

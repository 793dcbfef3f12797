# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots analyze`."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from palmbots._types import Interval
from palmbots._util.text import millimetres
from palmbots.cli.reports.console import (
    QUIET,
    indented,
    plain_table,
    print_written_files,
    report_console,
)
from palmbots.scene.palm_section import friction_limit

if TYPE_CHECKING:
    from palmbots.stability.analysis import Analysis
    from palmbots.stability.clearance import Clearance
    from palmbots.stability.first_contact import FirstTouch

PROPERTIES = {1: "1 closing", 2: "2 opening", 0: "0 turning"}
_CONTACT_KINDS = {"flush": "flush with the outline", "tip": "tip", "back end": "back end"}


def analysis_report(analysis: "Analysis", scene_name: str, written: Sequence[Path]) -> None:
    """Print the properties with their margins, what limits them, and the admissible ranges."""
    console = report_console()
    console.print(_verdict(analysis))
    region = analysis.problem.contacts[0]
    console.print(
        f"{scene_name}, contacts {1e3 * region[0]:.1f} to {millimetres(region[1])}",
        style=QUIET,
    )
    _margins(console, analysis)
    _nearest_failure(console, analysis)
    _ranges(console, analysis)
    _clearance(console, analysis.clearance)
    if analysis.touch is not None:
        _first_contact(console, analysis.touch)
    _wedging(console, analysis)
    tipping = analysis.sideways
    console.print(
        f"lateral support ±{millimetres(tipping.margin_m)}; the object tips sideways at "
        f"{math.degrees(tipping.tilt_rad):.1f}° or {tipping.acceleration_g:.2f} g"
    )
    for warning in analysis.warnings:
        console.print(Text("warning: ", style="bold yellow").append(warning, style="default"))
    print_written_files(console, written)


def _verdict(analysis: "Analysis") -> Text:
    """The headline. Where a palm is inside the object, the properties are of no use."""
    if not analysis.holds:
        word, style, claim = "FAILS", "bold red", "both properties, either palm shallow"
    elif analysis.clearance.touches:
        word, style = "TOUCHES", "bold red"
        claim = "a palm, although both properties hold, either palm shallow"
    else:
        word, style, claim = "HOLDS", "bold green", "both properties, either palm shallow"
    return Text(word, style).append(f"  {claim}", "bold")


def _margins(console: Console, analysis: "Analysis") -> None:
    numbers = ("travel", "angles", "friction", "COM")
    table = plain_table("property", "shallow", "", *numbers, right=numbers)
    for (number, shallow), report in analysis.properties.items():
        margins = report.margins
        table.add_row(
            PROPERTIES[number] if shallow == "left" else "",
            shallow,
            Text("holds", style="green") if report.holds else Text("FAILS", style="bold red"),
            _number(margins.travel_m, 1e3, "mm"),
            _number(margins.angle_rad, 180 / math.pi, "°", "±"),
            _number(margins.friction, 1, "", "±"),
            _number(margins.com_m, 1e3, "mm", "±" if report.holds else ""),
        )
    console.print(table)


def _nearest_failure(console: Console, analysis: "Analysis") -> None:
    weakest = min(
        (report for report in analysis.properties.values() if report.binding),
        key=lambda r: r.margins.travel_m if r.margins.travel_m is not None else math.inf,
        default=None,
    )
    if weakest is None:
        return
    left, right = weakest.binding_p_m
    console.print(
        f"smallest margin: property {PROPERTIES[weakest.number]}, {weakest.shallow} palm shallow, "
        f"p {millimetres(left)}, {millimetres(right)}"
    )
    console.print(indented(weakest.binding))


def _ranges(console: Console, analysis: "Analysis") -> None:
    """For each quantity, the range in which both properties hold."""
    console.print(Text("Ranges in which both properties hold, all else as in the scene", "bold"))
    table = plain_table()
    table.add_row("  COM along the object", _interval(analysis.com_x_m, 1e3, "mm"))
    table.add_row("  COM height", _union(analysis.com_y_m, 1e3, "mm"))
    palms = [math.degrees(angle) for pair in analysis.problem.angles for angle in pair]
    friction = _union(analysis.friction, 1, "") + friction_note(analysis.friction, *palms)
    table.add_row("  friction, both palms", friction)
    half = analysis.half_length_m
    table.add_row("  palm half-length", "none" if half is None else f"up to {millimetres(half[1])}")
    table.add_row("  angle error", _angle_error(analysis))
    slope = analysis.slope
    degrees = None if slope is None else tuple(math.degrees(math.atan(s)) for s in slope)
    table.add_row(
        "  slope, uphill > 0",
        "none" if degrees is None else f"{degrees[0]:.2f} to {degrees[1]:.2f}°",
    )
    limit = analysis.max_acceleration_m_s2
    table.add_row("  acceleration", "none" if limit is None else f"up to {limit:.2f} m/s²")
    console.print(table)


def _angle_error(analysis: "Analysis") -> str:
    """The admissible angle error, and whether clearance limits it further."""
    error, turn = analysis.angle_error_rad, analysis.clearance.rotation_margin.margin
    text = _number(error, 180 / math.pi, "°", "±")
    if error is None or turn > error:
        return text
    if analysis.clearance.touches:
        return f"{text}, but a palm touches already"
    return f"{text}, but a palm touches after a turn of {math.degrees(turn):.2f}°"


def friction_note(pieces: Sequence[Interval], *palms_deg: float) -> str:
    """A remark on friction that no scene accepts, although the properties hold there too."""
    limit = friction_limit(*palms_deg)
    if not pieces or pieces[-1][1] <= limit:
        return ""
    steepest = max(map(abs, palms_deg))
    return f"; a scene with a palm at {steepest:.3g}° accepts less than {limit:.3f}"


def _clearance(console: Console, clearance: "Clearance") -> None:
    """Print the distance between palms and outline, and where they touch first."""
    turn = f"{abs(math.degrees(clearance.rotation_margin.margin)):.2f}°"
    ends = clearance.length_margin
    if ends is None:
        head = Text(f"clearance {turn}, for palms of any length")
    elif not clearance.touches:
        head = Text(f"clearance {turn}, or {millimetres(ends.margin)} at the ends of the palms")
    else:
        head = Text("the outline TOUCHES a palm", "bold red").append(f", by {turn}", "default")
        if ends.kind != "flush":
            head.append(f", {millimetres(-ends.margin)} from a palm's end", "default")
    console.print(head)
    first = clearance.rotation_margin
    angles = ", ".join(f"{math.degrees(angle):.1f}°" for angle in first.angles_rad)
    contacts = ", ".join(map(millimetres, first.contacts_m))
    console.print(
        indented(
            f"first contact: {first.side} palm, {_CONTACT_KINDS[first.kind]}, palms at {angles}, "
            f"contacts {contacts}"
        )
    )


def _first_contact(console: Console, state: "FirstTouch") -> None:
    """Print what happens where a palm just touches."""
    angles = ", ".join(f"{math.degrees(angle):.1f}°" for angle in state.angles_rad)
    kinds = ", ".join(f"{contact.side} {contact.kind}" for contact in state.contacts)
    held = "held" if state.held else "NOT held"
    console.print(indented(f"in contact at {angles}: {kinds}: {held}"))
    for name, outcomes in (("closing", state.closing), ("opening", state.opening)):
        console.print(indented(f"{name} there: {state.outcomes_text(outcomes)}"))


def _wedging(console: Console, analysis: "Analysis") -> None:
    wedging = analysis.wedging
    if not math.isfinite(wedging.friction):
        console.print("no contact can wedge")
        return
    start = (
        f"wedging starts at friction {wedging.friction:.2f} ({wedging.side} palm, {wedging.palm})"
    )
    console.print(start + ("; the scene's friction is above that" if wedging.happens else ""))


def _number(value: float | None, scale: float, unit: str, sign: str = "") -> str:
    if value is None:
        return "–"
    space = "" if unit in ("", "°") else " "
    return f"{sign}{scale * value:.{3 if not unit else 1}f}{space}{unit}"


def _interval(ends: Interval | None, scale: float, unit: str) -> str:
    if ends is None:
        return "none"
    digits = 1 if unit else 3
    return f"{scale * ends[0]:.{digits}f} to {scale * ends[1]:.{digits}f} {unit}".rstrip()


def _union(pieces: Sequence[Interval], scale: float, unit: str) -> str:
    return ", ".join(_interval(piece, scale, unit) for piece in pieces) or "none"

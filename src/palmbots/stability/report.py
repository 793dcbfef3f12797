"""What `palmbots analyze`, `certify`, `check` and `design` print for people."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from palmbots.report import console_for_people, files_written
from palmbots.sections import friction_limit
from palmbots.stability.forms import text_of
from palmbots.stability.ranges import Interval

if TYPE_CHECKING:
    from palmbots.check import Checked
    from palmbots.stability.analysis import Analysis
    from palmbots.stability.certificate import Certificate
    from palmbots.stability.clearance import Clearance
    from palmbots.stability.design import Design
    from palmbots.stability.touch import FirstTouch

__all__ = ["analysis_report", "certificate_report", "check_report", "design_report"]

_NAMES = {1: "1 closing", 2: "2 opening", 0: "0 turning"}


def analysis_report(found: "Analysis", scene_name: str, written: Sequence[Path]) -> None:
    """The properties with their margins, what binds, the ranges, and the warnings they deserve."""
    console = console_for_people()
    head = _verdict(found)
    region = found.situation.contacts[0]
    head.append(f"   {scene_name}, p {1e3 * region[0]:.1f} to {_mm(region[1])}", style="dim")
    console.print(head)

    table = Table(box=None, pad_edge=False, padding=(0, 3, 0, 0))
    for name in ("property", "shallow", "", "travel", "angles", "friction", "COM"):
        table.add_column(name, justify="left" if name in ("property", "shallow", "") else "right")
    for (number, shallow), report in found.properties.items():
        margins = report.margins
        table.add_row(
            _NAMES[number] if shallow == "left" else "",
            shallow,
            Text("holds", style="green") if report.holds else Text("FAILS", style="bold red"),
            _signed(margins.travel_m, 1e3, "mm"),
            _signed(margins.angle_rad, 180 / math.pi, "°", "±"),
            _signed(margins.friction, 1, "", "±"),
            _signed(margins.com_m, 1e3, "mm", "±" if report.holds else ""),
        )
    console.print(table)
    weakest = min(
        (r for r in found.properties.values() if r.binding),
        key=lambda r: r.margins.travel_m if r.margins.travel_m is not None else math.inf,
        default=None,
    )
    if weakest is not None:
        left, right = weakest.binding_p_m
        console.print(
            f"nearest to failing: {_NAMES[weakest.number]}, {weakest.shallow} palm shallow, at "
            f"{_mm(left)}, {_mm(right)}:\n  {weakest.binding}"
        )

    console.print(Text("both properties hold, each range with all else as in the scene", "bold"))
    ranges = Table(box=None, show_header=False, pad_edge=False, padding=(0, 3, 0, 0))
    ranges.add_row("  COM along the object", _interval(found.com_x_m, 1e3, "mm"))
    ranges.add_row("  COM height", _union(found.com_y_m, 1e3, "mm"))
    palms = [math.degrees(angle) for pair in found.situation.angles for angle in pair]
    friction = _union(found.friction, 1, "") + _beyond_scenes(found.friction, *palms)
    ranges.add_row("  friction, both palms", friction)
    half = found.half_length_m
    ranges.add_row("  palm half-length", "none" if half is None else f"up to {_mm(half[1])}")
    ranges.add_row("  angle error", _angle_error(found))
    slope = found.slope
    degrees = None if slope is None else tuple(math.degrees(math.atan(s)) for s in slope)
    ranges.add_row(
        "  slope, uphill +", "none" if degrees is None else f"{degrees[0]:.2f} to {degrees[1]:.2f}°"
    )
    limit = found.max_acceleration_m_s2
    ranges.add_row("  acceleration", "none" if limit is None else f"up to {limit:.2f} m/s²")
    console.print(ranges)

    wedging, sideways = found.wedging, found.sideways
    _clearance(console, found.clearance)
    if found.touch is not None:
        _touch(console, found.touch)
    start = (
        f"wedging starts at friction {wedging.friction:.2f} ({wedging.side} palm, {wedging.palm})"
        if math.isfinite(wedging.friction)
        else "no contact can wedge"
    )
    console.print(start + ("  the scene's friction is above that" if wedging.happens else ""))
    console.print(
        f"sideways: support ±{_mm(sideways.margin_m)}, tips at "
        f"{math.degrees(sideways.tilt_rad):.1f}° or {sideways.acceleration_g:.2f} g"
    )
    files_written(console, written)


def _verdict(found: "Analysis") -> Text:
    """The headline; properties that hold are worth nothing where a palm is in the object."""
    if not found.holds:
        word, style, what = "FAILS", "bold red", "both properties, either palm shallow"
    elif found.clearance.touches:
        word, style = "TOUCHES", "bold red"
        what = "a palm, though both properties hold, either palm shallow"
    else:
        word, style, what = "HOLDS", "bold green", "both properties, either palm shallow"
    return Text(word, style).append(f"  {what}", "bold")


def _angle_error(found: "Analysis") -> str:
    """What the properties bear, and what clearance leaves of it."""
    error, turn = found.angle_error_rad, found.clearance.turn.margin
    told = _signed(error, 180 / math.pi, "°", "±")
    if error is None or turn > error:
        return told
    if found.clearance.touches:
        return f"{told}, but a palm touches already"
    return f"{told}, but something touches after a turn of {math.degrees(turn):.2f}°"


def _beyond_scenes(pieces: Sequence[Interval], *palms_deg: float) -> str:
    """What to say of friction that no scene accepts, where the properties hold there too."""
    most = friction_limit(*palms_deg)
    if not pieces or pieces[-1][1] <= most:
        return ""
    steepest = max(map(abs, palms_deg))
    return f", but a scene takes less than {most:.3f} with a palm at {steepest:.3g}°"


_TOUCH = {"flush": "flush with the outline", "tip": "tip", "back end": "back end"}


def _clearance(console: Console, found: "Clearance") -> None:
    """How far the palms stay clear, and what touches first where."""
    turn = f"{abs(math.degrees(found.turn.margin)):.2f}°"
    ends = found.longer
    if ends is None:
        head = Text(f"clearance {turn}, however long the palms")
    elif not found.touches:
        head = Text(f"clearance {turn}, or palms {_mm(ends.margin)} longer at their ends")
    else:
        head = Text("the outline TOUCHES a palm", "bold red").append(f", by {turn}", "default")
        if ends.kind != "flush":
            head.append(f", {_mm(-ends.margin)} from a palm's end", "default")
    console.print(head)
    at = found.turn
    angles = ", ".join(f"{math.degrees(angle):.1f}°" for angle in at.angles_rad)
    places = ", ".join(map(_mm, at.contacts_m))
    console.print(f"  first: {at.side} palm, {_TOUCH[at.kind]}, at {angles}, p {places}")


def _touch(console: Console, at: "FirstTouch") -> None:
    """What happens where the palm just touches."""
    angles = ", ".join(f"{math.degrees(angle):.1f}°" for angle in at.angles_rad)
    kinds = ", ".join(f"{contact.side} {contact.kind}" for contact in at.contacts)
    console.print(f"  touching at {angles}: {kinds}: {'held' if at.held else 'NOT held'}")
    for name, outcomes in (("closing", at.closing), ("opening", at.opening)):
        told = " or ".join("–".join(motions) for motions in outcomes) or "nothing balances"
        console.print(f"  {name} there: {told}")


def _mm(metres: float) -> str:
    return f"{round(1e3 * metres, 1) + 0.0:.1f} mm"


def _signed(value: float | None, scale: float, unit: str, sign: str = "") -> str:
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


def certificate_report(found: "Certificate", written: Sequence[Path]) -> None:
    """What was proved, or where it fails."""
    console = console_for_people()
    looks = {"holds": "bold green", "fails": "bold red", "undecided": "bold yellow"}
    words = {
        "holds": "CERTIFIED TO HOLD",
        "fails": "CERTIFIED TO FAIL",
        "undecided": "UNDECIDED",
    }
    head = Text(words[found.verdict], style=looks[found.verdict])
    claims = found.data["claims"]
    one_of_them = "at least one of " if found.verdict == "fails" and len(claims) > 1 else ""
    head.append(f"  {one_of_them}{', '.join(claims)}", style="bold")
    console.print(head)
    if found.verdict == "holds":
        console.print(f"{found.parts} parts of the box proved at their corners", style="dim")
    elif found.verdict == "fails":
        _witness(console, found.data["witness"])
    else:
        console.print(f"neither proved nor refuted: {found.undecided} (a smaller box may decide)")
    files_written(console, written)


def _witness(console: Console, witness: dict[str, Any]) -> None:
    """The point at which a claim fails, and how."""
    name = witness["claim"]
    if witness["fails"] == "clearance":
        edge = f"edge {witness['edge']} of the outline (counter-clockwise from the left contact, 0)"
        console.print(f"the {name.split()[1]} palm touches {edge}")
    else:
        number, side = int(name[0]), name.split()[1]
        console.print(f"{_NAMES[number]}, {side}: {text_of(number, witness['fails'])}")
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 3, 0, 0))
    for told, key, unit in (
        ("palm angles", "angle_deg", "°"),
        ("friction", "friction", ""),
        ("contacts", "contacts_m", " m"),
        ("palm half-length", "half_length_m", " m"),
        ("pivot offset", "offset_m", " m"),
    ):
        if key in witness:
            pair = witness[key]
            table.add_row(f"  {told}", f"left {pair['left']}{unit}", f"right {pair['right']}{unit}")
    if "com_m" in witness:
        table.add_row("  COM", f"x {witness['com_m'][0]} m", f"y {witness['com_m'][1]} m")
    console.print(table)


def check_report(found: "Checked", path: Path) -> None:
    """Whether a certificate proves what it claims."""
    console = console_for_people()
    if found.valid:
        console.print(Text("VALID", style="bold green").append(f"  {path}", style="default"))
    else:
        console.print(Text("INVALID", style="bold red").append(f"  {path}", style="default"))
        console.print(f"  {found.why}")
    console.print(f"  {found.claim}", style="dim")


def design_report(found: "Design", scene_name: str, written: Sequence[Path]) -> None:
    """The angles, what they are worth, and at what price."""
    from palmbots.stability.design import QUANTITIES

    console = console_for_people()
    *_, unit, scale, name = QUANTITIES[found.quantity]
    head = Text(f"{found.shallow_deg:g}° and {found.steep_deg:g}°", style="bold green")
    head.append(f"  tolerate most: {name.split(' [')[0]}", style="bold")
    head.append(f"   {scene_name}", style="dim")
    console.print(head)

    def told(value: float) -> str:
        shown = {"m": "mm", "rad": "°"}.get(unit, unit)
        return f"±{scale * value:.3g}{'' if shown == '°' else ' '}{shown}".rstrip()

    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 3, 0, 0))
    ratio = ""
    if found.paper_tolerance:
        gain = found.tolerance / found.paper_tolerance
        ratio = f"{gain:.2f} × that of 5° and 15°, {told(found.paper_tolerance)}"
    table.add_row("  tolerance", told(found.tolerance), ratio)
    table.add_row("  clearance", f"{found.clearance_deg:.2f}°", "until an edge lies on a palm")
    low, high = found.region_m
    table.add_row("  contacts", f"{1e3 * low:.1f} to {_mm(high)}", "for which all of it holds")
    if found.friction is not None:
        beyond = _beyond_scenes([found.friction], found.shallow_deg, found.steep_deg)
        low, high = found.friction
        table.add_row("  friction", f"{low:.3f} to {high:.3f}", f"both palms alike{beyond}")
    table.add_row(
        "  reaction",
        f"{found.reaction_s['own']:.2f} s, {found.reaction_s['asked']:.2f} s",
        "own contact (d), partner asked (a)",
    )
    console.print(table)
    verdict = found.certificate.verdict
    if verdict == "holds":
        console.print("certified: properties 0, 1 and 2 and clearance, for all of the above")
    else:
        console.print(
            Text(f"certificate: {verdict} ({found.certificate.undecided})", "bold yellow")
        )
    files_written(console, written)

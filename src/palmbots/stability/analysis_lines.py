# SPDX-License-Identifier: Apache-2.0
"""What people read of an analysis of the properties."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import palmbots._core as _core
from palmbots._types import Interval
from palmbots._util.report import Item, Line, Table, bad, bold, good, quiet, warning
from palmbots._util.text import millimetres
from palmbots.scene.object_frame import object_frame
from palmbots.stability.holding import holding

if TYPE_CHECKING:
    from palmbots.stability.analysis import Analysis
    from palmbots.stability.first_contact import FirstTouch


TIGHTEST = 3
"""Margins at the head of the report."""
PROPERTIES = {1: "1 closing", 2: "2 opening", 0: "0 turning"}


def analysis_lines(analysis: "Analysis") -> Iterator[Item]:
    """The tightest margins, the properties with theirs, what limits them, and admissible ranges."""
    on_one_palm = analysis.lone or analysis.hand_over
    if on_one_palm is not None:  # the properties are those of two palms
        yield from on_one_palm.verdict_lines()
        yield from on_one_palm.lines()
        return
    yield holding(analysis).line()
    if analysis.lifting is not None:
        yield from analysis.lifting.verdict_lines()
    yield bold("Tightest margins, relative to what this scene uses up")
    for number, margin in enumerate(analysis.ranking[:TIGHTEST], 1):
        yield Line(f"{number}. {margin.sentence()}", indent=2)
    low, high = analysis.problem.contacts[0]
    yield quiet(f"contacts {1e3 * low:.1f} to {millimetres(high)}")
    yield _margins(analysis)
    yield from _nearest_failure(analysis)
    yield bold("Ranges in which properties 1 and 2 hold, all else as in the scene")
    yield _ranges(analysis)
    yield from analysis.clearance.lines()
    if analysis.touch is not None:
        yield from _first_contact(analysis.touch)
    yield _wedging(analysis)
    tipping = analysis.sideways
    yield (
        f"lateral support ±{millimetres(tipping.margin_m)}; the object tips sideways at "
        f"{math.degrees(tipping.tilt_rad):.1f}° or {tipping.acceleration_g:.2f} g"
    )
    yield analysis.load.sentence()
    if analysis.lifting is not None:
        yield from analysis.lifting.lines()
    yield from map(warning, analysis.warnings)


def _margins(analysis: "Analysis") -> Table:
    rows = []
    for report in analysis.properties.values():
        margins = report.margins
        rows.append((
            PROPERTIES[report.number] if report.shallow == "left" else "",
            report.shallow,
            good("holds") if report.holds else bad("FAILS"),
            _number(margins.travel_m, 1e3, "mm"),
            _number(margins.angle_rad, 180 / math.pi, "°", "±"),
            _number(margins.friction, 1, "", "±"),
            _number(margins.com_m, 1e3, "mm", "±" if report.holds else ""),
        ))  # fmt: skip
    numbers = ("travel", "angles", "friction", "COM")
    return Table(rows, ("property", "shallow", "", *numbers), right=numbers)


def _nearest_failure(analysis: "Analysis") -> Iterator[Item]:
    weakest = min(
        (report for report in analysis.properties.values() if report.binding),
        key=lambda r: r.margins.travel_m if r.margins.travel_m is not None else math.inf,
        default=None,
    )
    if weakest is None:
        return
    left, right = weakest.binding_p_m
    yield (
        f"weakest property: {PROPERTIES[weakest.number]}, {weakest.shallow} palm shallow, "
        f"p {millimetres(left)}, {millimetres(right)}"
    )
    yield Line(weakest.binding, indent=2)


def _ranges(analysis: "Analysis") -> Table:
    """For each quantity, the range in which both properties hold."""
    palms = [math.degrees(angle) for pair in analysis.problem.angles for angle in pair]
    friction = _union(analysis.friction, 1, "") + friction_note(analysis.friction, *palms)
    half, limit = analysis.half_length_m, analysis.max_acceleration_m_s2
    slope = analysis.slope_deg
    return Table([
        ("  COM along the object", _interval(analysis.com_x_m, 1e3, "mm")),
        ("  COM height", _com_height(analysis)),
        ("  friction, both palms", friction),
        ("  palm half-length", "none" if half is None else f"up to {millimetres(half[1])}"),
        ("  angle error", _angle_error(analysis)),
        ("  slope, uphill > 0", "none" if slope is None else f"{slope[0]:.2f} to {slope[1]:.2f}°"),
        ("  acceleration", "none" if limit is None else f"up to {limit:.2f} m/s²"),
    ])  # fmt: skip


def _com_height(analysis: "Analysis") -> str:
    """The admissible heights of the COM above the line of contacts, inside the outline."""
    body = analysis.scene.object
    frame = object_frame(body.vertices_m, body.contacts, body.com_m)
    heights = [corner.height for corner in frame.outline]
    lowest, highest = min(heights), max(heights)
    inside = [(max(low, lowest), min(high, highest)) for low, high in analysis.com_y_m]
    pieces = [(low, high) for low, high in inside if low < high]
    if pieces == [(lowest, highest)]:
        return f"any inside the outline, {_interval(pieces[0], 1e3, 'mm')}"
    return _union(pieces, 1e3, "mm") + " inside the outline" * bool(pieces)


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
    steepest = max(map(abs, palms_deg))
    limit = _core.friction_limit(steepest)
    if not pieces or pieces[-1][1] <= limit:
        return ""
    return f"; a scene with a palm at {steepest:.3g}° accepts less than {limit:.3f}"


def _first_contact(state: "FirstTouch") -> Iterator[Item]:
    """What happens where a palm just touches."""
    angles = ", ".join(f"{math.degrees(angle):.1f}°" for angle in state.angles_rad)
    kinds = ", ".join(dict.fromkeys(f"{one.side} {one.kind}" for one in state.contacts))
    held = "held" if state.held else "NOT held"
    yield Line(f"palms at {angles}, in contact: {kinds}; the object is {held}", indent=2)
    for name, outcomes in (("closing", state.closing), ("opening", state.opening)):
        yield Line(f"{name} there: {state.outcomes_text(outcomes)}", indent=2)


def _wedging(analysis: "Analysis") -> str:
    wedging = analysis.wedging
    if not math.isfinite(wedging.friction):
        return "no contact can wedge"
    start = (
        f"wedging starts at friction {wedging.friction:.2f} ({wedging.side} palm, {wedging.palm})"
    )
    return start + ("; the scene's friction is above that" if wedging.happens else "")


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

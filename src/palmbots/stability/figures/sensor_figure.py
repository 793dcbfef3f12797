# SPDX-License-Identifier: Apache-2.0
"""The paper's Figure 7 for any scene: the switches along both palms, and their readings.

The palms are drawn in side view, with the inner ends facing each other.
"""

from itertools import pairwise

from matplotlib.figure import Figure

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.scene.robot_section import Tactile
from palmbots.stability.figures.canvas import MM, View, headline, sheet
from palmbots.viz.style import INK, SWITCH, axis_label, styled

Zone = tuple[int, float, float]
"""Sign (−1, 0 or 1), from, to."""

_TEXT = {-1: "−", 0: "0", 1: "+"}
_HATCH = {-1: "---", 0: "", 1: "+++"}


def figure7(tactile: Tactile, spec: _core.Spec) -> Figure:
    """The layout of the sensor."""
    zones: list[Zone] = [(sign, MM * low, MM * high) for sign, low, high in spec.zones]
    lanes = _lanes(zones)
    depth = 1 + max(lanes, default=0)
    text = "layout assumed: the paper does not state the width of its switches"
    if tactile.zones is not None:
        text = "layout: the scene's tactile.zones, on both palms"
    text += "\n0 wins over − and +; where no switch is pressed, the sensor reads 0"
    with styled():
        height = 0.25 * (depth + 3.2)
        high = height + 1.15
        figure = sheet(7.0, high)
        figure.text(0.75 / 7, 1 - 0.07 / high, text, va="top", size=8, linespacing=1.4)
        for k, side in enumerate(SIDES):
            half = 0.5 * MM * spec.palms[k].length
            box = ((0.75 + 3.2 * k) / 7, 0.45 / high, 2.75 / 7, height / high)
            inward = -1 if k else 1
            reach = 1.14 * half * inward
            view = View(figure.add_axes(box), (reach, -reach), (-depth - 2.1, 1.1))
            _draw_palm(view, zones, lanes, half)
            axes = view.axes
            axes.set_xlabel(axis_label("outward →   $p_R$" if k else "← outward   $p_L$", "mm"))
            headline(axes, f"{side} palm, {2 * half:.4g} mm")
            rows = [-0.5 * depth, -depth - 1.3]
            axes.set_yticks(rows, ["", ""] if k else ["switches", "reads"])
            axes.tick_params(axis="y", length=0)
            axes.spines["left"].set_visible(False)
        return figure


def _lanes(zones: list[Zone]) -> list[int]:
    """For each switch the first row in which it overlaps no earlier switch."""
    rows: list[int] = []
    for _, low, high in zones:
        before = zip(rows, zones, strict=False)
        taken = {row for row, (_, start, end) in before if start < high and low < end}
        rows.append(next(row for row in range(len(zones)) if row not in taken))
    return rows


def readings(zones: list[Zone], half: float) -> list[Zone]:
    """The readings along a palm from -half to half, as zones."""
    ends = {end for zone in zones for end in zone[1:] if -half < end < half}
    pieces: list[Zone] = []
    for low, high in pairwise([-half, *sorted(ends), half]):
        middle = 0.5 * (low + high)
        signs = {sign for sign, start, end in zones if start <= middle <= end}
        sign = 0 if 0 in signs or not signs else signs.pop()
        start = pieces.pop()[1] if pieces and pieces[-1][0] == sign else low
        pieces.append((sign, start, high))
    return pieces


def _draw_palm(view: View, zones: list[Zone], lanes: list[int], half: float) -> None:
    """Draw the switches in rows, and the readings below them."""
    floor = -2.0 - max(lanes, default=0) - 0.9
    for place, name in ((-half, "inner end"), (0.0, "pivot, p = 0"), (half, "outer end")):
        width, style = (1.2, "-") if place else (0.6, "--")
        view.line((place, 0.25), (place, floor - 0.1), colour=INK, width=width, ls=style)
        view.axes.text(place, 0.35, name, ha="center", va="bottom", size=7)
    for (sign, low, high), lane in zip(zones, lanes, strict=True):
        if low <= half and high >= -half:
            _draw_switch(view, sign, max(low, -half), min(high, half), -lane - 0.9)
    for sign, low, high in readings(zones, half):
        _draw_switch(view, sign, low, high, floor + 0.2)


def _draw_switch(view: View, sign: int, low: float, high: float, bottom: float) -> None:
    colour, hatch = SWITCH[sign], _HATCH[sign]
    view.axes.fill_between(
        (low, high), bottom, bottom + 0.8, fc=colour, ec=INK, lw=0.7, hatch=hatch
    )
    middle = 0.5 * (low + high), bottom + 0.4
    shown = {"boxstyle": "square,pad=0.12", "fc": colour, "ec": "none"}
    if high - low > 8 * view.point:
        view.axes.text(*middle, _TEXT[sign], ha="center", va="center", size=8.5, bbox=shown)

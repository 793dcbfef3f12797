# SPDX-License-Identifier: Apache-2.0
"""Draws a job on the floor or on a stand phase by phase: palms and object at one moment of each, to
scale.

The moments are those of the carry; a phase in which the robots never were together is left out.
Arrows show how wheels are commanded to move, and how arms move.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.scene.placement import Placement, floor_level, placements
from palmbots.scene.spec import to_spec
from palmbots.scene.surroundings import drawn_blocks
from palmbots.viz.style import BACKGROUND, FLOOR, HUE, INK, OBJECT, QUIET, ZERO, styled

if TYPE_CHECKING:
    from palmbots.simulation.floor_job import FloorJob
    from palmbots.simulation.result import Carry


class Moment(NamedTuple):
    """When a phase is drawn: while the robots are in these states, in either order."""

    title: str
    one: frozenset[str]
    other: frozenset[str]
    """Empty: one robot does the job."""
    share: float
    """Of the longest such time."""


def _both(title: str, *states: str, share: float = 0.5) -> Moment:
    return Moment(title, frozenset(states), frozenset(states), share)


def _handing(title: str, hands: str, other: str, share: float = 0.5) -> Moment:
    return Moment(title, frozenset({hands}), frozenset({other}), share)


def _alone(title: str, state: str, share: float = 0.5) -> Moment:
    return Moment(title, frozenset({state}), frozenset(), share)


_LEAVE = frozenset({"leave_steep", "leave_shallow"})
MOMENTS = (
    _both("approach", "dock", share=0.2),
    Moment("dock: the first one waits", frozenset({"dock"}), frozenset({"under"}), 0.5),
    _both("under", "under", share=1.0),
    Moment("touch: from below the object", frozenset({"touch"}), frozenset({"touch", "meet"}), 0.7),
    _both("centre", "centre", "ready", "recentre"),
    _both("raise", "raise", "raise_hold"),
    _both("carry", "carry"),
    _both("lower", "lower", "lower_hold"),
    Moment("leave", _LEAVE, frozenset({"empty"}), 0.5),
    _both("retreat", "retreat"),
    _alone("approach", "scoop", 0.2),
    _alone("the near corner climbs", "seat", 0.2),
    _alone("the object lies flush", "seat", 1.0),
    _alone("raise", "lift"),
    _alone("carry", "haul"),
    _alone("lower", "set_down"),
    _alone("tip out", "tip_out", 1.0),
    _alone("leave", "leave_steep"),
    _alone("retreat", "retreat", 0.2),
    _handing("the taker is the wall", "scoop", "prop"),
    _handing("the object lies flush", "seat", "prop", 1.0),
    _handing("raise", "lift", "prop"),
    _handing("the taker gets out of the way", "hold_up", "clear", 0.2),
    _handing("carry", "haul", "there"),
    _handing("tip out", "tip_out", "there", 1.0),
    _handing("leave", "leave_steep", "there"),
    _handing("the giver is the wall", "brace", "scoop", 0.9),
    _handing("the object lies flush", "brace", "seat", 1.0),
    _handing("raise", "brace", "lift"),
    _handing("carry on", "retreat", "haul", 1.0),
    _handing("leave", "done", "leave_steep"),
)
"""What is drawn, in the order of a job."""

_COLUMNS = 3
_TOUCHES_M = 2e-4
_MOVES_M_S = 0.004
_ARROW_M = 0.06
_SIDE_IN, _TALL_IN, _HEAD_IN = 2.75, 1.75, 0.5


def draw_lift_phases(carry: Carry) -> Figure:
    """Draw the phases of a job that begins or ends on the floor or on a stand.

    Raises:
        PalmbotsError: the carry has no trace, or it is no such job.
    """
    if carry.trace is None or carry.floor_job is None:
        raise PalmbotsError(
            "figure: this carry has no phases on the floor; allowed: a job that begins or ends on "
            "the floor, run with record=True"
        )
    found = [(one.title, time_of(carry.floor_job, one)) for one in MOMENTS]
    shown = [(title, time) for title, time in found if time is not None]
    spec = to_spec(carry.scene, unrolled=True)
    times = carry.trace["time"].to_numpy()
    wanted = np.array([time for _, time in shown])
    rows = np.clip(np.searchsorted(times, wanted + 1e-9, side="right") - 1, 0, len(times) - 1)
    place = placements(spec, carry.trace, rows)
    # The widest moment that is drawn whole; robots that drive away leave the panel.
    wide = float(np.abs(place.outline[..., 0] - place.com[:, None, 0]).max()) + 0.14
    floor = floor_level(spec)
    top = float(place.outline[..., 1].max()) + 0.01
    lines = math.ceil(len(shown) / _COLUMNS)
    with styled():
        figure = Figure(
            figsize=(_COLUMNS * _SIDE_IN, lines * _TALL_IN + _HEAD_IN), layout="constrained"
        )
        axes = figure.subplots(lines, _COLUMNS, squeeze=False)
        for k, panel in enumerate(axes.flat):
            panel.set_axis_off()
            if k >= len(shown):
                continue
            title, _ = shown[k]
            panel.set_title(f"{k + 1}  {title}, {times[rows[k]]:.1f} s", fontsize=8, loc="left")
            middle = float(place.com[k, 0])
            panel.set(xlim=(middle - wide, middle + wide), ylim=(floor - 0.045, top))
            panel.set_aspect("equal")
            _draw_moment(panel, carry, place, k, int(rows[k]), floor)
        _draw_legend(figure, {phase.robot for phase in carry.floor_job.phases})
    return figure


def time_of(job: FloorJob, wanted: Moment) -> float | None:
    """When a phase is drawn; None: the robots were never together in these states."""
    spans: list[tuple[float, float]] = []
    for first in SIDES:
        sets = {first: wanted.one, SIDES[1 - SIDES.index(first)]: wanted.other}
        left, right = (
            [one for one in job.phases if one.robot == side and one.phase in sets[side]]
            for side in SIDES
        )
        if not wanted.other and len({one.robot for one in job.phases}) == 1:
            spans += [(one.start_s, one.end_s) for one in left + right]
        spans += [(max(a.start_s, b.start_s), min(a.end_s, b.end_s)) for a in left for b in right]
    spans = [(start, end) for start, end in spans if start < end]
    if not spans:
        return None
    start, end = max(spans, key=lambda span: span[1] - span[0])
    # The last instant of a state is one tick before its end.
    return start + min(wanted.share * (end - start), max(0.0, end - start - 0.01))


def _draw_moment(
    panel: Axes, carry: Carry, place: Placement, k: int, row: int, floor: float
) -> None:
    left, right = panel.get_xlim()
    panel.axhspan(floor - 0.05, floor, color=FLOOR, lw=0)
    panel.plot((left, right), (floor, floor), color=QUIET, lw=0.8)
    blocks = drawn_blocks(to_spec(carry.scene, unrolled=True))
    for low, high, foot, top in blocks:
        panel.add_patch(Rectangle((low, foot), high - low, top - foot, fc=FLOOR, ec=QUIET))
    outline = place.outline[k]
    panel.add_patch(Polygon(outline, fc=OBJECT, ec=INK, lw=0.8))
    panel.plot(*place.com[k], marker="+", color=INK, ms=5, mew=0.9)
    assert carry.trace is not None
    at = carry.trace.isel(time=row)
    before, after = (
        carry.trace.isel(time=min(max(row + by, 0), carry.trace.sizes["time"] - 1))
        for by in (-5, 5)
    )
    span = float(after["time"] - before["time"])
    for s, side in enumerate(SIDES):
        panel.add_patch(Polygon(place.plate[k, s], fc=HUE[side], ec=HUE[side], lw=0.9))
        x, y = place.pivot[k, s]
        inside = left < x < right
        if inside:
            panel.plot(x, y, "o", ms=3.5, mfc=BACKGROUND, mec=INK, mew=0.7, zorder=5)
        half = 0.5 * carry.scene.palm_of(side).length_m
        p, gap = float(at["contact"].sel(side=side)), float(at["vertex_height"].sel(side=side))
        if abs(p) <= half and gap < _TOUCHES_M:
            panel.plot(*place.contact[k, s], "D", ms=5, mfc=ZERO, mec=INK, mew=0.7, zorder=6)
        speed = float(at["commanded"].sel(side=side))  # the noise moves robots that stand
        if inside and abs(speed) > _MOVES_M_S:
            _arrow(panel, (x, floor - 0.025), (math.copysign(_ARROW_M, speed), 0.0), side)
        height = [float(one["pivot_height"].sel(side=side)) for one in (before, after)]
        rate = (height[1] - height[0]) / max(span, 1e-9)
        if inside and abs(rate) > 5 * _MOVES_M_S:
            out = (-0.03, 0.03)[s]
            _arrow(panel, (x + out, y), (0.0, math.copysign(_ARROW_M, rate)), side)
    grounds = [(left, right, floor), *((low, high, top) for low, high, _, top in blocks)]
    for low, high, top in grounds:
        x, y = outline.T
        on = outline[(abs(y - top) < _TOUCHES_M) & (low <= x) & (x <= high)]
        for at_x, at_y in on[on[:, 0].argsort()[[0, -1]]] if len(on) else ():
            panel.plot(at_x, at_y, "s", ms=4.5, mfc=BACKGROUND, mec=INK, mew=0.9, zorder=6)


def _arrow(panel: Axes, start: tuple[float, float], by: tuple[float, float], side: str) -> None:
    tail = (start[0] - by[0] / 2, start[1] - by[1] / 2)
    head = (start[0] + by[0] / 2, start[1] + by[1] / 2)
    look: dict[str, Any] = {"arrowstyle": "-|>", "color": HUE[side], "lw": 1.2, "shrinkA": 0}
    panel.annotate("", head, tail, arrowprops=look | {"shrinkB": 0, "mutation_scale": 8})


def _draw_legend(figure: Figure, robots: set[str]) -> None:
    mark: dict[str, Any] = {"ls": "", "mec": INK}
    handles = [
        *(Line2D([], [], color=HUE[s], lw=2, label=f"{s} palm") for s in SIDES if s in robots),
        Line2D([], [], marker="D", mfc=ZERO, ms=5, label="contact on a palm", **mark),
        Line2D([], [], marker="s", mfc=BACKGROUND, ms=4.5, label="on floor or stand", **mark),
        Line2D([], [], marker="o", mfc=BACKGROUND, ms=3.5, label="pivot", **mark),
        Line2D([], [], marker="+", ls="", color=INK, label="centre of mass"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=6, fontsize=7.5)

# SPDX-License-Identifier: Apache-2.0
"""The paper's Figures 3 and 4 for any scene: friction cones and their meeting points, to scale.

Both show the left palm shallow and the right one steep. The paper draws its Figure 4 for φ < θ.
With φ > θ the steep palm's lower edge leans away, and its line meets the line of gravity below the
object. Figure 4 therefore also shows the squeezes, whose order does not depend on the angles.
Source: paper, section 3; docs/theory/mechanics.md.
"""

import math

import numpy as np
from matplotlib.figure import Figure

from palmbots._types import SIDES
from palmbots.stability.figures.canvas import (
    MM,
    Array,
    View,
    clipped,
    headline,
    meeting,
    panel,
    sheet,
)
from palmbots.stability.figures.drawn_state import State, draw_bodies, draw_description, shown_area
from palmbots.viz.style import BACKGROUND, BOTH, HUE, INK, LINE, PALE, axis_label, styled

_UP, _DOWN = 1, -1
_LETTER = ("L", "R")
_GRAVITY = (0, (8, 1.5, 1.5, 1.5))


def _within(polygon: Array, state: State, side: int) -> Array:
    """The part of a polygon in the friction cone of a contact."""
    for slide in (_UP, _DOWN):
        way = state.edge(side, slide)
        out = slide * (1, -1)[side] * np.array([way[1], -way[0]])
        polygon = clipped(polygon, out, float(out @ state.point("contact", side)))
    return polygon


def _draw_cone(view: View, state: State, side: int, named: bool = False) -> None:
    name, apex = SIDES[side], state.point("contact", side)
    cone = _within(view.corners, state, side)
    view.fill(cone, fc=PALE[name], alpha=0.45, lw=0, zorder=0.5)
    for slide in (_UP, _DOWN):
        view.ray(apex, state.edge(side, slide), HUE[name], 0.9, LINE[name])
    if named:
        ends = [math.atan2(*state.edge(side, slide)[::-1]) for slide in (_UP, _DOWN)]
        text = f"$2\\varphi_{_LETTER[side]}$"
        view.arc(apex, 0.22 * MM * state.problem.width, ends[0], ends[1], text, HUE[name])


def _draw_gravity(view: View, state: State) -> None:
    for sign in (1, -1):
        view.ray(state.point("com"), sign * state.upward, INK, 1.1, _GRAVITY)


def _name_gravity(view: View, state: State) -> None:
    """The label of the line of gravity near its lower end; drawn last, where there is room."""
    com, low, way = state.point("com"), view.corners[0][1] + 16 * view.point, state.upward
    text = "gravity" if state.problem.slope == 0 else "effective\ngravity"
    view.label(text, com + way * (low - com[1]) / way[1], (-1, 0), size=7.5)


def _on_gravity(state: State, side: int, slide: int) -> tuple[Array | None, bool]:
    """Where an edge's line meets the line of gravity, and whether that is above the contact."""
    apex, way = state.point("contact", side), state.edge(side, slide)
    point = meeting(apex, way, state.point("com"), state.upward)
    return point, point is not None and float((point - apex) @ way) > 0


def figure3(state: State) -> Figure:
    """The conditions of the modes ST–ST and SL–ST, with the friction cones."""
    with styled():
        apexes = state.point("contact")
        upper = meeting(apexes[0], state.edge(0, _UP), apexes[1], state.edge(1, _UP))
        point, _ = _on_gravity(state, 0, _UP)
        above = [float(p[1]) for p in (upper, point) if p is not None]
        x, y = shown_area(state, [1.15 * h for h in above], 1.5)
        width = 2.85
        height = width * (y[1] - y[0]) / (x[1] - x[0])
        figure = sheet(7.0, height + 1.15)
        draw_description(figure, state)
        for k, mode in enumerate((("ST", "ST"), ("SL", "ST"))):
            view = panel(figure, 0.6 + 3.4 * k, 0.45, width, x, y)
            _draw_gravity(view, state)
            draw_bodies(view, state)
            _draw_cone(view, state, 1, named=True)
            if k == 0:
                _draw_cone(view, state, 0, named=True)
                seen = _draw_common(view, state)
                text = "gravity must cross the intersection of the cones"
            else:
                view.ray(apexes[0], state.edge(0, _UP), HUE["left"], 1.6)
                seen = _mark(view, point, "")
                text = "left edge and gravity must meet in the right cone"
            _name_gravity(view, state)
            balances = mode in state.balances
            if balances and not seen:
                text += ":\nthey do, outside this view"
            verdict = "balances" if balances else "does not balance"
            headline(view.axes, f"({'ab'[k]}) {'–'.join(mode)} {verdict}", text)
        return figure


def _draw_common(view: View, state: State) -> bool:
    """The intersection of the cones; returns whether gravity crosses it in the view."""
    common = _within(_within(view.corners, state, 0), state, 1)
    view.fill(common, fc=BOTH, alpha=0.3, ec=BOTH, lw=0.8, hatch="..", zorder=0.8)
    across = np.array([state.upward[1], -state.upward[0]])
    sides = (common - state.point("com")) @ across
    return bool(sides.size and sides.min() <= 0 <= sides.max())


def _mark(view: View, point: Array | None, name: str) -> bool:
    """A named point, if it is in the view; returns whether it is."""
    if point is None or not ((point > view.corners[0]) & (point < view.corners[2])).all():
        return False
    view.axes.plot(*point, "s", ms=4, mfc=BACKGROUND, mec=INK, zorder=7)
    view.occupy(point)
    if name:
        view.label(name, point + 2 * view.point, (1, 0))
    return True


_Meetings = dict[str, tuple[Array | None, bool]]
"""The points of Figure 4 by name, and whether the force points towards them."""


def _meetings(state: State) -> _Meetings:
    left, right = state.point("contact")
    edge = state.edge(0, _UP)
    found: _Meetings = {
        "L₁": _on_gravity(state, 0, _UP),
        "R₁": _on_gravity(state, 1, _UP),
        "R₂": _on_gravity(state, 1, _DOWN),
    }
    for name, slide in (("B", _UP), ("D", _DOWN)):
        other = state.edge(1, slide)
        point = meeting(left, edge, right, other)
        ahead = point is not None and min((point - left) @ edge, (point - right) @ other) > 0
        found[name] = point, bool(ahead)
    return found


def figure4(state: State) -> Figure:
    """The points on the line of gravity that decide property 1, and their squeezes."""
    with styled():
        found = _meetings(state)
        above = [float(p[1]) for p, ahead in found.values() if p is not None and ahead]
        x, y = shown_area(state, [1.03 * h for h in above], 1.85)
        width = 3.4
        height = max(width * (y[1] - y[0]) / (x[1] - x[0]), 3.6)
        figure = sheet(7.0, height + 0.75)
        view = panel(figure, 0.6, 0.45, width, x, y)
        draw_description(figure, state)
        _draw_gravity(view, state)
        draw_bodies(view, state)
        view.ray(state.point("contact", 0), state.edge(0, _UP), HUE["left"], 1.4)
        _draw_cone(view, state, 1)
        if not found["R₂"][1]:
            start = state.point("contact", 1)
            view.ray(start, -state.edge(1, _DOWN), HUE["right"], 0.9, (0, (1, 1.5)))
        for name, (point, _) in found.items():
            _mark(view, point, name)
        _draw_angles(view, state)
        _name_gravity(view, state)
        _list_meetings(figure, found)
        _draw_squeezes(figure, state)
        return figure


def _draw_angles(view: View, state: State) -> None:
    """α₁, β₁, β₂ of the edges; q, s, γ, δ of the COM."""
    width, com = MM * state.problem.width, state.point("com")
    edges = (((_UP, "α₁", 0.2),), ((_UP, "β₁", 0.16), (_DOWN, "β₂", 0.29)))
    for side, (length, between) in enumerate((("q", "γ"), ("s", "δ"))):
        apex, colour = state.point("contact", side), HUE[SIDES[side]]
        level = (0.0, math.pi)[side]
        view.line(apex, apex + 0.44 * width * np.array([math.cos(level), 0.0]), ls="--")
        view.line(apex, com, colour=INK, width=0.7)
        view.label(length, 0.3 * apex + 0.7 * com, (0, 1))
        for slide, name, radius in edges[side]:
            way = state.edge(side, slide)
            end = math.atan2(way[1], way[0])
            view.arc(apex, radius * width, level, end, name, colour)
        way = com - apex
        start, end = level + state.turn, math.atan2(way[1], way[0])
        view.arc(apex, 0.36 * width, start, end, between)


def _list_meetings(figure: Figure, found: _Meetings) -> None:
    """The heights of the points as text."""
    lines = {
        "L₁": "gravity and left edge",
        "R₁": "gravity and upper right edge",
        "R₂": "gravity and lower right edge",
        "B": "left and upper right edge",
        "D": "left and lower right edge",
    }
    rows = ["meeting points, height y [mm]"]
    for name, what in lines.items():
        point, ahead = found[name]
        where = "parallel" if point is None else f"{point[1]:.0f}".replace("-", "−")
        rows.append(f"{name}  {what}: {where}{'' if ahead or point is None else ' *'}")
    if any("*" in row for row in rows):
        rows.append("* behind a contact, since the edge leans")
        rows.append("   away. Compare the squeezes instead:")
        rows.append("   their order does not change.")
    high = figure.get_figheight()
    text = "\n".join(rows)
    figure.text(4.35 / 7, 1 - 0.4 / high, text, va="top", size=8, linespacing=1.5)


def _draw_squeezes(figure: Figure, state: State) -> None:
    """The squeezes for which each contact is in balance, with the ends L₁, R₁ and R₂."""
    high = figure.get_figheight()
    ends = [0.0, *state.squeeze[np.isfinite(state.squeeze)]]
    low, top = float(min(ends)), float(max(ends))
    room = 0.16 * max(top - low, 0.01)
    axes = figure.add_axes((4.75 / 7, 0.45 / high, 2.1 / 7, 1.0 / high))
    view = View(axes, (low - room, top + room), (-0.6, 1.9))
    axes.set_yticks([1, 0], ["$I_L$", "$I_R$"])
    axes.locator_params(axis="x", nbins=4)
    axes.set_xlabel(axis_label("squeeze H", "weight"))
    view.line((0, -0.6), (0, 1.9), zorder=1)
    for side, name in enumerate(SIDES):
        start, end = state.squeeze[side]
        level = 1 - side
        if start > end:  # no squeeze balances this contact
            view.label("none", (0.5 * (low + top), level), (0, 1), size=7.5)
            continue
        shown = np.clip((start, end), low - room, top + room)
        axes.plot(shown, (level, level), color=HUE[name], ls=LINE[name], lw=2)
        for value, mark, point in ((start, "<", ("", "R₂")[side]), (end, ">", ("L₁", "R₁")[side])):
            x = min(max(value, low - room), top + room)
            mark = "|" if math.isfinite(value) else mark
            axes.plot(x, level, mark, color=HUE[name], ms=7, clip_on=False)
            if point and math.isfinite(value):
                view.label(point, (x, level + 0.1), (0, 1))
    result_mode = "not held, or jammed" if state.closing is None else "–".join(state.closing)
    text = f"SL–ST needs R₂ ≤ L₁ ≤ R₁ in squeeze.\nDriven together here: {result_mode}"
    figure.text(4.35 / 7, 1.6 / high, text, size=8, linespacing=1.5)

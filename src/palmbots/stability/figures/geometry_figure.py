# SPDX-License-Identifier: Apache-2.0
"""The paper's Figure 2 for any scene: the geometry and its symbols, to scale.

The left palm is shallow and the right one steep. Source: paper, section 2; docs/theory/notation.md.
"""

import math

import numpy as np
from matplotlib.figure import Figure

from palmbots._types import SIDES
from palmbots.stability.figures.canvas import MM, Array, View, panel, sheet
from palmbots.stability.figures.drawn_state import State, draw_bodies, draw_description, shown_area
from palmbots.viz.style import HUE, styled

_LETTER = ("L", "R")


def figure2(state: State) -> Figure:
    """The geometry and its symbols."""
    with styled():
        x, y = shown_area(state, (), math.inf)
        width = 6.25
        point = (x[1] - x[0]) / (72 * width)
        # Room for w above the object and for d at the bottom.
        y = (
            y[0] - 14 * point,
            max(float((c + _top(state, 30 * point))[1]) for c in state.point("contact")),
        )
        figure = sheet(7.0, width * (y[1] - y[0]) / (x[1] - x[0]) + 0.75)
        view = panel(figure, 0.6, 0.45, width, x, y)
        draw_description(figure, state)
        draw_bodies(view, state)
        _draw_palm_symbols(view, state)
        _draw_object_symbols(view, state)
        return figure


def _top(state: State, beyond: float) -> Array:
    """The vector from the line of contacts, at right angles, to just above the object."""
    way = np.array([-math.sin(state.turn), math.cos(state.turn)])
    left = state.vertex(0)
    return way * (float(((state.point("outline") - left) @ way).max()) + beyond)


def _draw_palm_symbols(view: View, state: State) -> None:
    """The symbols θ, p, o and d."""
    level = view.corners[0][1] + 16 * view.point
    pivots = state.point("pivot")
    for side, name in enumerate(SIDES):
        letter, colour = _LETTER[side], HUE[name]
        outward = np.array([(-1, 1)[side], 0.0])
        foot = 0.5 * (state.point("palm_inner", side) + state.point("palm_outer", side))
        along, normal, half = (
            state.along(side),
            state.normal(side),
            MM * state.problem.half_length[side],
        )
        view.line(foot, foot + 1.14 * half * outward, ls="--")
        view.line(pivots[side], (pivots[side][0], level - 4 * view.point))
        start = math.pi if side == 0 else 0.0
        turn = -state.angles[side] if side == 0 else state.angles[side]
        view.arc(foot, 1.07 * half, start, start + turn, f"$\\theta_{letter}$", colour)
        p = MM * state.p[side]
        palm = state.problem.spec.palms[side]
        depth, offset = MM * palm.plate_thickness + 7 * view.point, MM * palm.offset
        if abs(depth - offset) < 7 * view.point:  # clear of the pivot
            depth = offset + 8 * view.point
        under = -depth * normal
        contact = state.point("contact", side)
        if p == 0:
            view.label(f"$p_{letter}$ = 0", foot + under, -normal, colour)
        else:
            view.line(contact, contact + 1.4 * under)
            view.line(foot, foot + 1.4 * under)
            view.span(foot + under, contact + under, f"$p_{letter}$", -normal, colour)
        if offset != 0:
            away = -np.sign(p or 1.0) * 9 * view.point * along
            for end in (foot, pivots[side]):
                view.line(end, end + 1.3 * away)
            view.span(pivots[side] + away, foot + away, f"$o_{letter}$", away, colour)
    view.span((pivots[0][0], level), (pivots[1][0], level), "d", (0, 1))


def _draw_object_symbols(view: View, state: State) -> None:
    """The symbols w, c_x, c_y and ϑ, and the names of the bodies."""
    cos, sin = math.cos(state.turn), math.sin(state.turn)
    ex, ey = np.array([cos, sin]), np.array([-sin, cos])
    left, right = state.vertex(0), state.vertex(1)
    com, width = state.point("com"), MM * state.problem.width
    top = _top(state, 12 * view.point)
    for corner in (left, right):
        view.line(corner, corner + _top(state, 16 * view.point))
    view.span(left + top, right + top, "w", ey)
    across, up = (MM * c for c in state.problem.com)
    view.line(left, right, zorder=1)
    view.span(left + ey * up, com - 4 * view.point * ex, "$c_x$", ey)
    view.span(left + ex * across, com - 4 * view.point * ey, "$c_y$", ex)
    # The arc of ϑ is in the gap below the object, if the right palm leaves one.
    gap = float(state.point("palm_inner", 1)[0] - left[0]) - 6 * view.point
    radius = min(max(gap, 0.25 * width), 0.38 * width)
    view.line(left, left + 1.4 * radius * np.array([1.0, 0.0]), ls="--")
    if abs(state.turn) > 1e-6:
        view.arc(left, radius, 0.0, state.turn, "ϑ")
    else:
        view.label("ϑ = 0", left + radius * ex, -ey)
    view.label("COM", com + 3 * view.point * ey, ey, size=8)
    view.label("$C_L$", left, (-1, 1))
    view.label("$C_R$", right, (1, 1))
    for side, name in enumerate(SIDES):
        view.label("pivot", state.point("pivot", side), (0, -1), HUE[name], size=7.5)
        tip = state.point("palm_inner", side)
        kind = ("shallow", "steep")[side]
        view.label(f"{name} palm ({kind})", tip, (0, -1), HUE[name], size=7.5)

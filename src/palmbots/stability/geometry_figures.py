"""The paper's Figures 2 to 4 for any scene: geometry and friction cones, to scale.

All show the left palm shallow and the right one steep. The paper draws its Figure 4 for φ < θ; with
φ > θ the steep palm's lower edge leans away and its line meets the line of gravity below, so beside
the points stand the squeezes, which are in order whatever the angles.
Source: paper, sections 2 and 3; MECHANICS sections 1, 2 and 4.
"""

import math
from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure

from palmbots.geometry import PALM_THICKNESS, SIDES
from palmbots.stability.drawing import (
    MM,
    Array,
    State,
    View,
    clipped,
    headline,
    meeting,
    panel,
    sheet,
)
from palmbots.stability.situation import Pair
from palmbots.style import BOTH, HATCH, HUE, INK, LINE, OBJECT, PALE, styled

__all__ = ["figure2", "figure3", "figure4"]

_UP, _DOWN = 1, -1
_LETTER = ("L", "R")
_GRAVITY = (0, (8, 1.5, 1.5, 1.5))


def _limits(state: State, above: Iterable[float], tallest: float) -> tuple[Pair, Pair]:
    """The part of the world to show [mm]: everything, and these heights unless too high."""
    shown = [state.point(n) for n in ("outline", "palm_inner", "palm_outer", "pivot", "contact")]
    low = np.min(np.concatenate(shown), axis=0)
    high = np.max(np.concatenate(shown), axis=0)
    room = 0.05 * float(high[0] - low[0])
    x = (float(low[0]) - room, float(high[0]) + room)
    bottom = float(low[1]) - 1.8 * room
    most = bottom + tallest * (x[1] - x[0])
    fit = [h for h in above if h + 1.5 * room <= most]
    return x, (bottom, max([float(high[1]), *fit]) + 1.5 * room)


def _draw_bodies(view: View, state: State) -> None:
    """Object, palms, contacts and COM."""
    outline = state.point("outline")
    view.fill(outline, fc=OBJECT, alpha=0.35, lw=0)
    view.line(*outline, outline[0], colour=INK, width=0.8)
    for side, name in enumerate(SIDES):
        inner, outer = state.point("palm_inner", side), state.point("palm_outer", side)
        under = -MM * PALM_THICKNESS * state.normal(side)
        pivot, foot = state.point("pivot", side), 0.5 * (inner + outer)
        plate = np.array([inner, outer, outer + under, inner + under])
        view.fill(plate, fc=PALE[name], ec=HUE[name], lw=0.4, hatch=2 * HATCH[name])
        view.avoid(inner + under, outer + under)
        view.line(inner, outer, colour=HUE[name], width=1.6)
        view.line(pivot, foot, colour=HUE[name], width=1.2)
        view.axes.plot(*pivot, "o", ms=4, mfc="white", mec=HUE[name], zorder=4)
        view.axes.plot(*state.point("contact", side), "o", ms=3.5, color=INK, zorder=5)
    com = state.point("com")
    view.axes.plot(*com, "o", ms=5, mfc="white", mec=INK, mew=0.8, zorder=5)
    view.axes.plot(*com, "+", ms=5, color=INK, mew=0.8, zorder=6)
    view.occupy(com)
    view.axes.set(xlabel="x [mm]", ylabel="y [mm]")


def _head(figure: Figure, state: State) -> None:
    """The state in numbers; without subscripts, which take long to set."""
    left, right = (math.degrees(a) for a in state.angles)
    text = (
        f"left: θ = {left:.4g}° (shallow), p = {MM * state.p[0]:.1f} mm;  "
        f"right: θ = {right:.4g}° (steep), p = {MM * state.p[1]:.1f} mm;  "
        f"object: ϑ = {math.degrees(state.turn):.2f}°"
    )
    top = 1 - 0.08 / figure.get_figheight()
    figure.text(0.6 / 7, top, text.replace("-", "−"), va="top", size=8)


def figure2(state: State) -> Figure:
    """The geometry and its symbols."""
    with styled():
        x, y = _limits(state, (), math.inf)
        width = 6.25
        point = (x[1] - x[0]) / (72 * width)
        # Room for w above the object and for d below everything.
        y = (
            y[0] - 14 * point,
            max(float((c + _top(state, 30 * point))[1]) for c in state.point("contact")),
        )
        figure = sheet(7.0, width * (y[1] - y[0]) / (x[1] - x[0]) + 0.75)
        view = panel(figure, 0.6, 0.45, width, x, y)
        _head(figure, state)
        _draw_bodies(view, state)
        _draw_palm_symbols(view, state)
        _draw_object_symbols(view, state)
        return figure


def _top(state: State, beyond: float) -> Array:
    """From the line of contacts at right angles to just above the object."""
    way = np.array([-math.sin(state.turn), math.cos(state.turn)])
    left = state.point("contact", 0)
    return way * (float(((state.point("outline") - left) @ way).max()) + beyond)


def _draw_palm_symbols(view: View, state: State) -> None:
    """θ, p, o, d, and the names of things."""
    level = view.corners[0][1] + 16 * view.point
    pivots = state.point("pivot")
    for side, name in enumerate(SIDES):
        letter, colour = _LETTER[side], HUE[name]
        outward = np.array([(-1, 1)[side], 0.0])
        foot = 0.5 * (state.point("palm_inner", side) + state.point("palm_outer", side))
        along, normal, half = state.along(side), state.normal(side), MM * state.at.half_length[side]
        view.line(foot, foot + 1.14 * half * outward, ls="--")
        view.line(pivots[side], (pivots[side][0], level - 4 * view.point))
        start = math.pi if side == 0 else 0.0
        turn = -state.angles[side] if side == 0 else state.angles[side]
        view.arc(foot, 1.07 * half, start, start + turn, f"$\\theta_{letter}$", colour)
        p = MM * state.p[side]
        depth, offset = MM * PALM_THICKNESS + 7 * view.point, MM * state.at.offset[side]
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
    """w, c_x, c_y, ϑ, and the names of things."""
    cos, sin = math.cos(state.turn), math.sin(state.turn)
    ex, ey = np.array([cos, sin]), np.array([-sin, cos])
    left, right = state.point("contact")
    com, width = state.point("com"), MM * state.at.width
    top = _top(state, 12 * view.point)
    for corner in (left, right):
        view.line(corner, corner + _top(state, 16 * view.point))
    view.span(left + top, right + top, "w", ey)
    across, up = (MM * c for c in state.at.com)
    view.line(left, right, zorder=1)
    view.span(left + ey * up, com - 4 * view.point * ex, "$c_x$", ey)
    view.span(left + ex * across, com - 4 * view.point * ey, "$c_y$", ex)
    # The arc of ϑ stands in the gap below the object, if the right palm leaves one.
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
        view.arc(apex, 0.22 * MM * state.at.width, ends[0], ends[1], text, HUE[name])


def _draw_gravity(view: View, state: State) -> None:
    for sign in (1, -1):
        view.ray(state.point("com"), sign * state.upward, INK, 1.1, _GRAVITY)


def _name_gravity(view: View, state: State) -> None:
    """Last of all: where the other labels leave room near the lower end."""
    com, low, way = state.point("com"), view.corners[0][1] + 16 * view.point, state.upward
    text = "gravity" if state.at.slope == 0 else "effective\ngravity"
    view.label(text, com + way * (low - com[1]) / way[1], (-1, 0), size=7.5)


def _on_gravity(state: State, side: int, slide: int) -> tuple[Array | None, bool]:
    """Where an edge's line meets the line of gravity, and whether that is ahead of the contact."""
    apex, way = state.point("contact", side), state.edge(side, slide)
    point = meeting(apex, way, state.point("com"), state.upward)
    return point, point is not None and float((point - apex) @ way) > 0


def figure3(state: State) -> Figure:
    """The tests of ST–ST and SL–ST with the friction cones."""
    with styled():
        apexes = state.point("contact")
        upper = meeting(apexes[0], state.edge(0, _UP), apexes[1], state.edge(1, _UP))
        point, _ = _on_gravity(state, 0, _UP)
        above = [float(p[1]) for p in (upper, point) if p is not None]
        x, y = _limits(state, [1.15 * h for h in above], 1.5)
        width = 2.85
        height = width * (y[1] - y[0]) / (x[1] - x[0])
        figure = sheet(7.0, height + 1.15)
        _head(figure, state)
        for k, mode in enumerate((("ST", "ST"), ("SL", "ST"))):
            view = panel(figure, 0.6 + 3.4 * k, 0.45, width, x, y)
            _draw_gravity(view, state)
            _draw_bodies(view, state)
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
    view.axes.plot(*point, "s", ms=4, mfc="white", mec=INK, zorder=7)
    view.occupy(point)
    if name:
        view.label(name, point + 2 * view.point, (1, 0))
    return True


_Meetings = dict[str, tuple[Array | None, bool]]
"""By name the points of Figure 4, and whether the force that makes them points there."""


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
    """The points on the line of gravity that decide property 1, and the squeezes they stand for."""
    with styled():
        found = _meetings(state)
        above = [float(p[1]) for p, ahead in found.values() if p is not None and ahead]
        x, y = _limits(state, [1.03 * h for h in above], 1.85)
        width = 3.4
        height = max(width * (y[1] - y[0]) / (x[1] - x[0]), 3.6)
        figure = sheet(7.0, height + 0.75)
        view = panel(figure, 0.6, 0.45, width, x, y)
        _head(figure, state)
        _draw_gravity(view, state)
        _draw_bodies(view, state)
        view.ray(state.point("contact", 0), state.edge(0, _UP), HUE["left"], 1.4)
        _draw_cone(view, state, 1)
        if not found["R₂"][1]:
            start = state.point("contact", 1)
            view.ray(start, -state.edge(1, _DOWN), HUE["right"], 0.9, (0, (1, 1.5)))
        for name, (point, _) in found.items():
            _mark(view, point, name)
        _draw_angles(view, state)
        _name_gravity(view, state)
        _tell_meetings(figure, found)
        _draw_squeezes(figure, state)
        return figure


def _draw_angles(view: View, state: State) -> None:
    """α₁, β₁, β₂ of the edges; q, s, γ, δ of the COM."""
    width, com = MM * state.at.width, state.point("com")
    edges = (((_UP, "α₁", 0.2),), ((_UP, "β₁", 0.2), (_DOWN, "β₂", 0.28)))
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


def _tell_meetings(figure: Figure, found: _Meetings) -> None:
    """The points' heights in words."""
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
        rows.append("* behind a contact: that edge leans away")
        rows.append("   from there. Compare squeezes: they stay")
        rows.append("   in order (heights do not).")
    high = figure.get_figheight()
    text = "\n".join(rows)
    figure.text(4.35 / 7, 1 - 0.4 / high, text, va="top", size=8, linespacing=1.5)


def _draw_squeezes(figure: Figure, state: State) -> None:
    """The squeezes each contact bears, with the ends that stand for L₁, R₁ and R₂."""
    high = figure.get_figheight()
    ends = [0.0, *state.squeeze[np.isfinite(state.squeeze)]]
    low, top = float(min(ends)), float(max(ends))
    room = 0.16 * max(top - low, 0.01)
    axes = figure.add_axes((4.75 / 7, 0.45 / high, 2.1 / 7, 1.0 / high))
    view = View(axes, (low - room, top + room), (-0.6, 1.9))
    axes.set_yticks([1, 0], ["$I_L$", "$I_R$"])
    axes.locator_params(axis="x", nbins=4)
    axes.set_xlabel("squeeze H [weight]")
    view.line((0, -0.6), (0, 1.9), zorder=1)
    for side, name in enumerate(SIDES):
        start, end = state.squeeze[side]
        level = 1 - side
        if start > end:  # no squeeze makes this contact bear its share
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
    happens = "not held, or jammed" if state.closing is None else "–".join(state.closing)
    text = f"SL–ST needs R₂ ≤ L₁ ≤ R₁ in squeeze.\nDriven together here: {happens}"
    figure.text(4.35 / 7, 1.6 / high, text, size=8, linespacing=1.5)

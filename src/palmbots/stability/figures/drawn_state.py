# SPDX-License-Identifier: Apache-2.0
"""The state that Figures 2 to 4 draw: its numbers, its bodies and its description."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.mechanics.acting_object import acting_object
from palmbots.mechanics.contact_modes import CONTACT_MODES, ContactMode, contact_modes_batch
from palmbots.scene.placement import Placement, place
from palmbots.stability.figures.canvas import MM, Array, View
from palmbots.stability.problem import Pair, StabilityProblem
from palmbots.viz.style import BACKGROUND, HATCH, HUE, INK, OBJECT, PALE, axis_label


@dataclass(frozen=True)
class State:
    """A state with the left palm shallow and the right one steep."""

    problem: StabilityProblem
    p: Pair  #: contact coordinates, m
    angles: Pair
    separation: float  #: d, m
    turn: float  #: ϑ
    placed: Placement  #: one row, m
    squeeze: Array  #: I_L and I_R, (side, end)
    balances: frozenset[ContactMode]
    closing: ContactMode | None  #: the contact mode when the palms are driven together

    def point(self, name: str, side: int | None = None) -> Array:
        """A point or the outline, as `Placement` names it, in mm."""
        points = MM * getattr(self.placed, name)[0]
        return points if side is None else points[side]

    def along(self, side: int) -> Array:
        """u, outward along a palm."""
        return np.array([(-1, 1)[side] * math.cos(self.angles[side]), math.sin(self.angles[side])])

    def normal(self, side: int) -> Array:
        """n, from a palm towards the object."""
        return np.array([(1, -1)[side] * math.sin(self.angles[side]), math.cos(self.angles[side])])

    def edge(self, side: int, slide: int) -> Array:
        """The edge of a friction cone of the force while the contact slides up (1) or down (-1)."""
        lean = self.angles[side] + slide * math.atan(self.problem.friction[side])
        return np.array([(1, -1)[side] * math.sin(lean), math.cos(lean)])

    def vertex(self, side: int) -> Array:
        """A contact vertex, or the centre of the arc that rounds it, in mm."""
        return self.point("contact", side) + MM * self.problem.radius[side] * self.normal(side)

    @property
    def upward(self) -> Array:
        """Opposite to the effective gravity: weight and horizontal force together."""
        return np.array([self.problem.slope, 1.0]) / math.hypot(self.problem.slope, 1.0)


def state_of(problem: StabilityProblem, p_m: Pair) -> State:
    """The state with these contact coordinates.

    Raises:
        PalmbotsError: a contact is beyond its palm, or the object cannot span the contacts.
    """
    for side, p, half in zip(SIDES, p_m, problem.half_length, strict=True):
        if not abs(p) <= half:
            raise PalmbotsError(
                f"p_m: {side} value is {p:g}; allowed: on the palm, {-half:g} to {half:g} m"
            )
    angles = problem.palms("left")
    cos, sin = np.cos(angles), np.sin(angles)
    heights = np.array(p_m) * sin + np.array(problem.offset) * cos
    rise = float(heights[1] - heights[0])
    if not abs(rise) < problem.width:
        raise PalmbotsError(
            f"p_m: contacts at {p_m[0]:g} and {p_m[1]:g} m differ in height by {abs(rise):.3g} m; "
            f"allowed: less than the object's width, {problem.width:g} m"
        )
    span = math.sqrt((problem.width - rise) * (problem.width + rise))
    separation = span - float(np.array(p_m) @ cos - np.array(problem.offset) @ sin)
    turn = math.asin(rise / problem.width)
    acting = acting_object(problem.spec, np.transpose([angles]), np.transpose([p_m]))
    modes = contact_modes_batch(
        width=acting.width[0],
        com_x=acting.com_left[0],
        com_y=acting.com_height[0],
        theta_left=angles[0],
        theta_right=angles[1],
        p_left=p_m[0],
        p_right=p_m[1],
        friction_left=problem.friction[0],
        friction_right=problem.friction[1],
        offset_left=problem.spec.palms[0].offset,
        offset_right=problem.spec.palms[1].offset,
        slope=problem.slope,
    )
    closing = int(modes.closing)
    placed = place(
        problem.spec,
        separation=[separation],
        midpoint=[0.0],
        palm=[angles],
        contact=[p_m],
        turn=[turn],
    )
    balances = frozenset(m for m, ok in zip(CONTACT_MODES, modes.feasible, strict=True) if ok)
    mode = CONTACT_MODES[closing] if closing >= 0 else None
    return State(problem, p_m, angles, separation, turn, placed, modes.squeeze, balances, mode)


def shown_area(state: State, above: Iterable[float], tallest: float) -> tuple[Pair, Pair]:
    """The area to show [mm]: all bodies, and those of the given heights that fit."""
    shown = [state.point(n) for n in ("outline", "palm_inner", "palm_outer", "pivot", "contact")]
    low = np.min(np.concatenate(shown), axis=0)
    high = np.max(np.concatenate(shown), axis=0)
    room = 0.05 * float(high[0] - low[0])
    x = (float(low[0]) - room, float(high[0]) + room)
    bottom = float(low[1]) - 1.8 * room
    most = bottom + tallest * (x[1] - x[0])
    fit = [h for h in above if h + 1.5 * room <= most]
    return x, (bottom, max([float(high[1]), *fit]) + 1.5 * room)


def draw_bodies(view: View, state: State) -> None:
    """Object, palms, contacts and COM."""
    outline = state.point("outline")
    view.fill(outline, fc=OBJECT, alpha=0.35, lw=0)
    view.line(*outline, outline[0], colour=INK, width=0.8)
    for side, name in enumerate(SIDES):
        inner, outer = state.point("palm_inner", side), state.point("palm_outer", side)
        pivot, foot = state.point("pivot", side), 0.5 * (inner + outer)
        plate = state.point("plate", side)
        view.fill(plate, fc=PALE[name], ec=HUE[name], lw=0.4, hatch=2 * HATCH[name])
        view.avoid(*plate)
        view.line(inner, outer, colour=HUE[name], width=1.6)
        view.line(pivot, foot, colour=HUE[name], width=1.2)
        view.axes.plot(*pivot, "o", ms=4, mfc=BACKGROUND, mec=HUE[name], zorder=4)
        view.axes.plot(*state.point("contact", side), "o", ms=3.5, color=INK, zorder=5)
    com = state.point("com")
    view.axes.plot(*com, "o", ms=5, mfc=BACKGROUND, mec=INK, mew=0.8, zorder=5)
    view.axes.plot(*com, "+", ms=5, color=INK, mew=0.8, zorder=6)
    view.occupy(com)
    view.axes.set(xlabel=axis_label("x", "mm"), ylabel=axis_label("y", "mm"))


def draw_description(figure: Figure, state: State) -> None:
    """The state in numbers, without subscripts, which are slow to typeset."""
    left, right = (math.degrees(a) for a in state.angles)
    text = (
        f"left: θ = {left:.4g}° (shallow), p = {MM * state.p[0]:.1f} mm;  "
        f"right: θ = {right:.4g}° (steep), p = {MM * state.p[1]:.1f} mm;  "
        f"object: ϑ = {math.degrees(state.turn):.2f}°"
    )
    top = 1 - 0.08 / figure.get_figheight()
    figure.text(0.6 / 7, top, text.replace("-", "−"), va="top", size=8)

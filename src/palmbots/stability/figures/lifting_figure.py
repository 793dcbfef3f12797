# SPDX-License-Identifier: Apache-2.0
"""An object on the floor, the palms that pick it up and put it down, and the contact forces, to
scale; beside each state what happens at the nose, enlarged.

Forces are those of `palmbots.mechanics.lifting_forces`. Source: docs/theory/lifting.md.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.mechanics.lift_margins import Lifting
from palmbots.mechanics.lifting_bodies import Climb, Plate, Point, Standing
from palmbots.mechanics.lifting_forces import Docking, docking, raised_by
from palmbots.stability.analysis import Analysis
from palmbots.viz.style import BACKGROUND, DROP, FLOOR, HUE, INK, OBJECT, QUIET, axis_label, styled

MM = 1e3
_OUT = (-1.0, 1.0)
_NEAR = 9.0  # mm, shown around a nose
_LONG = 0.09  # m, the length of an arrow as long as the weight
_LONGEST = 0.13


@dataclass(frozen=True)
class _State:
    """One balance: where the object and the palms are, and the forces on the object."""

    title: str
    body: Standing
    side: int
    """Whose nose or palm decides."""
    pivots: tuple[Point, Point]
    angles: tuple[float, float]
    forces: list[tuple[Point, Point, str]]
    """Where, what [N], and the colour."""
    note: str
    fails: bool
    zoom: Point


def lifting_forces(analysis: Analysis) -> Figure:
    """The states that decide whether an object is picked up and put down, with their forces."""
    found = analysis.lifting
    if found is None or not found.is_on_floor:
        raise PalmbotsError(
            "figure: lifting-forces needs a job that begins or ends on the floor; allowed: a scene "
            'with task.from or task.to = "floor"'
        )
    spec = analysis.problem.spec
    states = list(_states(found))
    with styled():
        figure = Figure(figsize=(8.0, 2.5 * len(states)), layout="constrained")
        axes = figure.subplots(len(states), 2, width_ratios=(3.1, 1), squeeze=False)
        for (wide, near), state in zip(axes, states, strict=True):
            _draw(wide, spec, state, near=False)
            _draw(near, spec, state, near=True)
        for axis in axes[-1]:
            axis.set_xlabel(axis_label("along the floor", "mm"), fontsize=8)
        return figure


def _states(found: Lifting) -> Iterator[_State]:
    steep = found.plates[1]
    body = found.body
    docks = [docking(body, steep, side) for side in (0, 1)]
    first = 0 if docks[0].alone <= docks[1].alone else 1
    if found.picks_up:
        second = 1 - first
        yield _first(body, steep, first)
        yield _second(body, steep, second, docks[second])
    if found.puts_down:
        yield _leaving(body, steep, 1, found.floor_friction)


def _first(body: Standing, plates: tuple[Plate, Plate], side: int) -> _State:
    plate, other = plates[side], 1 - side
    lean = plate.nose_lean(body.radii[side])
    leans = 0.0, plates[other].nose_lean(body.radii[other])  # floor or nose below the other corner
    feet = [(up, body.touching(other, up)) for up in leans]
    climbs = [(body.climb(side, lean, lean + plate.friction, foot), up) for up, foot in feet]
    climb, foot_lean = max(climbs, key=lambda one: one[0].squeeze)
    pivots = tuple(_at_nose(body, plates[k], k) for k in (0, 1))
    name = SIDES[side]
    return _State(
        f"the {name} nose gets under first",
        body,
        side,
        (pivots[0], pivots[1]),
        (plates[0].angle, plates[1].angle),
        _forces(body, climb, side, lean, foot_lean, QUIET),
        _note(climb, f"grey: force of the floor and the {SIDES[other]} robot together"),
        not math.isfinite(climb.squeeze),
        body.touching(side, lean),
    )


def _second(body: Standing, plates: tuple[Plate, Plate], side: int, dock: Docking) -> _State:
    other, state = 1 - side, dock.second
    plate, r = plates[other], body.radii[other]
    raised = raised_by(body, plate, other, dock.needs_heel) or body
    at_heel = plate.at_heel(r, raised.side_lean(other, plate))
    lean = dock.lean - (abs(raised.tilt) if state is dock.rolled else 0.0)
    direction = lean + plates[side].friction
    load = state.squeeze / math.tan(direction) if direction > 0 else 0.5 * body.weight
    push = state.squeeze - (1, -1)[side] * body.slope * body.weight
    climb = Climb(load, state.squeeze, body.weight - load, push)
    pivots: list[Point] = [(0.0, 0.0), (0.0, 0.0)]
    pivots[side] = _at_nose(raised, plates[side], side)
    pivots[other] = _under(raised, plate, other, at_heel if dock.needs_heel else -plate.half)
    where = "at the heel" if dock.needs_heel else "on its palm"
    holds = "any squeeze" if math.isinf(state.held) else f"up to {state.held:.2f} N"
    return _State(
        f"the {SIDES[side]} nose gets under second, the other corner is {where}",
        raised,
        side,
        (pivots[0], pivots[1]),
        (plates[0].angle, plates[1].angle),
        _forces(raised, climb, side, lean, plate.angle, HUE[SIDES[other]]),
        _note(climb, f"the {SIDES[other]} palm holds {holds}"),
        not state.works,
        raised.touching(side, lean),
    )


def _leaving(body: Standing, plates: tuple[Plate, Plate], side: int, friction: float) -> _State:
    plate, other = plates[side], 1 - side
    heights = list(body.heights)
    heights[side] = plate.centre_height(-0.5 * plate.half, body.radii[side])
    raised = replace(body, heights=(heights[0], heights[1]))
    climb = raised.climb(
        side, plate.angle, plate.angle - plate.friction, raised.touching(other, 0.0)
    )
    pivots: list[Point] = [(0.0, 0.0), (0.0, 0.0)]
    pivots[side] = _under(raised, plate, side, -0.5 * plate.half)
    near = _at_nose(raised, plates[other], other)
    pivots[other] = (near[0] + _OUT[other] * 0.02, near[1])
    needed = abs(climb.other_squeeze) / climb.other_load
    return _State(
        f"the {SIDES[side]} palm leaves last",
        raised,
        side,
        (pivots[0], pivots[1]),
        (plates[0].angle, plates[1].angle),
        _forces(raised, climb, side, plate.angle, 0.0, QUIET),
        _note(climb, f"the other corner stays from a floor friction of {needed:.2f} on"),
        friction < needed,
        raised.touching(other, 0.0),
    )


def _note(climb: Climb, more: str) -> str:
    if not math.isfinite(climb.squeeze):
        return f"no squeeze suffices; {more}"
    way = "inward" if climb.squeeze >= 0 else "outward"
    return f"V = {climb.load:.2f} N, H = {abs(climb.squeeze):.2f} N {way}; {more}"


def _forces(
    body: Standing, climb: Climb, side: int, lean: float, other_lean: float, other_colour: str
) -> list[tuple[Point, Point, str]]:
    forces: list[tuple[Point, Point, str]] = [
        (body.com_at, (-body.slope * body.weight, -body.weight), INK)
    ]
    if math.isfinite(climb.squeeze):
        for k, push, load, at, colour in (
            (side, climb.squeeze, climb.load, lean, HUE[SIDES[side]]),
            (1 - side, climb.other_squeeze, climb.other_load, other_lean, other_colour),
        ):
            forces.append((body.touching(k, at), (-_OUT[k] * push, load), colour))
    return forces


def _at_nose(body: Standing, plate: Plate, side: int) -> Point:
    """The pivot of a palm whose nose touches its edge."""
    x, _ = body.touching(side, plate.nose_lean(body.radii[side]))
    reach = plate.half * math.cos(plate.angle) + plate.offset * math.sin(plate.angle)
    return x + _OUT[side] * reach, plate.pivot


def _under(body: Standing, plate: Plate, side: int, p: float) -> Point:
    """The pivot of a palm with an arc on its surface."""
    x, _ = body.centres[side]
    high = plate.offset + body.radii[side]
    along = p * math.cos(plate.angle) - high * math.sin(plate.angle)
    return x - _OUT[side] * along, plate.pivot


def _plate_corners(
    palm: _core.PalmSpec, pivot: Point, angle: float, side: int
) -> NDArray[np.float64]:
    """The cross-section of a palm; its heel is drawn 1.5 mm thick."""
    half, top = 0.5 * palm.length, palm.offset
    thick = palm.thickness or 1e-4
    nose, bevel = min(palm.nose, thick), palm.bevel
    outline = [(-half, top), (half, top)]
    if palm.heel > 0:
        outline += [(half, top + palm.heel), (half + 0.0015, top + palm.heel)]
        outline += [(half + 0.0015, top - thick)]
    else:
        outline += [(half, top - thick)]
    outline += [(-half + bevel, top - thick), (-half, top - nose)]
    u, n = np.array(outline).T
    x = pivot[0] + _OUT[side] * (u * math.cos(angle) - n * math.sin(angle))
    return np.stack([x, pivot[1] + u * math.sin(angle) + n * math.cos(angle)], axis=-1)


def _draw(axes: Axes, spec: _core.Spec, state: _State, *, near: bool) -> None:
    body = state.body
    turn, (gx, gy) = body.tilt, body.com_at
    cos, sin = math.cos(turn), math.sin(turn)
    points = np.array(spec.silhouette) - [spec.com_left, spec.com_height]
    outline = points @ np.array([[cos, sin], [-sin, cos]]) + [gx, gy]
    axes.axhspan(-1000, 0, color=FLOOR, zorder=0)
    axes.axhline(0, color=QUIET, lw=1, zorder=1)
    axes.fill(*(MM * outline).T, facecolor=OBJECT, edgecolor=INK, lw=1, zorder=2)
    for k, side in enumerate(SIDES):
        corners = _plate_corners(spec.palms[k], state.pivots[k], state.angles[k], k)
        axes.fill(*(MM * corners).T, facecolor=HUE[side], edgecolor=HUE[side], lw=0.6, zorder=3)
        x, y = state.pivots[k]
        axes.plot(MM * x, MM * y, "o", ms=4, mfc=BACKGROUND, mec=INK, zorder=4)
    shrink = (0.15 if near else 1.0) * _LONG / body.weight
    for at, force, colour in state.forces:
        longest = math.hypot(*force) * shrink
        scale = shrink * min(1.0, _LONGEST / longest if longest > 0 else 1.0)
        start = MM * at[0], MM * at[1]
        end = start[0] + MM * scale * force[0], start[1] + MM * scale * force[1]
        axes.annotate(
            "", xy=end, xytext=start, zorder=6,
            arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.8, "shrinkA": 0,
                        "shrinkB": 0},
        )  # fmt: skip
    axes.set_aspect("equal")
    axes.grid(False)
    axes.tick_params(labelsize=7)
    if near:
        x, y = (MM * c for c in state.zoom)
        axes.set(xlim=(x - _NEAR, x + _NEAR), ylim=(-2.5, 1.4 * _NEAR - 2.5))
        axes.set_title("enlarged", fontsize=8)
        return
    ends = [MM * (x + _OUT[k] * 0.09) for k, (x, _) in enumerate(state.pivots)]
    top = MM * max(float(outline[:, 1].max()), gy) + 8
    axes.set(xlim=(min(ends), max(ends)), ylim=(-MM * 0.055, top))
    colour = DROP if state.fails else INK
    axes.set_title(f"{state.title}\n{state.note}", fontsize=8.5, loc="left", color=colour)
    axes.set_ylabel(axis_label("height", "mm"), fontsize=8)

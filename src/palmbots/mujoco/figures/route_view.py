# SPDX-License-Identifier: Apache-2.0
"""Draws a route from above: way points, walls, the stages, and what the pair covers of the floor.

x and y as in the way points, metres. The object stands where each stage begins, and where the last
one ends. Of a carry, the object is also drawn where each stage left it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from palmbots._util.text import plural
from palmbots.mujoco.route_carry import RouteCarry
from palmbots.mujoco.route_geometry import ahead, heading
from palmbots.mujoco.route_plan import RoutePlan, RouteStage
from palmbots.mujoco.route_stage import Pair
from palmbots.scene.path_section import Point
from palmbots.viz.style import (
    DROP,
    FLOOR,
    INK,
    LEADER,
    OBJECT,
    PAPER,
    PATH,
    QUIET,
    axis_label,
    styled,
)

_WIDE_IN, _MOST_IN = 5.6, 7.0
_HEAD_IN = 0.95


def draw_route(found: RoutePlan | RouteCarry) -> Figure:
    """Draw a plan, or a carry along it."""
    plan = found.plan if isinstance(found, RouteCarry) else found
    pair = Pair(plan.scene)
    tracks = [track(pair, stage) for stage in plan.stages]
    with styled():
        covered = [one for stage in plan.stages for one in swept(pair, stage)]
        points = np.array(
            [corner for shape in covered for corner in shape]
            + list(pair.points)
            + [(wall[i], wall[i + 1]) for wall in pair.route.walls_m or () for i in (0, 2)]
        )
        low, high = points.min(axis=0) - 0.1, points.max(axis=0) + 0.1
        tall = min(_MOST_IN, _WIDE_IN * (high[1] - low[1]) / (high[0] - low[0]))
        wide = min(_WIDE_IN, tall * (high[0] - low[0]) / (high[1] - low[1]))
        figure = Figure(figsize=(_WIDE_IN + 0.9, tall + _HEAD_IN + 0.55))
        width, height = figure.get_size_inches()
        panel = figure.add_axes((0.65 / width, 0.5 / height, wide / width, tall / height))
        for shape in covered:
            panel.add_patch(Polygon(shape, fc=FLOOR, ec="none", zorder=0))
        x, y = zip(*pair.points, strict=True)
        panel.plot(x, y, color=LEADER, lw=1, ls=(0, (4, 2)), marker="+", ms=6, zorder=1)
        for wall in pair.route.walls_m or ():
            panel.plot(wall[::2], wall[1::2], color=INK, lw=3, solid_capstyle="butt", zorder=2)
        for k, line in enumerate(tracks, start=1):
            _draw_stage(panel, line, k)
        _draw_objects(panel, pair, plan.stages)
        if isinstance(found, RouteCarry):
            _draw_ends(panel, pair, found)
        panel.set_aspect("equal")
        panel.set_xlim(low[0], high[0])
        panel.set_ylim(low[1], high[1])
        panel.set_xlabel(axis_label("x", "m"))
        panel.set_ylabel(axis_label("y", "m"))
        _head(figure, found)
    return figure


def track(pair: Pair, stage: RouteStage) -> np.ndarray:
    """Places of the middle of the pair on its path in a stage, in the frame of the route."""
    curve = pair.curve(stage.waypoints_m)
    return np.array([
        _placed(pair, stage, (spot.x, spot.y))
        for spot in map(curve.at, np.linspace(-pair.spread / 2, curve.length, 120))
    ])  # fmt: skip


def swept(pair: Pair, stage: RouteStage) -> list[list[Point]]:
    """The rectangles that the pair covers in a stage, in the frame of the route."""
    curve = pair.curve(stage.waypoints_m)
    shapes = pair.footprint.swept(curve, -pair.spread / 2, curve.length)
    return [[_placed(pair, stage, corner) for corner in one.corners()] for _, one in shapes]


def _placed(pair: Pair, stage: RouteStage, place: Point) -> Point:
    """A place in the frame of the route, given in that of the curve of a stage."""
    way = heading(stage.waypoints_m[0], stage.waypoints_m[1])
    return ahead(stage.waypoints_m[0], way, place[0] + pair.spread / 2, place[1])


def _draw_stage(panel: Axes, line: np.ndarray, number: int) -> None:
    panel.plot(*line.T, color=PATH, lw=1.6, zorder=3)
    middle = line[len(line) // 2]
    panel.annotate(
        str(number), middle, ha="center", va="center", size=8, color=INK, zorder=6,
        bbox={"boxstyle": "circle,pad=0.25", "fc": PAPER, "ec": INK, "lw": 0.8},
    )  # fmt: skip


def _draw_objects(panel: Axes, pair: Pair, stages: tuple[RouteStage, ...]) -> None:
    """The object where the plan expects it between two stages, and at both ends."""
    poses = [(one.waypoints_m[0], heading(*one.waypoints_m[:2])) for one in stages]
    for where, way in (*poses, expected(stages[-1])):
        _draw_object(panel, pair, where, way, fc=OBJECT, ec=INK, lw=0.6, zorder=4)


def expected(stage: RouteStage) -> tuple[Point, float]:
    """Where the object of a stage is expected in the end, and its heading [rad]."""
    way = heading(stage.waypoints_m[-2], stage.waypoints_m[-1]) + math.radians(stage.drift_deg)
    return ahead(stage.waypoints_m[-1], way, 0.0, stage.drift_m), way


def _draw_ends(panel: Axes, pair: Pair, found: RouteCarry) -> None:
    """The object where each stage has left it."""
    for stage, end in zip(found.plan.stages, found.stages, strict=False):
        where, way = expected(stage)
        place, turn = ahead(where, way, end.ahead_m, end.aside_m), math.radians(end.turned_deg)
        _draw_object(panel, pair, place, way + turn, fc="none", ec=DROP, lw=1.0, zorder=5)


def _draw_object(panel: Axes, pair: Pair, where: Point, way: float, **look: Any) -> None:
    low, high = pair.footprint.ends
    half = 0.5 * pair.footprint.depth
    corners = [
        ahead(where, way, x, y) for x, y in ((low, -half), (high, -half), (high, half), (low, half))
    ]
    panel.add_patch(Polygon(corners, closed=True, **look))


def _head(figure: Figure, found: RoutePlan | RouteCarry) -> None:
    plan = found.plan if isinstance(found, RouteCarry) else found
    width, height = figure.get_size_inches()
    x = 0.65 / width
    title = f"{plural(len(plan.stages), 'stage')} along a route of {plan.length_m:.2f} m"
    facts = f"{plan.controller}  ·  from above"
    shown = [
        Line2D([], [], color=LEADER, lw=1, ls=(0, (4, 2)), marker="+", label="way points"),
        Line2D([], [], color=INK, lw=3, label="wall"),
        Line2D([], [], color=PATH, lw=1.6, label="middle of the pair"),
        Patch(fc=FLOOR, ec=QUIET, lw=0.4, label="covered by the pair"),
        Patch(fc=OBJECT, ec=INK, lw=0.6, label="object, expected"),
    ]
    if isinstance(found, RouteCarry):
        title = f"{found.outcome}: {title}"
        facts = f"{facts}  ·  {found.world}, seed {found.seed}"
        shown.append(Patch(fc="none", ec=DROP, lw=1.0, label="object, put down"))
    figure.text(x, 1 - 0.1 / height, title, va="top", weight="bold", size=9)
    figure.text(x, 1 - 0.28 / height, facts, va="top", size=7.5)
    figure.legend(
        handles=shown, loc="upper left", bbox_to_anchor=(x, 1 - 0.44 / height), ncols=3,
        borderaxespad=0, handlelength=2.0, columnspacing=1.2,
    )  # fmt: skip

# SPDX-License-Identifier: Apache-2.0
"""Draws a carry on a curved path from above: the path, the tracks of both pivots, the object.

x to the right and y up, metres. The object is drawn at even distances, between its two contact
edges. Arrows show its lateral slip on the palms, ten times as long as the slip.
"""

import math
import os
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.mujoco.curved_world import Line, line_of
from palmbots.viz.carry_figure import figure_title
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import DROP, HUE, INK, LINE, OBJECT, QUIET, axis_label, styled

if TYPE_CHECKING:
    from palmbots.simulation.result import Carry

_SHOWN = 7  # number of objects in the figure
_MAGNIFICATION = 10.0  # of the arrows of the slip
_WIDE_IN, _LEAST_IN, _MOST_IN = 6.5, 2.0, 8.0


def draw_plan_view(carry: "Carry") -> Figure:
    """Draw the plan view.

    Raises:
        PalmbotsError: the carry has no trace, or its path is straight.
    """
    if carry.trace is None or "pivot_x" not in carry.trace:
        raise PalmbotsError(
            "plan view: this carry has no places on the floor; allowed: world mujoco, record=True"
        )
    if not carry.scene.task.path.is_curved:
        raise PalmbotsError("plan view: the path is straight; allowed: a task.path with a curve")
    line = line_of(carry.scene)
    trace = carry.trace
    names = ("pivot_x", "pivot_y", "vertex_x", "vertex_y", "lateral")
    px, py, vx, vy, lateral = (trace[n].transpose("time", "side").to_numpy() for n in names)
    with styled():
        low = np.array([min(px.min(), vx.min()), min(py.min(), vy.min())]) - 0.16
        high = np.array([max(px.max(), vx.max()), max(py.max(), vy.max())]) + 0.16
        size = high - low
        tall = float(np.clip(_WIDE_IN * size[1] / size[0], _LEAST_IN, _MOST_IN))
        figure = Figure(figsize=(_WIDE_IN + 0.9, tall + 1.35))
        panel = figure.add_axes(
            (
                0.65 / figure.get_figwidth(),
                0.45 / figure.get_figheight(),
                _WIDE_IN / figure.get_figwidth(),
                tall / figure.get_figheight(),
            )
        )
        _draw_path(panel, line, trace["midpoint"].to_numpy())
        rows = _rows(trace["midpoint"].to_numpy())
        depth = carry.scene.object.depth_m
        for row in rows:
            _draw_object(panel, vx[row], vy[row], lateral[row], depth)
        for k, side in enumerate(SIDES):
            panel.plot(px[:, k], py[:, k], color=HUE[side], ls=LINE[side], lw=1.4)
            panel.plot(px[rows, k], py[rows, k], "o", color=HUE[side], ms=3)
        panel.set_aspect("equal")
        panel.set_xlim(low[0], high[0])
        panel.set_ylim(low[1], high[1])
        panel.set_xlabel(axis_label("x", "m"))
        panel.set_ylabel(axis_label("y", "m"))
        _head(figure, carry)
    return figure


def save(carry: "Carry", path: str | os.PathLike[str]) -> None:
    """Write the plan view to `path` as PNG, SVG or PDF, by its suffix."""
    write_figure(path, draw_plan_view(carry))


def _rows(ways: np.ndarray) -> list[int]:
    """Rows of the trace at even distances, the first and the last one included."""
    gone = np.maximum.accumulate(np.abs(ways))
    wanted = np.linspace(0.0, gone[-1], _SHOWN)
    return sorted({min(int(np.searchsorted(gone, w)), len(ways) - 1) for w in wanted})


def _draw_path(panel: Axes, line: Line, ways: np.ndarray) -> None:
    reach = line.spread / 2 + 0.1
    spots = [line.at(w) for w in np.linspace(ways.min() - reach, ways.max() + reach, 400)]
    panel.plot([s.x for s in spots], [s.y for s in spots], color=QUIET, lw=4, alpha=0.35, zorder=0)


def _draw_object(
    panel: Axes, x: np.ndarray, y: np.ndarray, lateral: np.ndarray, depth: float
) -> None:
    """The object between its two contact edges, and its lateral slip."""
    dx, dy = x[1] - x[0], y[1] - y[0]
    long = math.hypot(dx, dy)
    aside = np.array([-dy, dx]) / long
    ends = np.array([[x[0], y[0]], [x[1], y[1]]])
    side = 0.5 * depth * aside
    corners = [ends[0] - side, ends[1] - side, ends[1] + side, ends[0] + side]
    panel.add_patch(Polygon(corners, closed=True, fc=OBJECT, ec=INK, lw=0.5, alpha=0.55, zorder=1))
    for end, slip in zip(ends, lateral, strict=True):
        if abs(slip) < 2e-4:
            continue
        tip = end + _MAGNIFICATION * slip * aside
        panel.annotate(
            "", tip, end,
            arrowprops={"arrowstyle": "-|>", "color": DROP, "lw": 1.0, "shrinkA": 0, "shrinkB": 0,
                        "mutation_scale": 7}, zorder=4,
        )  # fmt: skip


def _head(figure: Figure, carry: "Carry") -> None:
    high, wide = figure.get_figheight(), figure.get_figwidth()
    facts = [f"seed {carry.seed}", "from above"]
    if carry.lateral_peak_m is not None:
        left, right = (1e3 * carry.lateral_peak_m[side] for side in SIDES)
        peaks = f"left {left:.1f}, right {right:.1f} mm".replace("-", "−")
        facts.insert(0, f"lateral peak {peaks}")
    x = 0.65 / wide
    figure.text(x, 1 - 0.1 / high, figure_title(carry), va="top", weight="bold", size=9)
    figure.text(x, 1 - 0.28 / high, "  ·  ".join(facts), va="top", size=7.5)
    handles = [
        Line2D([], [], color=QUIET, lw=4, alpha=0.35, label="path"),
        *(Line2D([], [], color=HUE[s], ls=LINE[s], label=f"{s} pivot") for s in SIDES),
        Patch(fc=OBJECT, ec=INK, lw=0.5, alpha=0.55, label="object"),
        Line2D([], [], color=DROP, lw=1.0, label=f"lateral slip, {_MAGNIFICATION:g} × as long"),
    ]
    figure.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(x, 1 - 0.44 / high),
        ncols=len(handles), borderaxespad=0, handlelength=2.0, columnspacing=1.2,
    )  # fmt: skip

# SPDX-License-Identifier: Apache-2.0
"""The trade-off of a design for delivery: σ* and tolerance of the pairs of angles that were tried.

Left: about σ* of each pair over both angles. Right: the same over its tolerance. The chosen pair
and the scene's own are marked in both; on the right with the 95 % intervals of their σ*.
"""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from palmbots.stability.angle_grid import LIFT, QUANTITIES
from palmbots.stability.design_result import Design, limit_text
from palmbots.viz.style import (
    BACKGROUND,
    COLOUR_MAP,
    INK,
    PAPER_PAIR,
    QUIET,
    axis_label,
    styled,
)

BEST_LOOK: Any = {"marker": "*", "ms": 13, "mfc": BACKGROUND, "mec": INK, "mew": 0.9}
_OWN_LOOK: Any = {
    "marker": "o",
    "ms": 6.5,
    "mfc": PAPER_PAIR,
    "mec": BACKGROUND,
    "mew": 0.9,
}


def delivery(result: Design) -> Figure:
    """Draw about σ* of all pairs that were tried, over their angles and over their tolerance."""
    assert result.quantity != LIFT
    *_, scale, name = QUANTITIES[result.quantity]
    grid = result.map
    sigma = 100 * grid["sigma_star"].to_numpy()
    rows, columns = np.nonzero(np.isfinite(sigma))
    order = np.argsort(sigma[rows, columns])  # the best ones on top
    rows, columns = rows[order], columns[order]
    value = sigma[rows, columns]
    shallow, steep = grid["shallow"].to_numpy()[rows], grid["steep"].to_numpy()[columns]
    tolerance = scale * grid["tolerance"].to_numpy()[rows, columns]
    look: dict[str, Any] = {"cmap": COLOUR_MAP, "s": 16, "lw": 0}
    with styled():
        figure = Figure(figsize=(7.2, 4.2), layout="constrained")
        left, right = figure.subplots(1, 2)
        dots = left.scatter(steep, shallow, c=value, marker="s", **look)
        right.scatter(tolerance, value, c=value, **look)
        figure.colorbar(dots, ax=left, pad=0.02, label=axis_label("σ*, about", "cm/s"))
        left.set(
            xlabel=axis_label("steep palm angle", "°"), ylabel=axis_label("shallow palm angle", "°")
        )
        right.set(
            xlabel=axis_label(f"tolerance of {name}, ±", result.shown_unit),
            ylabel=axis_label("σ*", "cm/s"),
            xlim=(0, None),
        )
        left.plot(result.steep_deg, result.shallow_deg, ls="", zorder=5, **BEST_LOOK)
        _mark(right, scale * result.tolerance, result.noise_limit, BEST_LOOK, INK)
        own = result.own
        if own.angles_deg is not None:
            left.plot(own.angles_deg[1], own.angles_deg[0], ls="", zorder=5, **_OWN_LOOK)
        if own.tolerance is not None:
            _mark(right, scale * own.tolerance, own.noise_limit, _OWN_LOOK, PAPER_PAIR)
        figure.legend(
            handles=[
                Line2D([], [], ls="", label=_best_text(result), **BEST_LOOK),
                Line2D([], [], ls="", label=_own_text(result), **_OWN_LOOK),
                Line2D(
                    [], [], ls="", marker="s", ms=4, mfc=QUIET, mew=0,
                    label=f"{len(value)} candidates, σ* estimated from few carries",
                ),
            ],
            loc="outside upper left",
            title=_title(result),
            alignment="left",
        )  # fmt: skip
        return figure


def _mark(axes: Any, x: float, limit: Any, look: dict[str, Any], colour: str) -> None:
    if limit is None:
        return
    y = 100 * limit.sigma_star_m_s
    ends = [[y - 100 * limit.interval[0]], [100 * limit.interval[1] - y]]
    axes.errorbar(x, y, yerr=ends, ls="", zorder=5, ecolor=colour, capsize=3, **look)


def _title(result: Design) -> str:
    name = "" if result.noise_limit is None else f", {result.noise_limit.controller}"
    return f"σ*: speed noise at which 1 % of carries drop the object{name}"


def _best_text(result: Design) -> str:
    limit = "none" if result.noise_limit is None else limit_text(result.noise_limit)
    return (
        f"best pair, {result.shallow_deg:g}° and {result.steep_deg:g}°: σ* {limit}, "
        f"tolerance {result.tolerance_text(result.tolerance)}"
    )


def _own_text(result: Design) -> str:
    own = result.own
    limit = "none" if own.noise_limit is None else limit_text(own.noise_limit)
    tolerance = "none" if own.tolerance is None else result.tolerance_text(own.tolerance)
    return f"{own.name()}: σ* {limit}, tolerance {tolerance}"

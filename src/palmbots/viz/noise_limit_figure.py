# SPDX-License-Identifier: Apache-2.0
"""Draws a noise limit: the drop rate over the noise, the fitted curve, and where it crosses."""

from statistics import NormalDist
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palmbots.viz.style import (
    BACKGROUND,
    INK,
    QUIET,
    axis_label,
    controller_looks,
    controller_title,
    footnote,
    plain_numbers,
    styled,
)
from palmbots.viz.sweep_figure import few_ticks

if TYPE_CHECKING:
    from palmbots.simulation.noise_limit import NoiseLimit, NoisePoint

_FURTHEST = 2.0  # times σ*, in both directions
_LOWEST = 0.02  # of the rate


def draw_noise_limit(result: "NoiseLimit") -> Figure:
    """Draw the drop rate over the noise, both with 95 % intervals; the axis of the rate is
    logarithmic.

    Faint marks are the pilot run; arrows are upper ends of intervals where no carry dropped.
    """
    normal = NormalDist()
    limit, rate = result.sigma_star_m_s, result.rate
    colour, marker, _ = controller_looks([result.controller])[result.controller]
    with styled():
        figure = Figure(figsize=(5.2, 3.8), layout="constrained")
        axes = figure.subplots()
        axes.set_yscale("log")
        low, high = (100 * end for end in result.interval)
        axes.axvspan(low, high, color=colour, alpha=0.25, lw=0)
        axes.axhline(100 * rate, color=INK, lw=0.7, ls=":")
        for point in result.points:
            _draw_point(axes, point, colour, marker)
        noise = limit * np.geomspace(1 / _FURTHEST, _FURTHEST, 200)
        probit = normal.inv_cdf(rate) + result.slope * np.log(noise / limit)
        curve = np.array([100 * normal.cdf(value) for value in probit])
        used = [point.noise_m_s for point in result.points if point.counts]
        inside = (noise >= min(used)) & (noise <= max(used))
        axes.plot(100 * noise, curve, color=colour, lw=0.8, ls=(0, (4, 2)))
        axes.plot(100 * noise[inside], curve[inside], color=colour, lw=1.6)
        axes.set(
            xlabel=axis_label("robot noise", "cm/s"),
            ylabel=axis_label("dropped", "%"),
            xlim=(100 * limit / _FURTHEST, 100 * limit * _FURTHEST),
            ylim=(100 * rate * _LOWEST, 100),
            title=f"{controller_title(result.controller)}: {100 * rate:g} % of carries drop at "
            f"σ* = {100 * limit:.3g} cm/s",
        )
        axes.xaxis.set_major_locator(few_ticks())
        plain_numbers(axes.yaxis, minor=False)
        footnote(
            figure,
            f"band: 95 % interval of σ*, {low:.3f} to {high:.3f} cm/s, from {result.carries:,} "
            "carries\ngrey: pilot run (arrows: none dropped); dashed: the fit, extrapolated",
        )
        return figure


def _draw_point(axes: Axes, point: "NoisePoint", colour: str, marker: str) -> None:
    x, rate = 100 * point.noise_m_s, 100 * point.drop_rate
    low, high = (100 * end for end in point.interval)
    look: Any = {
        "color": colour if point.counts else QUIET,
        "elinewidth": 0.8,
        "capsize": 2,
    }
    face = colour if point.counts else BACKGROUND
    if point.drops == 0:
        axes.errorbar(x, high, yerr=[[0.4 * high], [0]], uplims=True, **look)
        return
    spread = [[rate - low], [high - rate]]
    axes.errorbar(x, rate, yerr=spread, marker=marker, ms=4.5, mfc=face, ls="", **look)

# SPDX-License-Identifier: Apache-2.0
"""A fitted motion over its data: speeds, the spread of the displacement, residuals."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palmbots.fitting.fit_panels import panels
from palmbots.fitting.motion_fit import MotionFit
from palmbots.viz import style

_WIDEST = 4.5  # of residuals [standard deviations]


def draw_motion_fit(result: MotionFit) -> Figure:
    """Draw the model over the data, and what the model leaves."""
    return panels(result, _draw_speeds, _draw_spread, _draw_residuals)


def _draw_speeds(axes: Axes, result: MotionFit) -> None:
    data = result.data
    values = {one.key: one.value or 0.0 for one in result.estimates if one.is_identified}
    axes.plot(
        100 * data.commands_m_s,
        100 * data.speeds_m_s,
        color=style.SERIES[0].colour,
        linestyle="none",
        marker="o",
        markersize=3,
        alpha=0.4,
        markeredgewidth=0,
        label="stretch",
    )
    ends = np.array([data.commands_m_s.min(), data.commands_m_s.max()])
    ends = ends + np.array([-0.05, 0.05]) * ends.mean()
    fitted = values["robot.gain"] * ends + values.get("robot.bias_m_s", 0.0)
    look = style.SERIES[1]
    axes.plot(100 * ends, 100 * fitted, color=look.colour, linestyle=look.line, label="fit")
    axes.plot(100 * ends, 100 * ends, color=style.QUIET, linestyle=":", label="as commanded")
    axes.set_xlabel(style.axis_label("commanded speed", "cm/s"))
    axes.set_ylabel(style.axis_label("mean speed", "cm/s"))
    axes.set_title(f"{result.stretches} stretches")
    axes.legend()


def _draw_spread(axes: Axes, result: MotionFit) -> None:
    data = result.data
    axes.fill_between(
        data.times_s,
        1e3 * data.low_m,
        1e3 * data.high_m,
        color=style.RULE,
        linewidth=0,
        label="data, 95 %",
    )
    axes.plot(data.times_s, 1e3 * data.spread_m, color=style.INK, label="data")
    looks = (style.SERIES[0], style.SERIES[1])
    labels = "without a white part", "fit"
    for values, look, label in zip(
        (data.without_white_m, data.model_m), looks, labels, strict=True
    ):
        axes.plot(data.times_s, 1e3 * values, color=look.colour, linestyle=look.line, label=label)
    axes.set_ylim(bottom=0)
    axes.set_xlabel(style.axis_label("time", "s"))
    axes.set_ylabel(style.axis_label("displacement error, SD", "mm"))
    axes.set_title(f"misfit {100 * result.misfit:.0f} %")
    axes.legend()


def _draw_residuals(axes: Axes, result: MotionFit) -> None:
    residuals = np.clip(result.data.residuals, -_WIDEST, _WIDEST)
    bins = np.linspace(-_WIDEST, _WIDEST, 37)
    axes.hist(
        residuals,
        bins=bins.tolist(),
        density=True,
        color=style.PALE["left"],
        edgecolor=style.SERIES[0].colour,
        linewidth=0.5,
        label="positions",
    )
    x = np.linspace(-_WIDEST, _WIDEST, 200)
    normal = np.exp(-(x**2) / 2) / np.sqrt(2 * np.pi)
    look = style.SERIES[1]
    axes.plot(x, normal, color=look.colour, linestyle=look.line, label="normal")
    axes.set_xlabel("residual / its standard deviation")
    axes.set_ylabel("density of the residuals")
    axes.set_title(f"{len(result.data.residuals):,} residuals")
    axes.legend()

# SPDX-License-Identifier: Apache-2.0
"""Draws a bound: the least drop rate over the mean duration of the carry."""

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from palmbots.viz.style import INK, SERIES, axis_label, footnote, plain_numbers, styled

if TYPE_CHECKING:
    from palmbots.optimum.drop_bound import Bound


def draw(result: "Bound") -> Figure:
    """Draw the least drop rate over the duration, at the noise σ*.

    With corrections only there is one duration, and so one point.
    """
    points = [(point.time_s, point.drop_rate) for point in result.front]
    points = points or [(result.time_s, result.rate)]
    times, rates = zip(*points, strict=True)
    with styled():
        figure = Figure(figsize=(5.2, 3.4), layout="constrained")
        axes = figure.subplots()
        axes.plot(times, [100 * rate for rate in rates], color=SERIES[0].colour, marker="o", ms=4)
        axes.axhline(100 * result.rate, color=INK, lw=0.7, ls=":")
        axes.set_yscale("log")
        axes.set(
            xlabel=axis_label("mean duration of a carry", "s"),
            ylabel=axis_label("least drop rate", "%"),
            title=f"Least drop rate at {100 * result.sigma_star_m_s:.3g} cm/s ({result.speeds})",
        )
        plain_numbers(axes.yaxis)
        footnote(
            figure, "robots that keep driving cannot drop less often in carries of this duration"
        )
        return figure

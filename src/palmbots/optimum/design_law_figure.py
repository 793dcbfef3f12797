# SPDX-License-Identifier: Apache-2.0
"""Draws the design law beside the optimum: σ* over each quantity, and the error of the law."""

from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from palmbots.viz.style import INK, SERIES, axis_label, footnote, plain_numbers, styled

if TYPE_CHECKING:
    from palmbots.optimum.design_law import DesignLaw


def draw(result: "DesignLaw") -> Figure:
    """Draw σ* of the optimum (marks) and the law (lines), and below the error of the law."""
    from palmbots.optimum.design_law import KEYS

    keys = list(dict.fromkeys(point.key for point in result.points))
    with styled():
        figure = Figure(figsize=(5.2, 5.0), layout="constrained")
        above, below = figure.subplots(2, sharex=True, height_ratios=(2, 1))
        for index, key in enumerate(keys):
            colour, marker, _ = SERIES[index % len(SERIES)]
            mine = [point for point in result.points if point.key == key]
            factors = [point.factor for point in mine]
            label = KEYS.get(key, key)
            optimum = [100 * point.sigma_star_m_s for point in mine]
            above.plot(factors, optimum, color=colour, marker=marker, ms=4, ls="", label=label)
            law = [100 * point.law_m_s for point in mine]
            above.plot(factors, law, color=colour, lw=1.0, ls=(0, (4, 2)))
            errors = [100 * point.error for point in mine]
            below.plot(factors, errors, color=colour, marker=marker, ms=4, lw=1.0)
        above.set_xscale("log")
        above.set_yscale("log")
        above.set(
            ylabel=axis_label("σ*", "cm/s"),
            title="Noise that the best controller tolerates, and the law √(uL/11τ)",
        )
        above.legend(fontsize=7, frameon=False)
        below.axhline(0, color=INK, lw=0.7, ls=":")
        below.set(
            xlabel="multiple of the scene's value",
            ylabel=axis_label("error of\nthe law", "%"),
        )
        ticks = sorted({point.factor for point in result.points})
        for axes in (above, below):
            axes.set_xticks(ticks)
            axes.xaxis.set_minor_locator(NullLocator())
            plain_numbers(axes.xaxis)
        plain_numbers(above.yaxis)
        footnote(figure, "marks: optimum with corrections only (value iteration); dashed: the law")
        return figure

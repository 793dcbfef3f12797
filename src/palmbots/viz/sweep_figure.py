# SPDX-License-Identifier: Apache-2.0
"""Draws a comparison: drops, stalls, contact rms and messages over the swept key."""

import os
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from palmbots._util.text import plural
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import axis_label, controller_looks, from_zero, key_label, styled

if TYPE_CHECKING:
    from palmbots.simulation.sweep import Comparison

# Label, field of a row, field of its interval, factor.
_PANELS = (
    (axis_label("dropped", "%"), "drop_rate", "interval", 100),
    (axis_label("stalled", "%"), "stall_rate", "stall_interval", 100),
    (axis_label("contact rms", "mm"), "rms_m", "rms_interval_m", 1e3),
    ("messages per metre", "messages_per_m", "messages_interval_per_m", 1),
)


def few_ticks() -> MaxNLocator:
    """At most six round numbers on an axis, so that the labels do not overlap."""
    return MaxNLocator(6, steps=[1, 2, 2.5, 5, 10])


def draw_sweep(comparison: "Comparison") -> Figure:
    """Draw four panels over the swept key, with 95 % intervals."""
    with styled():
        figure = Figure(figsize=(7.2, 5.6), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True).ravel()
        looks = controller_looks(row.controller for row in comparison.rows)
        for axes, (label, field, interval, factor) in zip(panels, _PANELS, strict=True):
            for controller, (colour, marker, line) in looks.items():
                mine = (row for row in comparison.rows if row.controller == controller)
                rows = sorted(mine, key=lambda row: row.value)
                y = factor * np.array([getattr(row, field) for row in rows])
                ends = factor * np.array([getattr(row, interval) for row in rows]).T
                axes.errorbar(
                    [row.value for row in rows],
                    y,
                    yerr=np.nan_to_num(np.abs(ends - y)),  # NaN: a single carry has no interval
                    capsize=2,
                    elinewidth=0.8,
                    label=controller,
                    color=colour,
                    marker=marker,
                    linestyle=line,
                    markersize=4.5,
                )
            axes.set_ylabel(label)
            if factor == 100:
                axes.set_ylim(-3, 103)
        from_zero(panels[2].yaxis, 1.05 * panels[2].get_ylim()[1])
        panels[3].set_yscale("symlog", linthresh=10)
        most = max(row.messages_per_m for row in comparison.rows)
        panels[3].set_ylim(-1, 2 * most + 10)
        for axes in panels[2:]:
            axes.set_xlabel(key_label(comparison.key))
            axes.xaxis.set_major_locator(few_ticks())
        carries = plural(comparison.rows[0].n, "carry")
        figure.legend(
            *panels[0].get_legend_handles_labels(),
            loc="outside upper center",
            ncols=4,
            title=f"{carries} per point, same seeds for every controller; bars: 95 % intervals",
        )
        return figure


def save(comparison: "Comparison", path: str | os.PathLike[str]) -> None:
    """Write the figure to `path` as PNG, SVG or PDF, by its suffix.

    Raises:
        PalmbotsError: the suffix is not allowed, or the path cannot be written.
    """
    write_figure(path, draw_sweep(comparison))

"""The picture of a comparison: drops, stalls, contact rms and messages over the swept key."""

import os
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from palmbots.pictures import save_figure
from palmbots.report import counted
from palmbots.style import styled
from palmbots.units import axis_label

if TYPE_CHECKING:
    from palmbots.compare import Comparison

__all__ = ["LOOK", "draw", "few_ticks", "save"]

# Okabe and Ito's palette; markers and lines differ too.
LOOK = {
    "none": ("#8A8A8A", "^", ":"),
    "centralized": ("#D55E00", "s", "--"),
    "distributed": ("#0072B2", "o", "-"),
    "resilient": ("#009E73", "v", (0, (5, 1, 1, 1))),
}


# Label, field of a row, field of its interval, factor.
_PANELS = (
    ("dropped [%]", "drop_rate", "interval", 100),
    ("stalled [%]", "stall_rate", "stall_interval", 100),
    ("contact rms [mm]", "rms_m", "rms_interval_m", 1e3),
    ("messages per metre", "messages_per_m", "messages_interval_per_m", 1),
)


def few_ticks() -> MaxNLocator:
    """So few round numbers on an axis that they do not run into each other."""
    return MaxNLocator(6, steps=[1, 2, 2.5, 5, 10])


def draw(comparison: "Comparison") -> Figure:
    """Four panels over the swept key: drops, stalls, contact rms and messages, with intervals."""
    with styled():
        figure = Figure(figsize=(7.2, 5.6), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True).ravel()
        for axes, (label, field, interval, factor) in zip(panels, _PANELS, strict=True):
            for controller in dict.fromkeys(row.controller for row in comparison.rows):
                mine = (row for row in comparison.rows if row.controller == controller)
                rows = sorted(mine, key=lambda row: row.value)
                colour, marker, line = LOOK.get(controller, ("#CC79A7", "D", "-."))
                y = factor * np.array([getattr(row, field) for row in rows])
                ends = factor * np.array([getattr(row, interval) for row in rows]).T
                axes.errorbar(
                    [row.value for row in rows],
                    y,
                    yerr=np.nan_to_num(np.abs(ends - y)),  # NaN: a single carry cannot tell
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
        panels[2].set_ylim(0, 1.05 * panels[2].get_ylim()[1])
        panels[3].set_yscale("symlog", linthresh=10)
        most = max(row.messages_per_m for row in comparison.rows)
        panels[3].set_ylim(-1, 2 * most + 10)
        for axes in panels[2:]:
            axes.set_xlabel(axis_label(comparison.key))
            axes.xaxis.set_major_locator(few_ticks())
        carries = counted(comparison.rows[0].n, "carry")
        figure.legend(
            *panels[0].get_legend_handles_labels(),
            loc="outside upper center",
            ncols=4,
            title=f"{carries} a point, the same seeds for every controller; bars: 95 % intervals",
        )
        return figure


def save(comparison: "Comparison", path: str | os.PathLike[str]) -> None:
    """Write the picture (PNG, SVG or PDF by suffix), whole or not at all.

    Raises:
        PalmbotsError: another suffix, or the path cannot be written.
    """
    save_figure(path, draw(comparison))

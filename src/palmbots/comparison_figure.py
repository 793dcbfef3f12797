"""The picture of a comparison: drop rate and contact rms over the swept key."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from palmbots.files import whole_file
from palmbots.report import counted
from palmbots.style import styled
from palmbots.units import axis_label

if TYPE_CHECKING:
    from palmbots.compare import Comparison

__all__ = ["LOOK", "draw", "save"]

# Okabe and Ito's palette; markers and lines differ too.
LOOK = {
    "none": ("#8A8A8A", "^", ":"),
    "centralized": ("#D55E00", "s", "--"),
    "distributed": ("#0072B2", "o", "-"),
    "resilient": ("#009E73", "v", (0, (5, 1, 1, 1))),
}


def draw(comparison: "Comparison") -> Figure:
    """Two panels over the swept key: drop rate with its 95 % interval, and contact rms."""
    with styled():
        figure = Figure(figsize=(7.2, 3.4), layout="constrained")
        drops, rms = figure.subplots(1, 2)
        for controller in dict.fromkeys(row.controller for row in comparison.rows):
            rows = [row for row in comparison.rows if row.controller == controller]
            colour, marker, line = LOOK.get(controller, ("#CC79A7", "D", "-."))
            x = [row.value for row in rows]
            rate = np.array([100 * row.drop_rate for row in rows])
            ends = np.array([row.interval for row in rows]).T * 100
            look = {"color": colour, "marker": marker, "linestyle": line, "markersize": 4.5}
            drops.errorbar(
                x,
                rate,
                yerr=np.clip(np.abs(ends - rate), 0, None),
                capsize=2,
                elinewidth=0.8,
                label=controller,
                **look,
            )
            rms.plot(x, [1e3 * row.rms_m for row in rows], label=controller, **look)
        carries = counted(comparison.rows[0].n, "carry")
        label = axis_label(comparison.key)
        drops.set(xlabel=label, ylabel="dropped, with 95 % interval [%]", ylim=(-3, 103))
        rms.set(xlabel=label, ylabel="contact rms [mm]")
        rms.set_ylim(bottom=0)
        figure.legend(
            *drops.get_legend_handles_labels(),
            loc="outside upper center",
            ncols=4,
            title=f"{carries} a point, the same seeds for every controller",
        )
        return figure


def save(comparison: "Comparison", path: str | os.PathLike[str]) -> None:
    """Write the picture (PNG, SVG or PDF by suffix), whole or not at all.

    Raises:
        PalmbotsError: the path cannot be written.
    """
    figure = draw(comparison)
    with styled(), whole_file(path) as stream:
        figure.savefig(stream, format=Path(path).suffix.lstrip(".").lower() or "png")

# SPDX-License-Identifier: Apache-2.0
"""Draws docs/images/probed-angles.png: drop rates with default angles and with chosen ones, from
benchmarks/bench_probes.py."""

from pathlib import Path

import numpy as np
from docs_generators.probes import KINDS, carried, mean_interval, rates
from matplotlib.figure import Figure

from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import SERIES, axis_label, footnote, styled

NOISES = ("0.01", "0.02", "0.03")
CHOICES = {
    ("nothing", "default"): "default angles",
    ("prior", "carries"): "chosen from the prior",
    ("probed", "carries"): "chosen after probing",
    ("known", "carries"): "chosen for the known object",
}


def draw(path: Path) -> None:
    """Write the picture."""
    write_figure(path, figure())


def figure() -> Figure:
    """A panel for each kind of palms, and a curve for each choice of the angles."""
    of = rates("quasistatic")
    with styled():
        drawn = Figure(figsize=(7.2, 3.4), layout="constrained")
        panels = drawn.subplots(1, len(KINDS), sharey=True)
        for axes, (kind, title) in zip(panels, KINDS.items(), strict=True):
            for shift, ((choice, label), look) in enumerate(
                zip(CHOICES.items(), SERIES, strict=True)
            ):
                found = [mean_interval(carried(of, *kind, *choice, noise)) for noise in NOISES]
                mean, low, high = 100 * np.array(found).T
                places = np.array([100 * float(noise) for noise in NOISES]) + 0.05 * (shift - 1.5)
                axes.errorbar(
                    places, mean, yerr=np.maximum(0, [mean - low, high - mean]), label=label,
                    marker=look.marker, color=look.colour, ls=look.line, ms=4, lw=1,
                )  # fmt: skip
            axes.set_title(title.replace(", ", ",\n"))
            axes.set_xlabel(axis_label("noise", "cm/s"))
            axes.set_xticks([1, 2, 3])
            axes.set_ylim(-3, 103)
        panels[0].set_ylabel(axis_label("dropped", "%"))
        drawn.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
        least = min(
            len(of[(*kind, *choice, noise)])
            for kind in KINDS for choice in CHOICES for noise in NOISES
        )  # fmt: skip
        footnote(drawn, f"friction of the palms; means of at least {least} objects, 95 % intervals")
    return drawn

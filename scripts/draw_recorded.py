# SPDX-License-Identifier: Apache-2.0
"""Draws docs/images/recorded.png: drop rates with recorded robots and radios, from
benchmarks/bench_recorded.py."""

import csv
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from palmbots._util.confidence_intervals import wilson_bounds
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import axis_label, controller_looks, footnote, styled

RESULT = Path(__file__).parent.parent / "benchmarks" / "results" / "recorded.csv"
TITLES = {"default": "default robots", "recorded": "recorded robots"}


def draw(path: Path) -> None:
    """Write the picture."""
    write_figure(path, figure())


def figure() -> Figure:
    """One panel for each kind of robots; a line for each radio, the one that loses least on top."""
    with RESULT.open(newline="", encoding="utf-8") as stream:
        rows = [row for row in csv.DictReader(stream) if row["robots"] in TITLES and row["carries"]]
    radios = {row["radio"]: float(row["packets_lost"]) for row in rows}
    order = sorted(radios, key=lambda radio: (-radios[radio], radio != "default"))
    names = [name for name in dict.fromkeys(row["controller"] for row in rows) if name != "none"]
    looks = controller_looks(names)
    with styled():
        drawn = Figure(figsize=(7.2, 8.2), layout="constrained")
        panels = drawn.subplots(1, 2, sharey=True)
        for axes, robots in zip(panels, TITLES, strict=True):
            for shift, name in enumerate(names):
                own = [r for r in rows if r["robots"] == robots and r["controller"] == name]
                counts = [(int(row["dropped"]), int(row["carries"])) for row in own]
                rate = np.array([100 * k / n for k, n in counts])
                low, high = 100 * np.array([wilson_bounds(k, n) for k, n in counts]).T
                places = np.array([order.index(row["radio"]) for row in own])
                places = places + 0.15 * (shift - (len(names) - 1) / 2)
                look = looks[name]
                axes.errorbar(
                    rate, places, xerr=np.maximum(0, [rate - low, high - rate]), label=name,
                    fmt=look.marker, color=look.colour, ms=4, lw=0.8,
                )  # fmt: skip
            axes.set_title(TITLES[robots])
            axes.set_xlabel(axis_label("dropped", "%"))
            axes.set_xlim(-3, 103)
        labels = [f"{radio} ({100 * radios[radio]:.2g} % lost)" for radio in order]
        panels[0].set_yticks(range(len(order)), labels)
        drawn.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=5)
        least = min(int(row["carries"]) for row in rows)
        footnote(drawn, f"at least {least} carries per point; bars: 95 % intervals")
    return drawn

# SPDX-License-Identifier: Apache-2.0
"""Draws docs/images/noise.png: drop rates over the noise, from benchmarks/bench_noise.py."""

import csv
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palmbots._util.confidence_intervals import wilson_bounds
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import (
    INK,
    PAPER,
    RULE,
    Look,
    axis_label,
    controller_looks,
    footnote,
    plain_numbers,
    styled,
)

RESULT = Path(__file__).parent.parent / "benchmarks" / "results" / "noise.csv"
TITLES = {"corrections": "corrections only", "stopping": "robots may stop"}
BOUND = "bound"
LEAST_PERCENT = 0.01


def draw(path: Path) -> None:
    """Write the picture."""
    write_figure(path, figure())


def figure() -> Figure:
    """One panel for each set of admissible speeds; logarithmic rates with 95 % intervals."""
    with RESULT.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    names = [base_name(row["controller"]) for row in rows if row["controller"] != BOUND]
    looks = controller_looks(names)
    with styled():
        drawn = Figure(figsize=(7.2, 4.3), layout="constrained")
        panels = drawn.subplots(1, 2, sharey=True)
        for axes, speeds in zip(panels, TITLES, strict=True):
            panel(axes, [row for row in rows if row["speeds"] == speeds], looks)
            axes.set_title(TITLES[speeds])
            axes.set_xlabel(axis_label("speed noise of each robot", "cm/s"))
        panels[0].set_ylabel(axis_label("dropped", "%"))
        drawn.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=5)
        carries = int(next(row["carries"] for row in rows if row["controller"] != BOUND))
        footnote(
            drawn,
            f"{carries} carries per point, the same seeds; bars: 95 % intervals; where nothing "
            "dropped there is no point\ngrey area: robots that keep driving cannot drop so few; "
            "open marks: references that know more than robots can",
        )
    return drawn


def base_name(controller: str) -> str:
    """A reference looks the same with and without stopping."""
    return controller.removesuffix("-stopping")


def panel(axes: Axes, rows: list[dict[str, str]], looks: dict[str, Look]) -> None:
    """The curves of one set of speeds."""
    axes.set_yscale("log")
    axes.set_ylim(LEAST_PERCENT, 110)
    axes.set_xlim(0, 6.2)
    plain_numbers(axes.yaxis, minor=False)
    bound = np.array(
        sorted(
            (100 * float(row["noise_m_s"]), 100 * float(row["rate"]))
            for row in rows
            if row["controller"] == BOUND
        )
    ).T
    bound[1] = np.maximum(bound[1], LEAST_PERCENT / 10)
    axes.fill_between(bound[0], bound[1], LEAST_PERCENT / 10, color=RULE, lw=0)
    axes.plot(*bound, color=INK, lw=1.2, label="bound of robots that keep driving")
    for controller in dict.fromkeys(row["controller"] for row in rows):
        if controller == BOUND:
            continue
        points = sorted(
            (float(row["noise_m_s"]), int(row["dropped"]), int(row["carries"]))
            for row in rows
            if row["controller"] == controller and int(row["dropped"])
        )
        noise, dropped, carries = np.array(points).T
        ends = 100 * np.array(wilson_bounds(dropped, carries))
        rate = 100 * dropped / carries
        look = looks[base_name(controller)]
        is_reference = base_name(controller) in REFERENCES
        axes.errorbar(
            100 * noise,
            rate,
            yerr=np.abs(ends - rate),
            color=look.colour,
            marker=look.marker,
            linestyle=look.line,
            markersize=4.5,
            markerfacecolor=PAPER if is_reference else look.colour,
            elinewidth=0.8,
            lw=1.0,
            label=base_name(controller),
        )


REFERENCES = ("kalman", "exact-p", "optimal")

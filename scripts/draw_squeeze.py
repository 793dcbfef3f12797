# SPDX-License-Identifier: Apache-2.0
"""Draws docs/images/squeeze.png: the intervals of squeezes that each contact allows."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

import palmbots as pb
from palmbots.mechanics import ContactModes
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import HATCH, HUE, INK, PALE, QUIET, axis_label, footnote, styled

STATES = (
    ("left palm shallow (5°), right palm steep (15°)", 5.0, 15.0),
    ("both palms steep (15°)", 15.0, 15.0),
)
ROWS = {"left": 1.0, "right": 0.0}
SHOWN = (-0.18, 0.37)
HALF_BAR = 0.26
ENDS = (("down", -1, "right"), ("up", 1, "left"))  # of an interval: low and high


def draw(path: Path) -> None:
    """Write the picture."""
    write_figure(path, figure())


def figure() -> Figure:
    """One panel for each state: two bars, their overlap, and what closing and opening do."""
    with styled():
        drawn = Figure(figsize=(7.2, 4.6), layout="constrained")
        panels = drawn.subplots(2, 1, sharex=True)
        for axes, (title, left, right) in zip(panels, STATES, strict=True):
            panel(axes, pb.contact_modes(theta_left_deg=left, theta_right_deg=right))
            axes.set_title(title)
        panels[-1].set_xlim(*SHOWN)
        panels[-1].set_xlabel(axis_label("squeeze H", "units of the weight"))
        footnote(drawn, "the paper's box with both contacts at p = 0, friction 0.3, level floor")
    return drawn


def panel(axes: Axes, found: ContactModes) -> None:
    """The two intervals of one state."""
    low = max(ends[0] for ends in found.squeeze.values())
    high = min(ends[1] for ends in found.squeeze.values())
    axes.axvspan(low, high, color=PALE["zero"], lw=0)
    axes.text(
        (low + high) / 2, 1.62, "overlap: both contacts can stick", ha="center", va="center",
        color=INK,
    )  # fmt: skip
    for side, row in ROWS.items():
        ends = found.squeeze[side]
        axes.barh(
            row, ends[1] - ends[0], 2 * HALF_BAR, ends[0], facecolor=PALE[side],
            edgecolor=HUE[side], hatch=HATCH[side], lw=1.2,
        )  # fmt: skip
        for (slides, way, align), end, limit in zip(ENDS, ends, (low, high), strict=True):
            limits = end == limit
            axes.annotate(
                f"slides {slides}", (end, row), (5 * way, 0), textcoords="offset points",
                ha=align, va="center", color=INK if limits else QUIET,
                weight="bold" if limits else "normal",
            )  # fmt: skip
    middle = (low + high) / 2
    for name, end in (("opening", low), ("closing", high)):
        axes.annotate(
            "", (end, -0.66), (middle, -0.66), arrowprops={"arrowstyle": "-|>", "color": INK}
        )
        axes.text((middle + end) / 2, -0.58, name, ha="center", va="bottom", color=INK)
    axes.set_yticks(list(ROWS.values()), [f"{side} contact" for side in ROWS])
    axes.grid(axis="y", visible=False)
    axes.set_ylim(-0.95, 1.95)

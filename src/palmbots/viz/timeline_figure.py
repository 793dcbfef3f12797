# SPDX-License-Identifier: Apache-2.0
"""Draws the timeline of a carry alone: its corrections and messages over time."""

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from palmbots.viz.carry_figure import figure_title, time_window
from palmbots.viz.style import axis_label, styled
from palmbots.viz.timeline import add_timeline, message_key

if TYPE_CHECKING:
    from palmbots.simulation.result import Carry

_HEIGHT_IN = 2.4


def draw_timeline(carry: "Carry", window: tuple[float, float] | None = None) -> Figure:
    """Draw corrections and messages, or those between two times in seconds.

    Raises:
        PalmbotsError: the carry has no trace, or the window is empty.
    """
    shown = time_window(carry, window)
    start, end = shown.start, shown.end
    with styled():
        figure = Figure(figsize=(shown.width_in + 1.1, _HEIGHT_IN), layout="constrained")
        axes = figure.subplots()
        axes.set_xlim(start, end)
        add_timeline(axes, carry, start, end, shown.width_in)
        axes.set_xlabel(axis_label("time", "s"))
        axes.set_title(figure_title(carry), loc="left", weight="bold")
        handles = message_key(carry)
        if handles:
            figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure

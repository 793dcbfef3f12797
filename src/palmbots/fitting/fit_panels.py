# SPDX-License-Identifier: Apache-2.0
"""The figure of a fit: panels side by side, of which one without data says why."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palmbots.viz import style


def panels(result: Any, *draws: Callable[[Axes, Any], None]) -> Figure:
    """A figure with one panel for each of the functions, which draw the result."""
    with style.styled():
        figure = Figure(figsize=(9.6, 3.4), layout="constrained")
        for axes, draw in zip(figure.subplots(1, len(draws)), draws, strict=True):
            draw(axes, result)
    return figure


def say(axes: Axes, text: str) -> None:
    """Write a line in place of data."""
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", color=style.QUIET)
    axes.set_xticks([])
    axes.set_yticks([])

# SPDX-License-Identifier: Apache-2.0
"""Draws one moment of a carry from the side, as the animation shows it."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.viz.animation import stage_at

if TYPE_CHECKING:
    from palmbots.simulation.result import Carry

_DPI = 200


def draw_side_view(carry: "Carry", time_s: float | None = None) -> Figure:
    """Draw the carry at a time; by default in the middle of its first correction.

    Raises:
        PalmbotsError: the carry has no trace, or it does not last until this time.
    """
    if carry.trace is None:
        raise PalmbotsError("figure: this carry has no trace; run it with record=True")
    times = carry.trace["time"].to_numpy()
    if time_s is None:
        first = carry.corrections[0] if carry.corrections else None
        time_s = float(times[-1] / 2 if first is None else (first.start_s + first.end_s) / 2)
    if not times[0] <= time_s <= times[-1]:
        raise PalmbotsError(
            f"figure: time_s is {show(time_s)}; allowed: {times[0]:g} to {times[-1]:g}"
        )
    row = int(np.searchsorted(times, time_s + 1e-9, side="right") - 1)
    stage, (moment,) = stage_at(carry, np.array([row]))
    image = np.asarray(stage.frame(moment))
    height, width = image.shape[:2]
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.imshow(image, interpolation="none")
    axes.set_axis_off()
    return figure

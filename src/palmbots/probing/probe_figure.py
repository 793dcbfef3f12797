# SPDX-License-Identifier: Apache-2.0
"""Draws a probe: the set of objects, and how it shrank."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from palmbots.viz import style

if TYPE_CHECKING:
    from palmbots.probing.probe import Probe


def draw_probe(result: Probe) -> Figure:
    """Draw the set over COM and friction, and its size after each stroke."""
    boxes = result.found.boxes
    prior = result.found.prior
    with style.styled():
        figure = Figure(figsize=(9.6, 3.2), layout="constrained")
        left, right, size = figure.subplots(1, 3)
        for i, (axes, side) in enumerate(((left, "left"), (right, "right"))):
            # Many boxes differ only in the other palm's friction.
            areas = np.unique(boxes[:, [0, 1 + i]], axis=0)
            x, y = 1000 * areas[:, 0], np.tan(areas[:, 1])
            corners = np.stack([x[:, [0, 1, 1, 0]], y[:, [0, 0, 1, 1]]], axis=-1)
            # One collection: an artist for each box takes a minute.
            area = PolyCollection(list(corners), facecolors=style.HUE[side], linewidths=0)
            axes.add_collection(area, autolim=False)
            axes.set_xlim(*(1000 * end for end in prior.com_x))
            axes.set_ylim(*prior.friction[i])
            axes.set_xlabel(style.axis_label("COM from the left contact", "mm"))
            axes.set_ylabel("palm friction")
            axes.set_title(f"{side} palm")
        volumes = [1.0, *(one.volume for one in result.strokes)]
        times = [0.0, *(one.time_s for one in result.strokes)]
        size.step(times, [100 * v for v in volumes], where="post", color=style.INK)
        size.set_yscale("log")
        style.plain_numbers(size.yaxis)
        size.yaxis.set_minor_formatter("")
        size.set_xlabel(style.axis_label("time", "s"))
        size.set_ylabel(style.axis_label("set, of the prior", "%"))
        where = "the object lies in the coloured set"
        if not result.is_consistent:
            where = "the observations contradict each other, so the set may not contain the object"
        style.footnote(figure, f"the axes span the prior; {where}")
    return figure

# SPDX-License-Identifier: Apache-2.0
"""The outline of a file and the corners that replace it, on top of each other."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palmbots.shapes.imported_object import ImportedObject
from palmbots.shapes.rounded_outline import boundary
from palmbots.viz import style

_WIDTH, _ENLARGED = 5.0, 1.8  # inches


def draw_imported_object(result: ImportedObject) -> Figure:
    """Draw outline and corners; the centre of mass is marked, and both contacts are enlarged."""
    with style.styled():
        corners = np.array(result.vertices_m)
        size = np.ptp(corners, axis=0)
        tall = float(np.clip(_WIDTH * 0.85 * size[1] / size[0] + 1.1, 2.4, 7.0))
        figure = Figure(figsize=(_WIDTH, tall + _ENLARGED), layout="constrained")
        rows = figure.subplot_mosaic(
            [["whole", "whole"], [0, 1]], height_ratios=[tall - 0.6, _ENLARGED - 0.2]
        )
        for axes in rows.values():
            _draw(axes, result)
        rows["whole"].set_aspect("equal", adjustable="datalim")
        rows["whole"].set_title(f"{result.source}, {result.view}")
        rows["whole"].set_ylabel("height y [m]")
        half = max(0.25 * size.min(), 1.6 * max(result.radii_m[k] for k in result.contacts))
        for k, name in enumerate(("left contact", "right contact")):
            x, y = corners[result.contacts[k]]
            inward = (1 - 2 * k) * 0.5 * half
            rows[k].set_xlim(x + inward - half, x + inward + half)
            rows[k].set_ylim(y - 0.3 * half, y + half)
            rows[k].set_aspect("equal", adjustable="box")
            rows[k].set_title(name)
            rows[k].set_xlabel("along x [m]")
            rows[k].locator_params(nbins=4)
        marks = rows["whole"].get_legend_handles_labels()
        figure.legend(*marks, loc="outside lower center", ncols=2)
    return figure


def _draw(axes: Axes, result: ImportedObject) -> None:
    corners = np.array(result.vertices_m)
    edge = boundary(corners, np.array(result.radii_m))
    axes.fill(*edge.T, facecolor=style.OBJECT, alpha=0.45, linewidth=0)
    outline = np.vstack([result.outline_m, result.outline_m[:1]])
    axes.plot(*outline.T, color=style.INK, linewidth=0.8, label="outline of the file")
    look = style.SERIES[1]
    axes.plot(
        *np.vstack([edge, edge[:1]]).T,
        color=look.colour,
        linestyle=(0, (3, 2)),
        label="outline of the object",
    )
    axes.plot(
        *corners.T,
        color=look.colour,
        linestyle="none",
        marker="o",
        markersize=3.5,
        markerfacecolor=style.PAPER,
        label="corners",
    )
    axes.plot(
        *corners[list(result.contacts)].T,
        color=style.SERIES[0].colour,
        linestyle="none",
        marker="^",
        markersize=9,
        markerfacecolor="none",
        label="contacts",
    )
    axes.plot(
        *result.com_m, color=style.INK, linestyle="none", marker="P", markersize=8, label="COM"
    )

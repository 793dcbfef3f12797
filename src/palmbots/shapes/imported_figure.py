# SPDX-License-Identifier: Apache-2.0
"""The outline of a file and the corners that replace it, on top of each other."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from palmbots.shapes.imported_object import ImportedObject
from palmbots.viz import style

_WIDTH = 5.0  # inches


def draw_imported_object(result: ImportedObject) -> Figure:
    """Draw outline and corners; the contacts and the centre of mass are marked."""
    with style.styled():
        corners = np.array(result.vertices_m)
        width, height = np.ptp(corners, axis=0)
        tall = float(np.clip(_WIDTH * 0.85 * height / width + 1.1, 2.4, 7.0))
        figure = Figure(figsize=(_WIDTH, tall), layout="constrained")
        axes = figure.add_subplot()
        axes.fill(*corners.T, facecolor=style.OBJECT, alpha=0.45, linewidth=0)
        outline = np.vstack([result.outline_m, result.outline_m[:1]])
        axes.plot(*outline.T, color=style.INK, linewidth=0.8, label="outline of the file")
        closed = np.vstack([corners, corners[:1]])
        look = style.SERIES[1]
        axes.plot(
            *closed.T,
            color=look.colour,
            linestyle=(0, (3, 2)),
            marker="o",
            markersize=3.5,
            markerfacecolor=style.PAPER,
            label="corners of the object",
        )
        contacts = corners[list(result.contacts)]
        axes.plot(
            *contacts.T,
            color=style.SERIES[0].colour,
            linestyle="none",
            marker="^",
            markersize=7,
            label="contacts",
        )
        axes.plot(
            *result.com_m, color=style.INK, linestyle="none", marker="P", markersize=8, label="COM"
        )
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_xlabel("along x [m]")
        axes.set_ylabel("height y [m]")
        axes.set_title(f"{result.source}, {result.view}")
        figure.legend(loc="outside lower center", ncols=2)
    return figure

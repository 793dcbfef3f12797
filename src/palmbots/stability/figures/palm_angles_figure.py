# SPDX-License-Identifier: Apache-2.0
"""The trade-off of a design: tolerance over both palm angles.

All texts stand in the legend above the map, so that none covers another or a contour. The colour
bar carries the contour lines.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from palmbots._util.atomic_files import folder as writable_folder
from palmbots._util.atomic_files import write_whole
from palmbots._util.command import Option, writes
from palmbots.stability.angle_grid import LIFT, NOISE, QUANTITIES
from palmbots.stability.certificates.prover import write_certificate
from palmbots.stability.design_result import Design
from palmbots.stability.figures.delivery_figure import BEST_LOOK, delivery
from palmbots.stability.figures.lifting_figure import lifting_forces
from palmbots.stability.palm_angles import PAPER_DEG
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import (
    BACKGROUND,
    COLOUR_MAP,
    EXCLUDED,
    ON_MAP,
    PAPER_PAIR,
    QUIET,
    axis_label,
    styled,
)

_BARRED: Any = {
    "facecolor": EXCLUDED,
    "edgecolor": QUIET,
    "hatch": "////",
    "linewidth": 0.0,
}
_PAPER_LOOK: Any = {
    "marker": "o",
    "ms": 6,
    "mfc": PAPER_PAIR,
    "mec": BACKGROUND,
    "mew": 0.9,
}
_LEVELS = 5
_MARGIN_DEG = 2.0


def palm_angles(result: Design) -> Figure:
    """Tolerance over shallow and steep angle; pairs that do not qualify are hatched.

    A design for delivery is drawn with about σ* of its candidates instead (`delivery`), and a plate
    with the forces at the floor (`lifting_forces`).
    """
    if result.maximize == NOISE:
        return delivery(result)
    if result.plate is not None:
        return lifting_forces(result.plate.analysis)
    assert result.quantity != LIFT
    *_, scale, name = QUANTITIES[result.quantity]
    grid = result.map
    shallow, steep = grid["shallow"].to_numpy(), grid["steep"].to_numpy()
    tolerance = scale * np.where(grid["tolerance"] > 0, grid["tolerance"], np.nan)
    allowed = grid["allowed"].to_numpy()
    shown = np.where(allowed, tolerance, np.nan)
    with styled(), rc_context({"hatch.color": QUIET, "hatch.linewidth": 0.5}):
        figure = Figure(figsize=(5.2, 5.0), layout="constrained")
        axes = figure.subplots()
        axes.grid(visible=False)
        shades = axes.pcolormesh(
            steep, shallow, shown, cmap=COLOUR_MAP, vmin=0, shading="nearest", rasterized=True
        )
        bar = figure.colorbar(shades, ax=axes, pad=0.02)
        bar.set_label(axis_label(f"tolerance of {name}, ±", result.shown_unit))
        barred = np.isfinite(tolerance) & ~allowed
        if barred.any():
            axes.contourf(
                steep,
                shallow,
                barred.astype(float),
                levels=[0.5, 1.5],
                colors=_BARRED["facecolor"],
                hatches=[_BARRED["hatch"]],
            )
        top = float(np.nanmax(shown))
        levels = [level for level in MaxNLocator(_LEVELS).tick_values(0, top) if 0 < level < top]
        colours = [ON_MAP["dark" if level < 0.6 * top else "light"] for level in levels]
        lines = axes.contour(steep, shallow, shown, levels, colors=colours, linewidths=0.6)
        bar.add_lines(lines)
        bar.set_ticks([0, *levels])
        axes.plot(result.steep_deg, result.shallow_deg, ls="", zorder=5, **BEST_LOOK)
        axes.plot(PAPER_DEG[1], PAPER_DEG[0], ls="", zorder=5, **_PAPER_LOOK)
        rows, columns = allowed.any(axis=1), allowed.any(axis=0)
        axes.set(
            xlabel=axis_label("steep palm angle", "°"),
            ylabel=axis_label("shallow palm angle", "°"),
            xlim=(
                min(steep[columns][0], PAPER_DEG[1]) - _MARGIN_DEG,
                steep[columns][-1] + _MARGIN_DEG,
            ),
            ylim=(
                min(shallow[rows][0], PAPER_DEG[0]) - _MARGIN_DEG,
                shallow[rows][-1] + _MARGIN_DEG,
            ),
        )
        _draw_legend(figure, result)
        return figure


def _draw_legend(figure: Figure, result: Design) -> None:
    """What the two marks and the hatched and blank areas mean."""
    grid = result.map
    clearance = grid.attrs["min_clearance_deg"]
    difference = grid.attrs["min_angle_difference_deg"]
    best = (
        f"best pair, {result.shallow_deg:g}° and {result.steep_deg:g}°: "
        f"{result.tolerance_text(result.tolerance)}, clearance {result.clearance_deg:.2f}°"
    )
    paper = "the pair fails"
    if result.paper_tolerance is not None:
        paper = result.tolerance_text(result.paper_tolerance)
    handles = [
        Line2D([], [], ls="", label=best, **BEST_LOOK),
        Line2D([], [], ls="", label=f"paper, 5° and 15°: {paper}", **_PAPER_LOOK),
        Patch(
            **_BARRED,
            label=f"clearance below {clearance:g}° or angles less than {difference:g}° apart",
        ),
        Patch(facecolor=BACKGROUND, edgecolor=QUIET, linewidth=0.6, label="a property fails"),
    ]
    figure.legend(handles=handles, loc="outside upper left", ncols=1, fontsize=8)


@writes(
    "design",
    folder=Option("--out", metavar="DIR"),
    kind=Option("--format", metavar="NAME"),
)
def write_design(
    result: Design,
    folder: str | os.PathLike[str],
    kind: Literal["png", "svg", "pdf"] = "png",
    *,
    on_warning: Callable[[str], None] | None = None,
) -> list[Path]:
    """Write a design: its figure, the scene with what was designed, and the certificate, if there
    is one.

    Args:
        result: the design.
        folder: write design.png, design.json (certificate) and scene.toml there.
        kind: figure format: png, svg or pdf.
        on_warning: called with a line about an older certificate, if nothing is proved.
    """
    place = writable_folder(folder)
    figure, scene = place / f"design.{kind}", place / "scene.toml"
    write_figure(figure, palm_angles(result))
    write_whole(scene, result.designed_scene.to_toml())
    proof = place / "design.json"
    if result.certificate is None:
        return [figure, scene]
    return [figure, scene, *write_certificate(result.certificate, proof, on_warning=on_warning)]

"""The trade-off of a design as a map over both angles."""

import os
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from palmbots.pictures import save_figure
from palmbots.style import INK, QUIET, styled

if TYPE_CHECKING:
    from palmbots.stability.design import Design

__all__ = ["draw", "save"]

_PAPER = "#D55E00"


def draw(found: "Design") -> Figure:
    """Tolerance over shallow and steep angle; what is not allowed is hatched."""
    from palmbots.stability.design import PAPER_DEG, QUANTITIES

    *_, scale, name = QUANTITIES[found.quantity]
    data = found.map
    shallow, steep = data["shallow"].to_numpy(), data["steep"].to_numpy()
    tolerance = scale * np.where(data["tolerance"] > 0, data["tolerance"], np.nan)
    allowed = data["allowed"].to_numpy()
    with styled():
        figure = Figure(figsize=(5.2, 4.2), layout="constrained")
        axes = figure.subplots()
        axes.grid(visible=False)
        shades = axes.pcolormesh(
            steep,
            shallow,
            np.where(allowed, tolerance, np.nan),
            cmap="cividis",
            vmin=0,
            shading="nearest",
            rasterized=True,
        )
        bar = figure.colorbar(shades, ax=axes, pad=0.02)
        bar.set_label(f"tolerance of {name}")
        barred = np.isfinite(tolerance) & ~allowed
        if barred.any():
            axes.contourf(
                steep,
                shallow,
                barred.astype(float),
                levels=[0.5, 1.5],
                colors="#F0F0F0",
                hatches=["/////"],
            )
        lines = axes.contour(
            steep, shallow, np.where(allowed, tolerance, np.nan), 5, colors="white", linewidths=0.6
        )
        axes.clabel(lines, fontsize=6.5, fmt="%.3g")
        best = (found.steep_deg, found.shallow_deg)
        axes.plot(*best, "*", ms=13, mfc="white", mec=INK, mew=0.9, zorder=5)
        value = scale * found.tolerance
        axes.annotate(
            f"{found.shallow_deg:g}° / {found.steep_deg:g}°: ±{value:.3g}",
            best,
            xytext=(0, 12),
            textcoords="offset points",
            ha="center",
            fontweight="bold",
            bbox=_box(),
            zorder=6,
        )
        paper = (PAPER_DEG[1], PAPER_DEG[0])
        worth = (
            f"±{scale * found.paper_tolerance:.3g}"
            if found.paper_tolerance is not None
            else "fails"
        )
        axes.plot(*paper, "o", ms=6, mfc=_PAPER, mec="white", mew=0.9, zorder=5)
        axes.annotate(
            f"paper 5° / 15°: {worth}",
            paper,
            xytext=(0, -15),
            textcoords="offset points",
            ha="center",
            color=INK,
            bbox=_box(),
            zorder=6,
        )
        inside = allowed
        rows, columns = inside.any(axis=1), inside.any(axis=0)
        pad = 2.0
        axes.set(
            xlabel="steep palm angle [°]",
            ylabel="shallow palm angle [°]",
            xlim=(min(steep[columns][0], PAPER_DEG[1]) - pad, steep[columns][-1] + pad),
            ylim=(min(shallow[rows][0], PAPER_DEG[0]) - pad, shallow[rows][-1] + pad),
        )
        axes.set_title(
            "hatched: too little clearance or difference; blank: a property fails",
            color=QUIET,
            fontsize=7.5,
        )
        return figure


def _box() -> dict[str, object]:
    return {"boxstyle": "round,pad=0.25", "fc": "white", "ec": "none", "alpha": 0.85}


def save(found: "Design", path: str | os.PathLike[str]) -> None:
    """Write the picture; the ending says its kind: png, svg or pdf."""
    save_figure(path, draw(found))

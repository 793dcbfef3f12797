# SPDX-License-Identifier: Apache-2.0
"""Draws a validation: agreement, switch lines, tilts, paired carries."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palmbots._types import SIDES
from palmbots.mujoco.validation.validation import VERTICES, Tilt, Validation
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import DROP, HUE, INK, LINE, QUIET, SERIES, ZERO, axis_label, styled

_ENGINES = {
    "MuJoCo": (INK, "o"),
    "pymunk": (SERIES[0].colour, "s"),
    "Box2D": (SERIES[1].colour, "^"),
}
"""Colour and marker of each engine."""


def save(validation: Validation, path: str | os.PathLike[str]) -> None:
    """Write the figure to `path` as PNG, SVG or PDF, by its suffix."""
    write_figure(path, draw_validation(validation))


def draw_validation(validation: Validation) -> Figure:
    """Draw four panels: agreement over friction, switch lines, tilts, carries."""
    with styled():
        figure = Figure(figsize=(9.0, 6.4), layout="constrained")
        panels = figure.subplots(2, 2)
        _agreement(panels[0, 0], validation)
        _lines(panels[0, 1], validation)
        _tilts(panels[1, 0], validation.tilts)
        _carries(panels[1, 1], validation)
    return figure


def _agreement(panel: Axes, validation: Validation) -> None:
    """Fraction of decisive states in which the expected contact slides, by friction."""
    frictions = sorted({t.state.friction for t in validation.trials})
    engines = [one for one in validation.agreement if one.contacts == VERTICES]
    for k, own in enumerate(engines):
        rates = []
        for friction in frictions:
            some = [
                t.cause is None
                for t in validation.trials
                if (t.engine, t.state.friction) == (own.engine, friction)
                and t.contacts == VERTICES
                and t.decisive
            ]
            rates.append(100 * float(np.mean(some)) if some else np.nan)
        where = np.arange(len(frictions)) + 0.12 * (k - 0.5 * (len(engines) - 1))
        label = f"{own.engine}: {100 * own.decisive_rate:.1f} % of {own.decisive_n}"
        colour, marker = _ENGINES[own.engine]
        panel.plot(where, rates, marker, color=colour, ms=6, mfc="none", label=label)
    panel.axhline(99, color=DROP, lw=0.8, ls=":")
    panel.set_xticks(range(len(frictions)), [f"{f:g}" for f in frictions])
    panel.set_xlabel("friction μ")
    panel.set_ylabel(axis_label("expected contact slides", "%"))
    low, _ = panel.get_ylim()
    panel.set_ylim(min(low, 90), 101)
    panel.set_title("Two vertices: same contact slides, margin > 1°", loc="left")
    panel.legend(loc="lower right")


def _lines(panel: Axes, validation: Validation) -> None:
    """COM at which the other contact begins to slide."""
    for name, closing, look in (("closing", True, SERIES[0]), ("opening", False, SERIES[1])):
        rows = [one for one in validation.switch_lines if one.closing == closing]
        rights = [1e3 * one.right_m for one in rows]
        known: Any = [np.nan if one.known_m is None else 1e3 * one.known_m for one in rows]
        seen: Any = [np.nan if one.seen_m is None else 1e3 * one.seen_m for one in rows]
        panel.plot(known, rights, color=look.colour, ls=look.line, label=f"{name}, quasistatic")
        panel.plot(seen, rights, "o", color=look.colour, mfc="none", label=f"{name}, MuJoCo")
    panel.set_xlabel(axis_label("COM off the middle", "mm"))
    panel.set_ylabel(axis_label("right contact p, left at 0", "mm"))
    panel.set_title("Switch lines, both palms at 15°, μ = 0.3", loc="left")
    panel.legend(loc="upper left")
    panel.margins(x=0.35)


def _tilts(panel: Axes, tilts: tuple[Tilt, ...]) -> None:
    """Motion of both contacts while the left palm turns up."""
    places = [1e3 * t.left_m for t in tilts]
    for k, side in enumerate(SIDES):
        known = [1e3 * t.known_m[k] for t in tilts]
        seen = [1e3 * t.seen_m[k] for t in tilts]
        panel.plot(places, known, color=HUE[side], ls=LINE[side], label=f"{side}, quasistatic")
        panel.plot(places, seen, "o", color=HUE[side], mfc="none", label=f"{side}, MuJoCo")
    panel.axhline(0, color=QUIET, lw=0.5)
    panel.set_xlabel(axis_label("left contact before, right at 0", "mm"))
    panel.set_ylabel(axis_label("contact slides outward", "mm"))
    panel.set_title("Tilting the left palm up, robots at rest", loc="left")
    panel.legend(loc="lower left")


def _carries(panel: Axes, validation: Validation) -> None:
    """Contact rms of the same seed in both worlds."""
    alike = [p for p in validation.carries if p.outcome[0] == p.outcome[1]]
    unlike = [p for p in validation.carries if p.outcome[0] != p.outcome[1]]
    for rows, mark, colour, label in (
        (alike, "o", ZERO, "same outcome"),
        (unlike, "x", DROP, "another outcome"),
    ):
        if rows:
            x, y = ([1e3 * p.rms_m[k] for p in rows] for k in (0, 1))
            panel.plot(x, y, mark, color=colour, label=f"{label}: {len(rows)}")
    most = 1.15e3 * max(max(p.rms_m) for p in validation.carries)
    panel.plot([0, most], [0, most], color=QUIET, lw=0.8, ls="--", label="equal")
    panel.set_xlim(0, most)
    panel.set_ylim(0, most)
    panel.set_aspect("equal")
    panel.set_xlabel(axis_label("contact rms, quasistatic", "mm"))
    panel.set_ylabel(axis_label("contact rms, MuJoCo", "mm"))
    panel.set_title(f"Carries paired by seed, {validation.controller}", loc="left")
    panel.legend(loc="lower right")

# SPDX-License-Identifier: Apache-2.0
"""Draws the speed limits: accelerations over friction, and carries over speed."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palmbots._types import SIDES
from palmbots.mujoco.validation.speed_limits import MOST, SpeedLimits
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import DROP, SERIES, axis_label, styled

_KINDS = (
    (True, True, "closing, accelerating", SERIES[0]),
    (False, True, "opening, accelerating", SERIES[2]),
    (True, False, "closing, braking", SERIES[1]),
    (False, False, "opening, braking", SERIES[3]),
)


def save(result: SpeedLimits, path: str | os.PathLike[str]) -> None:
    """Write the figure to `path` as PNG, SVG or PDF, by its suffix."""
    write_figure(path, draw_speed_limits(result))


def draw_speed_limits(result: SpeedLimits) -> Figure:
    """Draw two panels: the limit of the acceleration, and carries over speed."""
    with styled():
        figure = Figure(figsize=(9.0, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        _limits(left, result)
        _paces(right, result)
    return figure


def _limits(panel: Axes, result: SpeedLimits) -> None:
    """Lines: closed form; markers: MuJoCo."""
    for closing, forward, name, (colour, mark, line) in _KINDS:
        rows = [r for r in result.limits if (r.closing, r.forward) == (closing, forward)]
        friction = [r.friction for r in rows]
        known: Any = [np.nan if r.known is None else r.known for r in rows]
        seen: Any = [np.nan if r.seen is None else r.seen for r in rows]
        panel.plot(friction, known, color=colour, ls=line)
        panel.plot(friction, seen, mark, color=colour, mfc="none", ms=5)
        panel.plot([], [], color=colour, ls=line, marker=mark, mfc="none", label=name)
    most = result.max_acceleration_m_s2
    if most is not None:
        panel.axhline(most, color=DROP, lw=0.9, ls=":")
        note = f"dotted: both properties everywhere on the palms, {most:.2f} m/s²"
        panel.text(0.99, 0.03, note, color=DROP, ha="right", transform=panel.transAxes)
    panel.set_ylim(0, MOST * 1.02)
    panel.set_xlabel("friction μ")
    panel.set_ylabel(axis_label("acceleration", "m/s²"))
    panel.set_title("The same contact slides up to here (lines: closed form)", loc="left")
    panel.legend(loc="upper left")


def _paces(panel: Axes, result: SpeedLimits) -> None:
    """Contact rms and peak of carries over speed."""
    speeds = [p.speed_m_s for p in result.paces]
    for k, world in enumerate(("quasistatic", "MuJoCo")):
        colour, _, line = SERIES[k]
        rms = [1e3 * p.rms_m[k] for p in result.paces]
        peak = [1e3 * p.peak_m[k] for p in result.paces]
        panel.plot(speeds, rms, "o", color=colour, ls=line, label=f"{world}, rms")
        panel.plot(speeds, peak, "^", color=colour, ls=line, alpha=0.5, mfc="none",
                   label=f"{world}, peak")  # fmt: skip
    half = 1e3 * min(result.scene.palm_of(s).reach_m for s in SIDES)
    panel.axhline(half, color=DROP, lw=0.9, label="end of the palm")
    panel.set_xscale("log", base=2)
    ticks = [
        f"{p.speed_m_s:g}\n{p.delivered[0]}/{p.n} · {p.delivered[1]}/{p.n}" for p in result.paces
    ]
    panel.set_xticks(speeds, ticks)
    panel.minorticks_off()
    panel.set_ylim(0, 1.55 * half)
    panel.set_xlabel(axis_label("delivered, quasistatic · MuJoCo\nnominal speed", "m/s"))
    panel.set_ylabel(axis_label("contact", "mm"))
    panel.set_title("Carries, speed, correction and noise scaled alike", loc="left")
    panel.legend(loc="upper left", ncols=2)

# SPDX-License-Identifier: Apache-2.0
"""Draws Figure 8 of the paper for any carry: contacts, sensors, palms and speeds over time.

The top panel is the timeline: a bar for each correction with its label and case (left robot above,
right robot below, hatched where a robot only assists), and between the two rows each message from
the moment it is sent to the moment it arrives. The panels below show the effect. Each correction is
shaded there in the colour and hatch of its robot; in panels for both robots it is shaded in the
half of its robot (left above, right below). A job that begins or ends on the floor has two panels
more, with the phases of both robots and the heights of the pivots, and its contacts are drawn only
while the object touches that palm. Source: paper, section 5.2.
"""

import math
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.scene.spec import to_spec
from palmbots.simulation.floor_job import covered_m
from palmbots.viz import carry_panels
from palmbots.viz.carry_panels import PanelView
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import HUE, LINE, ZERO, axis_label, controller_title, styled
from palmbots.viz.timeline import add_timeline, message_key

if TYPE_CHECKING:
    from palmbots.simulation.result import Carry

_HEIGHTS = {  # inches of each panel
    "timeline": 1.25,
    "stages": 0.45,
    "left": 1.1,
    "left sensor": 0.3,
    "right": 1.1,
    "right sensor": 0.3,
    "lateral": 0.9,
    "palms": 0.85,
    "heights": 0.7,
    "separation": 0.8,
    "speeds": 1.2,
}


@dataclass(frozen=True)
class TimeWindow:
    """The part of a carry that a figure shows, and how wide it is drawn."""

    start: float  # s
    end: float  # s
    rows: np.ndarray  # of the trace
    width_in: float  # inches of the time axis


def time_window(carry: "Carry", window: tuple[float, float] | None) -> TimeWindow:
    """The part between two times in seconds; None: all of it.

    Raises:
        PalmbotsError: the carry has no trace, or the window is empty.
    """
    if carry.trace is None:
        raise PalmbotsError("figure: this carry has no trace; run it with record=True")
    times = carry.trace["time"].to_numpy()
    last = float(times[-1])
    # The axis of a carry that ended in its first tick is one control period long.
    last = max(last, carry.scene.control.period_s)
    start, end = map(float, (0.0, last) if window is None else window)
    if not (math.isfinite(start) and math.isfinite(end) and start < end):
        raise PalmbotsError(f"figure: window is {window}; allowed: (from_s, to_s) with from < to")
    rows = np.flatnonzero((times >= start) & (times <= end))
    if rows.size == 0:
        raise PalmbotsError(f"figure: window {window} lies outside the carry, 0 to {last:g} s")
    shown = sum(1 for c in carry.corrections if c.end_s >= start and c.start_s <= end)
    width = min(max(6.3, 0.28 * (end - start), 0.27 * shown), 12.0)
    return TimeWindow(start, end, rows, width)


def draw_carry(carry: "Carry", window: tuple[float, float] | None = None) -> Figure:
    """Draw a carry, or the part of it between two times in seconds.

    Raises:
        PalmbotsError: the carry has no trace, or the window is empty.
    """
    shown = time_window(carry, window)
    assert carry.trace is not None
    view = PanelView(
        carry,
        to_spec(carry.scene, unrolled=True),
        carry.trace.isel(time=shown.rows),
        shown.start,
        shown.end,
        shown.width_in,
    )
    with styled():
        left, right, top, bottom, gap = 0.95, 0.2, 0.72, 0.45, 0.09
        heights = dict(_HEIGHTS)
        if not carry.scene.task.path.is_curved:
            del heights["lateral"]
        if carry.floor_job is None:
            del heights["stages"], heights["heights"]
        height = top + bottom + sum(heights.values()) + gap * (len(heights) - 1)
        figure = Figure(figsize=(left + view.width_in + right, height))
        panels: dict[str, Axes] = {}
        level = height - top
        for name, panel_height in heights.items():
            box = (
                left / figure.get_figwidth(),
                (level - panel_height) / height,
                view.width_in / figure.get_figwidth(),
                panel_height / height,
            )
            panels[name] = figure.add_axes(box, sharex=panels.get("timeline"))
            level -= panel_height + gap
        panels["timeline"].set_xlim(view.start, view.end)

        add_timeline(panels["timeline"], carry, view.start, view.end, view.width_in)
        reach = carry_panels.contact_reach(view)
        for side in SIDES:
            carry_panels.draw_contact(panels[side], view, side, reach)
            carry_panels.draw_sensor(panels[f"{side} sensor"], view, side)
        if "lateral" in panels:
            carry_panels.draw_lateral(panels["lateral"], view)
        carry_panels.draw_palms(panels["palms"], view)
        if carry.floor_job is not None:
            carry_panels.draw_stages(panels["stages"], view, carry.floor_job)
            carry_panels.draw_heights(panels["heights"], view)
        carry_panels.draw_separation(panels["separation"], view)
        carry_panels.draw_speeds(panels["speeds"], view)

        for name, panel in panels.items():
            carry_panels.shade(panel, view, name.split()[0])
            panel.tick_params(axis="y", length=2)
            panel.tick_params(
                axis="x", length=2 if name == "speeds" else 0, labelbottom=name == "speeds"
            )
            panel.yaxis.set_label_coords(-0.58 / view.width_in, 0.5)
            carry_panels.mark_end(panel, view)
        panels["speeds"].set_xlabel(axis_label("time", "s"))
        _draw_head(figure, view, left, height)
    return figure


def save(
    carry: "Carry", path: str | os.PathLike[str], window: tuple[float, float] | None = None
) -> None:
    """Write the figure to `path` as PNG, SVG or PDF, by its suffix.

    Raises:
        PalmbotsError: the suffix is not allowed, the path cannot be written, or as `draw`.
    """
    write_figure(path, draw_carry(carry, window))


def figure_title(carry: "Carry") -> str:
    """Controller, outcome, duration and distance in one line."""
    ending = carry.outcome if carry.reason is None else f"{carry.outcome} ({carry.reason})"
    title = controller_title(carry.controller)
    way_m = covered_m(carry.floor_job, carry.distance_m)
    return f"{title}: {ending} after {carry.time_s:.2f} s and {way_m:.2f} m"


def _draw_head(figure: Figure, view: PanelView, left_in: float, height_in: float) -> None:
    """Two lines of title, and the legend."""
    carry = view.carry
    rms, peak = carry.contact_rms_m, carry.contact_peak_m
    facts = [f"{carry.correction_count} corrections"]
    if math.isnan(rms["left"]):  # real robots sense only its sign
        facts.append("from the logs of the robots; the contact coordinate is not measured")
    elif view.spec.on_one_palm:
        facts.append(f"seed {carry.seed}")
    else:
        facts += [
            f"contact rms left {rms['left'] * 1e3:.1f}, right {rms['right'] * 1e3:.1f} mm",
            f"peak {peak['left'] * 1e3:.1f}, {peak['right'] * 1e3:.1f} mm",
            f"seed {carry.seed}",
        ]
    x = left_in / figure.get_figwidth()
    figure.text(x, 1 - 0.08 / height_in, figure_title(carry), va="top", weight="bold", size=9)
    figure.text(x, 1 - 0.25 / height_in, "  ·  ".join(facts), va="top", size=7.5)
    entries = [
        *(Line2D([], [], color=HUE[s], ls=LINE[s], label=f"{s} robot") for s in SIDES),
        Patch(fc=ZERO, alpha=0.25, label="zero zone"),
        *message_key(carry),
    ]
    crowded = len(entries) > 7  # the resilient algorithm has more kinds of messages
    figure.legend(
        handles=entries,
        loc="upper left",
        bbox_to_anchor=(x, 1 - 0.4 / height_in),
        ncols=len(entries),
        borderaxespad=0,
        handlelength=1.5 if crowded else 2.2,
        columnspacing=0.8 if crowded else 1.2,
        handletextpad=0.5,
    )

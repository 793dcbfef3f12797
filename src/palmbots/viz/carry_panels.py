# SPDX-License-Identifier: Apache-2.0
"""The panels of the figure of a carry below its timeline: what each shows of a `PanelView`."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from palmbots._types import SIDES, Side
from palmbots.simulation.floor_job import contacts_on_palms, stages
from palmbots.viz.style import DROP, HATCH, HUE, INK, LINE, QUIET, ZERO, axis_label

if TYPE_CHECKING:
    import xarray as xr

    from palmbots._core import Spec
    from palmbots.simulation.floor_job import FloorJob
    from palmbots.simulation.result import Carry

_NOTE: dict[str, Any] = {
    "xycoords": ("axes fraction", "data"), "textcoords": "offset points", "va": "top"
}  # fmt: skip


@dataclass(frozen=True)
class PanelView:
    """What the panels have in common."""

    carry: "Carry"
    spec: "Spec"
    trace: "xr.Dataset"
    start: float  # s
    end: float  # s
    width_in: float  # inches of the time axis

    def series(self, name: str, side: str | None = None) -> np.ndarray:
        """A variable of the trace, or one side of it."""
        data = self.trace[name] if side is None else self.trace[name].sel(side=side)
        return data.to_numpy()

    @property
    def time(self) -> np.ndarray:
        """The times of the rows [s]."""
        return self.trace["time"].to_numpy()


def contact_reach(view: PanelView) -> float:
    """Half the height of both contact panels in mm; equal, so that left and right compare."""
    edges = [
        abs(e) for sign, *zone in view.spec.zones if sign == 0 for e in zone if math.isfinite(e)
    ]
    longest = max(view.carry.scene.palm_of(side).reach_m for side in SIDES)
    seen = max(np.nan_to_num(np.abs(_contact(view, side))).max() for side in SIDES)
    reach = max(1.25 * seen, 1.2 * max(edges, default=0.0), 1e-3)
    return 1e3 * (reach if reach < 0.6 * longest else max(reach, 1.12 * longest))


def _contact(view: PanelView, side: Side) -> np.ndarray:
    """Contact coordinate [m]; NaN where a job on the floor has nothing on this palm."""
    if view.carry.floor_job is None:
        return view.series("contact", side)
    return contacts_on_palms(view.carry.scene, view.trace)[:, SIDES.index(side)]


def draw_stages(panel: Axes, view: PanelView, job: "FloorJob") -> None:
    """A bar for each stage of each robot, with its name where it has room."""
    per_letter = 0.06 * (view.end - view.start) / view.width_in
    for row, side in enumerate(reversed(SIDES)):
        for k, (stage, start, end) in enumerate(stages(job, side)):
            first, last = max(start, view.start), min(end, view.end)
            if first >= last:
                continue
            place = ([(first, last - first)], (row + 0.08, 0.84))
            panel.broken_barh(*place, facecolor=HUE[side], alpha=(0.18, 0.4)[k % 2], lw=0)
            if last - first > len(stage) * per_letter:
                panel.text((first + last) / 2, row + 0.5, stage, ha="center", va="center", size=7)
    panel.set_ylim(0, 2)
    panel.set_yticks([0.5, 1.5], [*reversed(SIDES)])
    panel.grid(False)
    panel.set_ylabel("phase", size=7)


def draw_heights(panel: Axes, view: PanelView) -> None:
    """Heights of both pivots above the floor in mm."""
    for side in SIDES:
        height = view.series("pivot_height", side) * 1e3
        panel.plot(view.time, height, color=HUE[side], ls=LINE[side])
    panel.axhline(0, color=INK, lw=0.9)
    panel.set_ylim(bottom=-0.05 * panel.get_ylim()[1])
    panel.set_ylabel(axis_label("pivot\nheight", "mm"))


def draw_contact(panel: Axes, view: PanelView, side: Side, reach: float) -> None:
    """Contact coordinate in mm, with the zero zones, and the ends of the palm if they are near."""
    palm = view.carry.scene.palm_of(side)
    half = 1e3 * palm.reach_m
    for sign, low, high in view.spec.zones:
        if sign == 0:
            panel.axhspan(low * 1e3, high * 1e3, color=ZERO, alpha=0.13, lw=0)
    panel.axhline(0, color=QUIET, lw=0.5)
    panel.plot(view.time, _contact(view, side) * 1e3, color=HUE[side], ls=LINE[side])
    if reach > half:
        for end in (-half, half):
            panel.axhline(end, color=DROP, lw=0.9)
        part = "palm" if palm.usable_m is None else "usable palm"
        note = f"ends of the {part}, ±{half:.0f} mm"
        panel.annotate(note, (0.004, half), (0, -2), size=6.5, color=DROP, **_NOTE)
    panel.set_ylim(-reach, reach)
    panel.set_ylabel(axis_label(f"{side}\ncontact", "mm"))


def draw_sensor(panel: Axes, view: PanelView, side: Side) -> None:
    """The sign of the sensor as a filled step, which is readable without colour."""
    sign = view.series("sign", side)
    panel.fill_between(view.time, sign, step="post", color=HUE[side], alpha=0.45, lw=0)
    panel.step(view.time, sign, where="post", color=HUE[side], lw=0.8)
    panel.set_ylim(-1.35, 1.35)
    panel.set_yticks([-1, 0, 1], ["−", "0", "+"])
    panel.grid(False)
    panel.set_ylabel("sensor", size=7)


def draw_lateral(panel: Axes, view: PanelView) -> None:
    """Lateral contact coordinate in mm; at the lines the object tips or meets a lip."""
    scene = view.carry.scene
    palm = min((scene.palm_of(side) for side in SIDES), key=lambda p: p.width_m)
    has_lips = palm.lip_height_m > 0
    edge = 1e3 * (palm.lip_clearance_m if has_lips else palm.width_m / 2)
    reach = 0.0
    for side in SIDES:
        across = view.series("lateral", side) * 1e3
        panel.plot(view.time, across, color=HUE[side], ls=LINE[side])
        reach = max(reach, np.abs(across).max())
    panel.axhline(0, color=QUIET, lw=0.5)
    seen, reach = reach, max(1.15 * reach, 1.0)
    if has_lips or reach > 0.3 * edge:
        reach = max(reach, 1.2 * edge)
        for end in (-edge, edge):
            panel.axhline(end, color=DROP, lw=0.9)
        what = "lips" if has_lips else "sides of the palm"
        note = f"{what}, ±{edge:.0f} mm"
        if has_lips and seen > edge:
            note += "; farther out, the object is askew and leans on a lip"
        panel.annotate(note, (0.004, edge), (0, -2), size=6.5, color=DROP, **_NOTE)
    if scene.task.path.is_curved:
        note = "on a curve an edge lies askew: the sensor reads where it presses, not its middle"
        panel.text(0.004, 0.04, note, transform=panel.transAxes, size=6.5, color=QUIET)
    panel.set_ylim(-reach, reach)
    panel.set_ylabel(axis_label("across\npalm", "mm"))


def draw_palms(panel: Axes, view: PanelView) -> None:
    """Both palm angles in degrees."""
    for side in SIDES:
        panel.plot(view.time, np.degrees(view.series("palm", side)), color=HUE[side], ls=LINE[side])
    angles = sorted(
        {round(math.degrees(a), 6) for p in view.spec.palms for a in (p.shallow, p.steep)}
    )
    room = 0.25 * (angles[-1] - angles[0])
    panel.set_ylim(angles[0] - room, angles[-1] + room)
    panel.set_yticks(angles)
    panel.set_ylabel(axis_label("palm\nangle", "°"))


def draw_separation(panel: Axes, view: PanelView) -> None:
    """Distance between the pivots in mm. Logs of real robots may have gaps."""
    d = view.series("separation") * 1e3
    panel.plot(view.time, d, color=INK, lw=1.0)
    low, high = np.nanmin(d), np.nanmax(d)
    room = max(0.08 * (high - low), 0.5)
    panel.set_ylim(low - room, high + room)
    panel.locator_params(axis="y", nbins=4)
    panel.set_ylabel(axis_label("separation\n", "mm"))


def draw_speeds(panel: Axes, view: PanelView) -> None:
    """Commanded speeds, and thin behind them the actual ones, in cm/s."""
    highest, lowest = -math.inf, math.inf
    for side in SIDES:
        actual = view.series("speed", side) * 100
        panel.step(view.time, actual, where="post", color=HUE[side], lw=0.5, alpha=0.45)
        highest, lowest = max(highest, actual.max()), min(lowest, actual.min())
    for side in SIDES:
        wanted = view.series("commanded", side) * 100
        panel.step(view.time, wanted, where="post", color=HUE[side], ls=LINE[side], lw=1.4)
        highest, lowest = max(highest, wanted.max()), min(lowest, wanted.min())
    room = max(0.06 * (highest - lowest), 0.1)
    panel.set_ylim(lowest - room, highest + room)
    panel.set_ylabel(axis_label("speed (thick:\ncommanded)", "cm/s"))


def shade(panel: Axes, view: PanelView, name: str) -> None:
    """Shade each correction: in the panels of its robot, and in its half of the common panels.

    As in the top panel, the left robot's half is the upper one.
    """
    if name in ("timeline", "stages"):
        return
    halves = {"left": (0.5, 1.0), "right": (0.0, 0.5), "both": (0.0, 1.0)}
    for robot in (name, "both") if name in SIDES else HUE:
        low, high = (0.0, 1.0) if name in SIDES else halves[robot]
        spans = [
            [(c.start_s, low), (c.start_s, high), (c.end_s, high), (c.end_s, low)]
            for c in view.carry.corrections
            if c.robot == robot and c.end_s >= view.start and c.start_s <= view.end
        ]
        if not spans:
            continue
        # One collection is drawn many times as fast as a patch for each correction.
        looks: list[dict[str, Any]] = [{"fc": HUE[robot], "alpha": 0.12}]
        if name not in SIDES:
            looks.append({"fc": "none", "ec": HUE[robot], "hatch": HATCH[robot], "alpha": 0.2})
        for look in looks:
            shade = PolyCollection(
                spans, transform=panel.get_xaxis_transform(), lw=0, zorder=0, **look
            )
            panel.add_collection(shade, autolim=False)


def mark_end(panel: Axes, view: PanelView) -> None:
    """A line where the carry failed, if the window contains that time."""
    if view.carry.outcome == "delivered" or not view.start <= view.carry.time_s <= view.end:
        return
    panel.axvline(view.carry.time_s, color=DROP, lw=1.6, clip_on=False, zorder=5)

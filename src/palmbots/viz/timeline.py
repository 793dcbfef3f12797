# SPDX-License-Identifier: Apache-2.0
"""The timeline, the top panel of Figure 8: corrections, assistance and messages over time.

The row of the left robot is above, that of the right robot below. Labels stand outside the rows, on
several levels so that they do not overlap; a label without room is left out. Repeated beacons of
the resilient algorithm are left out too: only beacons with a new content are drawn.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.control.registry import describe
from palmbots.simulation.floor_job import stages
from palmbots.viz.style import BACKGROUND, DROP, HATCH, HUE, INK, LEADER, QUIET, RULE

if TYPE_CHECKING:
    from palmbots.simulation.floor_job import FloorJob
    from palmbots.simulation.result import Carry, Message

_ROW = {"left": 1.0, "right": -1.0}
_BAR = 0.3  # half the height of a bar, in the panel's own unit
_LEVEL = 0.62  # height of one level of labels
_MOST_PER_INCH = 10  # bars; above that, labels and messages would not be legible
_MARKERS: dict[str, Any] = {
    "TiltUp": "^", "Ack": "o", "TiltDown": "v", "Closing": "s", "Raised": "D", "Hello": ".",
    "Plus": "^", "PlusShallow": 6, "Zero": "o", "Minus": "v", "MinusShallow": 7,
}  # fmt: skip
_OF_TABLE = frozenset(_core.lift_messages)
_OTHER = "P"  # marker of kinds that are not in the table


def assign_label_rows(
    centres: Sequence[float], widths: Sequence[float], levels: int
) -> list[int | None]:
    """The lowest level for each label on which it overlaps no earlier label; None: no room.

    The labels are in the order of their centres.
    """
    ends = [-math.inf] * levels
    chosen: list[int | None] = []
    for centre, width in zip(centres, widths, strict=True):
        start = centre - width / 2
        level = next((k for k in range(levels) if ends[k] <= start), None)
        if level is not None:
            ends[level] = centre + width / 2
        chosen.append(level)
    return chosen


def message_news(carry: "Carry") -> Iterator[tuple["Message", bool]]:
    """Every message, and whether it differs from the one before of its sender.

    A controller that is not periodic repeats nothing, so all its messages are news. The table of a
    job on the floor sends beacons by a radio of its own.
    """
    is_periodic = describe(carry.controller).is_periodic
    last: dict[tuple[str, bool], str] = {}
    for message in carry.message_log:
        is_of_table = message.kind in _OF_TABLE
        radio = message.sender, is_of_table
        repeats = is_periodic or is_of_table
        yield message, not repeats or message.kind != last.get(radio)
        last[radio] = message.kind


def message_key(carry: "Carry") -> list[Line2D]:
    """Legend entries for the kinds of message of this carry."""
    used = {message.kind for message in carry.message_log}
    entries = [
        Line2D([], [], marker=marker, label=kind, color=QUIET, mfc=INK, mec=INK, ms=3.2, lw=0.8)
        for kind, marker in _MARKERS.items()
        if kind in used
    ]
    if used - set(_MARKERS):
        entries.append(
            Line2D(
                [], [], marker=_OTHER, label="other", color=QUIET, mfc=INK, mec=INK, ms=4, lw=0.8
            )
        )
    if any(message.received_s is None for message in carry.message_log):
        entries.append(
            Line2D([], [], marker="x", label="lost", color=QUIET, mec=DROP, ms=4, lw=0.8)
        )
    return entries


def add_timeline(panel: Axes, carry: "Carry", start: float, end: float, width_in: float) -> None:
    """Draw bars, labels and messages between two times; `width_in` is the width in inches."""
    shown = [c for c in carry.corrections if c.end_s >= start and c.start_s <= end]
    second_per_inch = (end - start) / width_in
    size = 6.5 if len(shown) > 3.2 * width_in else 8.0
    bars = [bar for bar in correction_bars(carry) if bar.end >= start and bar.start <= end]
    legible = len(bars) <= _MOST_PER_INCH * width_in
    if not legible:
        bars = [replace(bar, text="") for bar in bars]
    levels_used = 1
    for row in SIDES:
        mine = [bar for bar in bars if bar.row == row]
        levels_used = max(
            levels_used, _draw_row(panel, mine, row, size, second_per_inch, (start, end))
        )
    messages = [m for m, is_news in message_news(carry) if is_news and start <= m.sent_s <= end]
    if legible:
        _draw_messages(panel, messages, end, size)
    if not shown:
        panel.text(
            (start + end) / 2, 0, "no corrections", ha="center", va="center", size=8, color=QUIET
        )
    if carry.outcome != "delivered" and start <= carry.time_s <= end:
        side, shift = ("right", -4) if carry.time_s > (start + end) / 2 else ("left", 4)
        panel.annotate(
            f"{carry.outcome}: {carry.reason or 'time is up'}",
            (carry.time_s, 0),
            (shift, 0),
            textcoords="offset points",
            ha=side,
            va="center",
            size=8,
            color=DROP,
            weight="bold",
            zorder=7,
            bbox={"fc": BACKGROUND, "ec": "none", "alpha": 0.85, "pad": 1.0},
        )
    reach = _ROW["left"] + _BAR + 0.1 + levels_used * _LEVEL
    panel.set_ylim(-reach, reach)
    panel.grid(False)
    for level in _ROW.values():
        panel.axhline(level, color=RULE, lw=0.8, zorder=0)
    panel.set_yticks(list(_ROW.values()), list(_ROW))
    panel.set_ylabel("correction\n(case)")


@dataclass(frozen=True)
class Bar:
    """An interval in which the robot of a row corrects, or only assists."""

    row: str
    hue: str
    start: float  # s
    end: float  # s
    text: str
    assists: bool


def correction_bars(carry: "Carry") -> list[Bar]:
    """Every correction, and every interval of the trace in which a robot was in case (c)."""
    bars = []
    for c in carry.corrections:
        text = f"{c.label} ({c.case})"
        if c.robot == "both":  # one bar in each row, one label
            bars.append(Bar("right", "both", c.start_s, c.end_s, "", False))
        row = "left" if c.robot == "both" else c.robot
        bars.append(Bar(row, c.robot, c.start_s, c.end_s, text, False))
    assert carry.trace is not None
    times = carry.trace["time"].to_numpy()
    for row in SIDES:
        for first, last in runs(carry.trace["case"].sel(side=row).to_numpy() == "c"):
            bars.append(Bar(row, row, times[first], times[last], "(c)", True))
    return sorted(bars, key=lambda bar: bar.start)


def stage_bars(job: "FloorJob") -> list[Bar]:
    """The stages of a job on the floor."""
    return [
        Bar(side, side, start, end, name, False)
        for side in SIDES
        for name, start, end in stages(job, side)
    ]


def runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """First and last-plus-one index (at most the last row) of every run of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(a), min(int(b), len(flags) - 1)) for a, b in edges.reshape(-1, 2)]


def _draw_row(
    panel: Axes,
    bars: Sequence[Bar],
    row: str,
    size: float,
    second_per_inch: float,
    window: tuple[float, float],
) -> int:
    """Draw the bars of a robot with their labels; returns the number of label levels."""
    outward = math.copysign(1.0, _ROW[row])
    for bar in bars:
        place, duration = (bar.start, _ROW[row] - _BAR), bar.end - bar.start
        look: dict[str, Any]
        if bar.assists:
            look = {"fc": BACKGROUND, "ec": HUE[row], "hatch": HATCH[row], "lw": 0.7, "zorder": 2}
        else:
            look = {"fc": HUE[bar.hue], "ec": BACKGROUND, "lw": 0.4, "zorder": 3}
        panel.add_patch(Rectangle(place, duration, 2 * _BAR, **look))

    labelled = [bar for bar in bars if bar.text]
    widths = [0.6 * size / 72 * (len(bar.text) + 0.8) * second_per_inch for bar in labelled]
    centres = []
    for bar, width in zip(labelled, widths, strict=True):
        middle = (max(bar.start, window[0]) + min(bar.end, window[1])) / 2
        centres.append(min(max(middle, window[0] + width / 2), window[1] - width / 2))
    levels = assign_label_rows(centres, widths, 3)
    for bar, centre, level in zip(labelled, centres, levels, strict=True):
        if level is None:
            continue
        y = _ROW[row] + outward * (_BAR + 0.08 + level * _LEVEL)
        va = "bottom" if outward > 0 else "top"
        colour = HUE[row] if bar.assists else INK
        panel.text(centre, y, bar.text, ha="center", va=va, size=size, color=colour, zorder=6)
        if level:
            edge = _ROW[row] + outward * _BAR
            panel.plot([centre, centre], [edge, y], color=LEADER, lw=0.5, zorder=1)
    return 1 + max((level for level in levels if level is not None), default=0)


def _draw_messages(panel: Axes, messages: "Sequence[Message]", end: float, size: float) -> None:
    """A line for each message from the row of its sender to that of its receiver.

    A marker at the arrival shows its kind. A lost message ends halfway between the rows.
    """
    lines = []
    arrivals: dict[Any, list[tuple[float, float]]] = {}
    for m in messages:
        direction = math.copysign(1.0, _ROW[m.receiver] - _ROW[m.sender])
        start = _ROW[m.sender] + direction * _BAR
        if m.received_s is None:
            marker, goal = "x", (m.sent_s, 0.0)
        else:
            arrival = _ROW[m.receiver] - direction * (_BAR + 0.1)
            marker, goal = _MARKERS.get(m.kind, _OTHER), (min(m.received_s, end), arrival)
        lines.append([(m.sent_s, start), goal])
        arrivals.setdefault(marker, []).append(goal)
    collection = LineCollection(lines, colors=QUIET, linewidths=0.7, zorder=4)
    panel.add_collection(collection, autolim=False)
    for marker, goals in arrivals.items():
        colour = DROP if marker == "x" else INK
        x, y = zip(*goals, strict=True)
        panel.scatter(x, y, s=1.4 * size, marker=marker, color=colour, lw=0.8, zorder=5)

"""The top panel of Figure 8: who corrects what, who assists, and which messages pass.

The left robot's row is above, the right robot's below, and a station's between them where the
controller has one. Labels stand outside the rows, on as many levels as they need not to collide.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from palmbots.style import DROP, HATCH, HUE, INK, QUIET

if TYPE_CHECKING:
    from palmbots.carry import Carry, Letter

__all__ = ["Bar", "correction_bars", "draw_story", "message_key", "runs", "stagger"]

_ROW = {"left": 1.0, "right": -1.0, "station": 0.0}
_BAR = 0.3  # half the height of a bar, in the panel's own unit
_LEVEL = 0.62  # height of one level of labels
_MARKERS = {"TiltUp": "^", "Ack": "o", "TiltDown": "v"}
_MANY = 400  # more messages than this are thinned to those that differ from the last on their link


def stagger(centres: Sequence[float], widths: Sequence[float], levels: int) -> list[int]:
    """A level for each label, left to right, so that labels of one level do not overlap.

    Where even the last level is taken, the level that frees first gets the label.
    """
    ends = [-math.inf] * levels
    chosen = []
    for centre, width in zip(centres, widths, strict=True):
        start = centre - width / 2
        level = next((k for k in range(levels) if ends[k] <= start), int(np.argmin(ends)))
        ends[level] = centre + width / 2
        chosen.append(level)
    return chosen


def message_key(carry: "Carry") -> list[Line2D]:
    """Legend entries for the kinds of message this carry holds."""
    used = {letter.letter for letter in carry.letters}
    known = [kind for kind in _MARKERS if kind in used]
    look = {"color": QUIET, "mfc": INK, "mec": INK, "ms": 3.2, "lw": 0.8}
    entries = [Line2D([], [], marker=_MARKERS[kind], label=kind, **look) for kind in known]
    if used - set(known):
        entries.append(Line2D([], [], marker=".", label="state packet", **look))
    if any(letter.received_s is None for letter in carry.letters):
        look = {"color": QUIET, "mec": DROP, "ms": 4, "lw": 0.8}
        entries.append(Line2D([], [], marker="x", label="lost", **look))
    return entries


def draw_story(panel: Axes, carry: "Carry", start: float, end: float, width_in: float) -> None:
    """Draw bars, labels and messages between two times; `width_in` is the panel's width in inches."""
    shown = [c for c in carry.corrections if c.end_s >= start and c.start_s <= end]
    second_per_inch = (end - start) / width_in
    size = 6.5 if len(shown) > 3.2 * width_in else 8.0
    bars = [bar for bar in correction_bars(carry) if bar.end >= start and bar.start <= end]
    tallest = 1
    for row in ("left", "right"):
        mine = [bar for bar in bars if bar.row == row]
        tallest = max(tallest, _draw_row(panel, mine, row, size, second_per_inch, (start, end)))
    letters = [m for m in carry.letters if start <= m.sent_s <= end]
    _draw_letters(panel, letters, end)
    if not shown:
        panel.text(
            (start + end) / 2, 0, "no corrections", ha="center", va="center", size=8, color=QUIET
        )
    if carry.outcome != "delivered" and start <= carry.time_s <= end:
        side, shift = ("right", -4) if carry.time_s > (start + end) / 2 else ("left", 4)
        panel.annotate(
            f"{carry.outcome}: {carry.reason or 'time is up'}", (carry.time_s, 0), (shift, 0),
            textcoords="offset points", ha=side, va="center", size=8, color=DROP, weight="bold",
            zorder=7, bbox={"fc": "white", "ec": "none", "alpha": 0.85, "pad": 1.0},
        )
    reach = _ROW["left"] + _BAR + 0.1 + tallest * _LEVEL
    panel.set_ylim(-reach, reach)
    panel.grid(False)
    rows = ["left", "right"]
    if any("station" in (m.sender, m.receiver) for m in letters):
        rows.append("station")
    for row in rows:
        panel.axhline(_ROW[row], color="#DDDDDD", lw=0.8, zorder=0)
    panel.set_yticks([_ROW[row] for row in rows], rows)
    panel.set_ylabel("correction\n(case)")


@dataclass(frozen=True)
class Bar:
    """A stretch of time in which the robot of a row corrects, or only assists."""

    row: str
    hue: str
    start: float  # s
    end: float  # s
    text: str
    assists: bool


def correction_bars(carry: "Carry") -> list[Bar]:
    """Every correction, and from the trace every stretch that a robot spent in case (c)."""
    bars = []
    for c in carry.corrections:
        text = f"{c.label} ({c.case})"
        if c.robot == "both":  # one bar in each row, one label
            bars.append(Bar("right", "both", c.start_s, c.end_s, "", False))
        row = "left" if c.robot == "both" else c.robot
        bars.append(Bar(row, c.robot, c.start_s, c.end_s, text, False))
    assert carry.trace is not None
    times = carry.trace["time"].to_numpy()
    for row in ("left", "right"):
        for first, last in runs(carry.trace["case"].sel(side=row).to_numpy() == "c"):
            bars.append(Bar(row, row, times[first], times[last], "(c)", True))
    return sorted(bars, key=lambda bar: bar.start)


def runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """First and last-plus-one index (at most the last row) of every unbroken run of true flags."""
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
    """Draw a robot's bars with their labels outside; returns how many levels of labels it took."""
    outward = math.copysign(1.0, _ROW[row])
    for bar in bars:
        place, long = (bar.start, _ROW[row] - _BAR), bar.end - bar.start
        if bar.assists:
            look = {"fc": "white", "ec": HUE[row], "hatch": HATCH[row], "lw": 0.7, "zorder": 2}
        else:
            look = {"fc": HUE[bar.hue], "ec": "white", "lw": 0.4, "zorder": 3}
        panel.add_patch(Rectangle(place, long, 2 * _BAR, **look))

    labelled = [bar for bar in bars if bar.text]
    widths = [0.6 * size / 72 * (len(bar.text) + 0.8) * second_per_inch for bar in labelled]
    centres = []
    for bar, width in zip(labelled, widths, strict=True):
        middle = (max(bar.start, window[0]) + min(bar.end, window[1])) / 2
        centres.append(min(max(middle, window[0] + width / 2), window[1] - width / 2))
    levels = stagger(centres, widths, 3)
    for bar, centre, level in zip(labelled, centres, levels, strict=True):
        y = _ROW[row] + outward * (_BAR + 0.08 + level * _LEVEL)
        va = "bottom" if outward > 0 else "top"
        colour = HUE[row] if bar.assists else INK
        panel.text(centre, y, bar.text, ha="center", va=va, size=size, color=colour, zorder=6)
        if level:
            edge = _ROW[row] + outward * _BAR
            panel.plot([centre, centre], [edge, y], color="#BBBBBB", lw=0.5, zorder=1)
    return max(levels, default=0) + 1


@dataclass(frozen=True)
class _Flight:
    """One message as drawn: from (time, row) to (time, row)."""

    start: tuple[float, float]
    end: tuple[float, float]
    marker: str


def _draw_letters(panel: Axes, letters: "Sequence[Letter]", end: float) -> None:
    """A line per message from its sender's row to its receiver's, its kind marked on arrival."""
    flights = [_flight(m, end) for m in _thinned(letters)]
    lines = [[f.start, f.end] for f in flights]
    panel.add_collection(LineCollection(lines, colors=QUIET, linewidths=0.7, zorder=4), autolim=False)
    for marker in {f.marker for f in flights}:
        ends = np.array([f.end for f in flights if f.marker == marker])
        small = 5 if marker == "." else 11
        colour = DROP if marker == "x" else INK
        panel.scatter(*ends.T, s=small, marker=marker, color=colour, lw=0.8, zorder=5)


def _thinned(letters: "Sequence[Letter]") -> "list[Letter]":
    if len(letters) <= _MANY:
        return list(letters)
    last: dict[tuple[str, str], str] = {}
    kept = []
    for m in letters:
        link = (m.sender, m.receiver)
        if last.get(link) != m.letter:
            kept.append(m)
        last[link] = m.letter
    return kept


def _flight(m: "Letter", end: float) -> _Flight:
    """A lost message ends half way, straight below where it was sent."""
    direction = math.copysign(1.0, _ROW[m.receiver] - _ROW[m.sender])
    start = _ROW[m.sender] + direction * (_BAR if m.sender != "station" else 0.0)
    goal = _ROW[m.receiver] - direction * (_BAR + 0.1 if m.receiver != "station" else 0.0)
    if m.received_s is None:
        return _Flight((m.sent_s, start), (m.sent_s, (start + goal) / 2), "x")
    return _Flight((m.sent_s, start), (min(m.received_s, end), goal), _MARKERS.get(m.letter, "."))

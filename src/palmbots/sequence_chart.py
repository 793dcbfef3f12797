"""A message-sequence chart of a carry: two lifelines downwards, and every letter between them.

Time runs down, one column after the other. On a robot's line stand the cases that it is in, shaded
in its hue; an arrow is a letter, from when it was sent to when it can be read, the steeper the
later it comes. A lost one ends at a cross on its way. Where a robot repeats what it said last, as
the resilient algorithm does all the time, the arrow is thin and bears no name. A copy that the
scene has planned is dashed; random copies are not drawn.
"""

import math
import os
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from palmbots.errors import PalmbotsError
from palmbots.figure8_story import letters_told, runs
from palmbots.geometry import SIDES
from palmbots.pictures import save_figure
from palmbots.style import DROP, HATCH, HUE, INK, QUIET, styled

if TYPE_CHECKING:
    from palmbots.result import Carry, Letter

__all__ = ["draw", "save"]

_TALL = 6.5  # inches of a column
_WIDE = 2.6  # inches of a column
_MOST_COLUMNS = 8
_DENSE = 0.16  # s: letters closer than this in the mean get more room
_LINE = {"left": 0.0, "right": 1.0}
_BAR = 0.07  # width of a case's bar
_NAME = 0.13  # inches that a letter's name is high
_NAME_WIDE = 13  # points that a name of a case, as (a), takes


def draw(carry: "Carry", window: tuple[float, float] | None = None) -> Figure:
    """The chart of a carry, or of the part between two times in seconds.

    Raises `PalmbotsError` if the carry was run without recording its trace, or the window is empty.
    """
    if carry.trace is None:
        raise PalmbotsError("chart: this carry has no trace; run it with record=True")
    last = max(float(carry.trace["time"].to_numpy()[-1]), carry.scene.control.period_s)
    start, end = window or (0.0, last)
    if not (math.isfinite(start) and math.isfinite(end) and start < end):
        raise PalmbotsError(f"chart: window is {window}; allowed: (from_s, to_s) with from < to")
    told = [told for told in letters_told(carry) if start <= told[0].sent_s <= end]
    named = sum(1 for _, news in told if news)
    columns = math.ceil(max((end - start) / 8.0, named * _DENSE / _TALL * 1.5, 1.0))
    columns = min(columns, _MOST_COLUMNS)
    span = (end - start) / columns
    with styled():
        width = max(_WIDE * columns + 0.5, 4.0)  # a title's
        figure = Figure(figsize=(width, _TALL + 1.1))
        panels = np.atleast_1d(figure.subplots(1, columns, squeeze=True))
        for k, panel in enumerate(panels):
            _draw_column(panel, carry, told, start + k * span, start + (k + 1) * span)
        panels[0].set_ylabel("time (s)")
        _head(figure, carry)
        figure.subplots_adjust(
            left=0.55 / figure.get_figwidth(),
            right=1 - 0.15 / figure.get_figwidth(),
            top=1 - 0.85 / figure.get_figheight(),
            bottom=0.2 / figure.get_figheight(),
            wspace=0.32,
        )
    return figure


def save(
    carry: "Carry", path: str | os.PathLike[str], window: tuple[float, float] | None = None
) -> None:
    """Write the chart to `path`, as PNG, SVG or PDF by its suffix; the file appears whole or not.

    Raises `PalmbotsError` for another suffix, an unwritable path, or as `draw` does.
    """
    save_figure(path, draw(carry, window))


def _copies(carry: "Carry") -> Iterator["Letter"]:
    """The second coming of each message that the scene plans to double."""
    for mishap in carry.scene.radio.script:
        sent = [letter for letter in carry.letters if letter.sender == mishap.sender]
        if mishap.fate != "copied" or len(sent) < mishap.message:
            continue
        letter = sent[mishap.message - 1]
        if letter.received_s is not None:
            yield replace(letter, received_s=letter.received_s + (mishap.late_s or 0.0))


def _draw_column(
    panel: Axes, carry: "Carry", told: list[tuple["Letter", bool]], start: float, end: float
) -> None:
    """The part of the chart between two times."""
    panel.set_xlim(-0.3, 1.3)
    panel.set_ylim(end, start)
    panel.grid(visible=True, axis="y")
    panel.spines[["bottom", "left"]].set_visible(False)
    panel.xaxis.tick_top()
    panel.set_xticks(list(_LINE.values()), [f"{side} robot" for side in SIDES])
    panel.tick_params(axis="both", length=0)
    for side in SIDES:
        panel.plot([_LINE[side]] * 2, [start, end], color=HUE[side], lw=0.8, zorder=1)
        _draw_cases(panel, carry, side, start, end)
        _draw_faults(panel, carry, side, start, end)
    high = _NAME * (end - start) / _TALL
    # Above the column stand the robots' names.
    taken: dict[str, list[tuple[float, float]]] = {side: [(-math.inf, start)] for side in SIDES}
    arrows: list[Letter] = []
    for letter, news in told:
        if not start <= letter.sent_s <= end:
            continue
        # A name stands above its arrow, or below where another name or an arrow is in its way.
        spots = [(letter.sent_s - high, letter.sent_s), (letter.sent_s, letter.sent_s + high)]
        costs = [_in_the_way(letter, spot, taken[letter.sender], arrows) for spot in spots]
        below = costs[1] < costs[0]
        _draw_letter(panel, letter, news, below)
        if news:
            taken[letter.sender].append(spots[below])
            arrows.append(letter)
    for copy in _copies(carry):
        if start <= copy.sent_s <= end:
            _draw_letter(panel, copy, news=True, below=True, copy=True)
    if carry.outcome != "delivered" and start <= carry.time_s <= end:
        panel.axhline(carry.time_s, color=DROP, lw=1.6, clip_on=False, zorder=5)


def _in_the_way(
    letter: "Letter",
    spot: tuple[float, float],
    names: list[tuple[float, float]],
    arrows: list["Letter"],
) -> int:
    """What a letter's name would meet from one time to another; a name counts for many arrows."""
    slack = 0.1 * (spot[1] - spot[0])
    found = 100 * sum(low < spot[1] - slack and high > spot[0] + slack for low, high in names)
    for arrow in arrows:
        if arrow.sender == letter.sender or arrow.received_s is None:
            continue
        # The name is between 1/10 and 1/2 of its own letter's way, near the end of the partner's.
        lasts = arrow.received_s - arrow.sent_s
        first, last = arrow.sent_s + 0.5 * lasts, arrow.sent_s + 0.9 * lasts
        found += first <= spot[1] and last >= spot[0]
    return found


def _draw_cases(panel: Axes, carry: "Carry", side: str, start: float, end: float) -> None:
    assert carry.trace is not None
    times = carry.trace["time"].to_numpy()
    cases = carry.trace["case"].sel(side=side).to_numpy()
    begun: list[tuple[float, str]] = []
    for case in sorted(set(cases) - {" "}):
        for first, after in runs(cases == case):
            low, high = times[first], times[min(after, len(times) - 1)]
            if high < start or low > end:
                continue
            low, high = max(low, start), min(high, end)
            place = (_LINE[side] - _BAR / 2, low)
            colour = HUE[side]
            bar = Rectangle(place, _BAR, high - low, fc=colour, alpha=0.3, lw=0, zorder=2)
            panel.add_patch(bar)
            if case == "c":  # it assists
                over = {"fc": "none", "ec": colour, "hatch": HATCH[side], "lw": 0, "alpha": 0.6}
                panel.add_patch(Rectangle(place, _BAR, high - low, zorder=2, **over))
            begun.append((low, case))
    outward = -1 if side == "left" else 1
    above, away = -math.inf, 0.0
    for low, case in sorted(begun):
        # Beside the bar, or beside the name above where there is no room below it.
        away = away + _NAME_WIDE if low - above < _NAME * (end - start) / _TALL else 6
        above = low
        panel.annotate(
            f"({case})",
            (_LINE[side], low),
            (outward * away, -1),
            textcoords="offset points",
            ha="right" if outward < 0 else "left",
            va="top",
            size=7,
            color=HUE[side],
        )


def _draw_faults(panel: Axes, carry: "Carry", side: str, start: float, end: float) -> None:
    """When a robot's program did not run, as the scene's schedule has it."""
    for broken in carry.scene.faults.script:
        if broken.robot != side or broken.kind not in ("reboot", "freeze"):
            continue
        low, high = max(broken.at_s, start), min(broken.at_s + broken.for_s, end)
        if low >= high:
            continue
        panel.add_patch(
            Rectangle((_LINE[side] - _BAR, low), 2 * _BAR, high - low, color=DROP, alpha=0.5, lw=0)
        )
        panel.annotate(
            broken.kind,
            (_LINE[side], low),
            (0, 2),
            textcoords="offset points",
            ha="center",
            va="bottom",
            size=7,
            color=DROP,
        )


def _draw_letter(
    panel: Axes, letter: "Letter", news: bool, below: bool, copy: bool = False
) -> None:
    from_x, to_x = _LINE[letter.sender], _LINE[letter.receiver]
    colour = INK if news else QUIET
    lost = letter.received_s is None
    if lost:
        to_x = from_x + 0.55 * (to_x - from_x)
    to_y = letter.sent_s if letter.received_s is None else letter.received_s
    # A letter that is read after the column's end still points there.
    panel.annotate(
        "",
        (to_x, to_y),
        (from_x, letter.sent_s),
        annotation_clip=False,
        arrowprops={
            "arrowstyle": "-" if lost else "-|>",
            "mutation_scale": 7 if news else 4,
            "lw": 0.9 if news else 0.35,
            "color": DROP if lost and news else colour,
            "linestyle": "--" if copy else "-",
            "shrinkA": 0,
            "shrinkB": 0,
        },
        zorder=3,
    )
    if lost:
        size = 5 if news else 2.5
        panel.plot([to_x], [to_y], marker="x", ms=size, mew=0.8 + 0.4 * news, color=DROP, zorder=4)
    if news:
        share = 0.3  # of the way, where the name stands
        at = (from_x + share * (to_x - from_x), letter.sent_s + share * (to_y - letter.sent_s))
        what = f"{letter.letter} lost" if lost else letter.letter
        panel.annotate(
            f"{letter.letter} again" if copy else what,
            at if copy else (from_x + share * (_LINE[letter.receiver] - from_x), letter.sent_s),
            (0, -3 if below else 1.5),
            textcoords="offset points",
            ha="center",
            va="top" if below else "bottom",
            size=6.5,
            color=DROP if lost else INK,
            zorder=4,
        )


def _head(figure: Figure, carry: "Carry") -> None:
    ending = carry.outcome if carry.reason is None else f"{carry.outcome} ({carry.reason})"
    x = 0.12 / figure.get_figwidth()
    height = figure.get_figheight()
    title = f"{carry.controller} algorithm: {ending} after {carry.time_s:.2f} s"
    figure.text(x, 1 - 0.08 / height, title, va="top", weight="bold", size=9)
    sent = f"{carry.messages} messages, {carry.messages_lost} lost, seed {carry.seed}"
    figure.text(x, 1 - 0.25 / height, sent, va="top", size=7.5)
    entries = [
        Rectangle((0, 0), 1, 1, fc=QUIET, alpha=0.5, label="corrects"),
        Rectangle((0, 0), 1, 1, fc="none", ec=QUIET, hatch="////", lw=0, label="assists"),
        Line2D([], [], marker="x", color=DROP, lw=0.9, ms=4, label="lost"),
    ]
    figure.legend(
        handles=entries,
        loc="upper left",
        bbox_to_anchor=(x, 1 - 0.4 / height),
        ncols=3,
        borderaxespad=0,
        handlelength=1.6,
        labelspacing=0.2,
    )

# SPDX-License-Identifier: Apache-2.0
"""Draws the message sequence chart of a carry: two lifelines, and every message between them.

Time runs downwards, one column after the other. The line of a robot shows its cases, shaded in its
colour. An arrow is a message, from the time it was sent to the time it can be read. A lost message
ends at a cross. Repeated beacons of the resilient algorithm are thin arrows without a name. A
duplicate that the scene has scripted is dashed; random duplicates are not drawn.

Where a column would have more messages than can be distinguished, each kind of message has a lane
between the robots. A mark there is a message when it was sent, in the colour of its sender; a lost
one is in the colour of failures.
"""

import math
import os
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import (
    DROP,
    HATCH,
    HUE,
    INK,
    PAPER,
    QUIET,
    axis_label,
    controller_title,
    styled,
)
from palmbots.viz.timeline import message_news, runs

if TYPE_CHECKING:
    from palmbots.simulation.result import Carry, Message

_TALL = 6.5  # inches of a column
_WIDE = 2.6  # inches of a column
_MOST_COLUMNS = 8
_MOST_NAMES = 40  # in a column
_DENSE = 0.16  # s: messages that are closer on average get more room
_LINE = {"left": 0.0, "right": 1.0}
_BAR = 0.07  # width of a case's bar
_NAME = 0.13  # inches, height of the name of a message
_NAME_WIDE = 13  # points, width of the name of a case, such as (a)


def draw_message_sequence(carry: "Carry", window: tuple[float, float] | None = None) -> Figure:
    """Draw the chart of a carry, or of the part between two times in seconds.

    Raises:
        PalmbotsError: the carry has no trace, or the window is empty.
    """
    if carry.trace is None:
        raise PalmbotsError("chart: this carry has no trace; run it with record=True")
    last = max(float(carry.trace["time"].to_numpy()[-1]), carry.scene.control.period_s)
    start, end = map(float, (0.0, last) if window is None else window)
    if not (math.isfinite(start) and math.isfinite(end) and start < end):
        raise PalmbotsError(f"chart: window is {window}; allowed: (from_s, to_s) with from < to")
    messages = [row for row in message_news(carry) if start <= row[0].sent_s <= end]
    named = sum(1 for _, is_news in messages if is_news)
    columns = math.ceil(max((end - start) / 8.0, named * _DENSE / _TALL * 1.5, 1.0))
    columns = min(columns, _MOST_COLUMNS)
    span = (end - start) / columns
    kinds = sorted({message.kind for message, _ in messages})
    has_lanes = named > _MOST_NAMES * columns
    with styled():
        width = max(_WIDE * columns + 0.5, 4.0)  # at least that of the title
        figure = Figure(figsize=(width, _TALL + 1.1))
        panels = np.atleast_1d(figure.subplots(1, columns, squeeze=True))
        for k, panel in enumerate(panels):
            low, high = start + k * span, start + (k + 1) * span
            _draw_robots(panel, carry, low, high)
            if has_lanes:
                _draw_lanes(panel, [message for message, _ in messages], kinds, low, high)
            else:
                _draw_arrows(panel, carry, messages, low, high)
        panels[0].set_ylabel(axis_label("time", "s"))
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
    """Write the chart to `path` as PNG, SVG or PDF, by its suffix.

    Raises:
        PalmbotsError: the suffix is not allowed, the path cannot be written, or as `draw`.
    """
    write_figure(path, draw_message_sequence(carry, window))


def _copies(carry: "Carry") -> Iterator["Message"]:
    """The duplicates that the script of the scene requests."""
    for fault in carry.scene.radio.script:
        sent = [message for message in carry.message_log if message.sender == fault.sender]
        if fault.effect != "duplicated" or len(sent) < fault.message:
            continue
        message = sent[fault.message - 1]
        if message.received_s is not None:
            yield replace(message, received_s=message.received_s + (fault.delay_s or 0.0))


def _draw_robots(panel: Axes, carry: "Carry", start: float, end: float) -> None:
    """The lifelines between two times, with what the robots did."""
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
    if carry.outcome != "delivered" and start <= carry.time_s <= end:
        panel.axhline(carry.time_s, color=DROP, lw=1.6, clip_on=False, zorder=5)


def _draw_lanes(
    panel: Axes, messages: list["Message"], kinds: list[str], start: float, end: float
) -> None:
    """The messages sent between two times, one lane for each kind and sender."""
    width = 0.7 / max(len(kinds), 1)
    for k, kind in enumerate(kinds):
        middle = 0.15 + (k + 0.5) * width
        panel.annotate(
            kind, (middle, start), (0, -2), textcoords="offset points", rotation=90,
            ha="center", va="top", size=6.5, color=INK, zorder=6,
            bbox={"fc": PAPER, "ec": "none", "pad": 0.6, "alpha": 0.85},
        )  # fmt: skip
        for shift, side in zip((-0.45, 0.0), SIDES, strict=True):
            own = [m for m in messages if (m.kind, m.sender) == (kind, side)]
            for is_lost, colour in ((False, HUE[side]), (True, DROP)):
                times = [
                    m.sent_s
                    for m in own
                    if start <= m.sent_s <= end and (m.received_s is None) == is_lost
                ]
                left = middle + shift * width
                panel.hlines(times, left, left + 0.45 * width, color=colour, lw=0.5, zorder=3)


def _draw_arrows(
    panel: Axes, carry: "Carry", messages: list[tuple["Message", bool]], start: float, end: float
) -> None:
    """The messages sent between two times."""
    high = _NAME * (end - start) / _TALL
    # The names of the robots stand above the column.
    taken: dict[str, list[tuple[float, float]]] = {side: [(-math.inf, start)] for side in SIDES}
    arrows: list[Message] = []
    for message, is_news in messages:
        if not start <= message.sent_s <= end:
            continue
        # A name stands above its arrow, or below it where that covers less.
        sent = message.sent_s
        spots = [(sent - high, sent), (sent, sent + high)]
        costs = [_overlaps(message, spot, taken[message.sender], arrows) for spot in spots]
        is_below = costs[1] < costs[0]
        _draw_message(panel, message, is_news, is_below)
        if is_news:
            taken[message.sender].append(spots[is_below])
            arrows.append(message)
    for copy in _copies(carry):
        if start <= copy.sent_s <= end:
            _draw_message(panel, copy, is_news=True, is_below=True, is_copy=True)


def _overlaps(
    message: "Message",
    spot: tuple[float, float],
    names: list[tuple[float, float]],
    arrows: list["Message"],
) -> int:
    """How much the name of a message would cover; another name counts as much as 100 arrows."""
    slack = 0.1 * (spot[1] - spot[0])
    count = 100 * sum(low < spot[1] - slack and high > spot[0] + slack for low, high in names)
    for arrow in arrows:
        if arrow.sender == message.sender or arrow.received_s is None:
            continue
        # The name stands between 10 and 50 % of its own arrow: 50 to 90 % of an opposite arrow.
        transit = arrow.received_s - arrow.sent_s
        first, last = arrow.sent_s + 0.5 * transit, arrow.sent_s + 0.9 * transit
        count += first <= spot[1] and last >= spot[0]
    return count


def _draw_cases(panel: Axes, carry: "Carry", side: str, start: float, end: float) -> None:
    assert carry.trace is not None
    times = carry.trace["time"].to_numpy()
    cases = carry.trace["case"].sel(side=side).to_numpy()
    labels: list[tuple[float, str]] = []
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
            if case == "c":  # the robot assists
                over: Any = {
                    "fc": "none",
                    "ec": colour,
                    "hatch": HATCH[side],
                    "lw": 0,
                    "alpha": 0.6,
                }
                panel.add_patch(Rectangle(place, _BAR, high - low, zorder=2, **over))
            labels.append((low, case))
    outward = -1 if side == "left" else 1
    above, away = -math.inf, 0.0
    for low, case in sorted(labels):
        # Beside the bar, or beside the previous name where there is no room below that.
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
    """The scripted times at which the program of a robot did not run."""
    for fault in carry.scene.faults.script:
        if fault.robot != side or fault.kind not in ("reboot", "freeze"):
            continue
        lasts_s = math.inf if fault.loses_boot_counter else fault.duration_s
        low, high = max(fault.at_s, start), min(fault.at_s + lasts_s, end)
        if low >= high:
            continue
        panel.add_patch(
            Rectangle((_LINE[side] - _BAR, low), 2 * _BAR, high - low, color=DROP, alpha=0.5, lw=0)
        )
        panel.annotate(
            fault.kind,
            (_LINE[side], low),
            (0, 2),
            textcoords="offset points",
            ha="center",
            va="bottom",
            size=7,
            color=DROP,
        )


def _draw_message(
    panel: Axes, message: "Message", is_news: bool, is_below: bool, is_copy: bool = False
) -> None:
    from_x, to_x = _LINE[message.sender], _LINE[message.receiver]
    colour = INK if is_news else QUIET
    lost = message.received_s is None
    if lost:
        to_x = from_x + 0.55 * (to_x - from_x)
    to_y = message.sent_s if message.received_s is None else message.received_s
    # The arrow of a message that is read after the end of the column still points there.
    panel.annotate(
        "",
        (to_x, to_y),
        (from_x, message.sent_s),
        annotation_clip=False,
        arrowprops={
            "arrowstyle": "-" if lost else "-|>",
            "mutation_scale": 7 if is_news else 4,
            "lw": 0.9 if is_news else 0.35,
            "color": DROP if lost and is_news else colour,
            "linestyle": "--" if is_copy else "-",
            "shrinkA": 0,
            "shrinkB": 0,
        },
        zorder=3,
    )
    if lost:
        size = 5 if is_news else 2.5
        panel.plot(
            [to_x], [to_y], marker="x", ms=size, mew=0.8 + 0.4 * is_news, color=DROP, zorder=4
        )
    if is_news:
        share = 0.3  # position of the name along the arrow
        sent = message.sent_s
        beside = (from_x + share * (_LINE[message.receiver] - from_x), sent)
        along = (from_x + share * (to_x - from_x), sent + share * (to_y - sent))
        text = f"{message.kind} lost" if lost else message.kind
        panel.annotate(
            f"{message.kind} again" if is_copy else text,
            along if is_copy else beside,
            (0, -3 if is_below else 1.5),
            textcoords="offset points",
            ha="center",
            va="top" if is_below else "bottom",
            size=6.5,
            color=DROP if lost else INK,
            zorder=4,
        )


def _head(figure: Figure, carry: "Carry") -> None:
    ending = carry.outcome if carry.reason is None else f"{carry.outcome} ({carry.reason})"
    x = 0.12 / figure.get_figwidth()
    height = figure.get_figheight()
    title = f"{controller_title(carry.controller)}: {ending} after {carry.time_s:.2f} s"
    figure.text(x, 1 - 0.08 / height, title, va="top", weight="bold", size=9)
    sent = f"{carry.messages} messages, {carry.messages_lost} lost"
    sent += f", seed {carry.seed}" if carry.trace_hash else ""  # real robots have none
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

# SPDX-License-Identifier: Apache-2.0
"""Views: areas of a figure in data units, with labels that avoid what is drawn.

Figures are laid out in inches, so that the scale is known before the labels are placed.
"""

import math
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from palmbots.stability.problem import Pair
from palmbots.viz.style import BACKGROUND, INK, QUIET

Array = NDArray[np.float64]

MM = 1e3


def clipped(polygon: ArrayLike, normal: ArrayLike, most: float) -> Array:
    """The part of a polygon where normal · point ≤ most (Sutherland and Hodgman); may be empty."""
    points = np.asarray(polygon, float).reshape(-1, 2)
    room = most - points @ np.asarray(normal, float)
    corners: list[Array] = []
    for k in range(len(points)):
        one, two = room[k - 1], room[k]
        if (one < 0) != (two < 0):
            corners.append(points[k - 1] + one / (one - two) * (points[k] - points[k - 1]))
        if two >= 0:
            corners.append(points[k])
    return np.array(corners).reshape(-1, 2)


def meeting(one: Array, direction: Array, two: Array, other: Array) -> Array | None:
    """The intersection of the lines through two points; None: they are parallel."""
    cross = direction[0] * other[1] - direction[1] * other[0]
    if abs(cross) < 1e-9:
        return None
    offset = two - one
    return one + direction * (offset[0] * other[1] - offset[1] * other[0]) / cross


class View:
    """An area of a figure in data units, with labels that avoid everything drawn."""

    def __init__(self, axes: Axes, x: Pair, y: Pair) -> None:
        axes.set(xlim=x, ylim=y)
        axes.grid(False)
        figure = axes.get_figure()
        assert figure is not None
        frame = axes.get_window_extent()
        self.axes = axes
        self.corners = np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])])
        self._unit = figure.dpi / 72  # pixels of a typographic point
        self._origin = np.array([frame.x0, frame.y0])
        self._size = np.array([frame.width, frame.height]) / self._unit
        self.point = abs(x[1] - x[0]) / self._size[0]  # data units of a typographic point
        # Number of lines through each square of one point, and the label boxes: x0, y0, x1, y1.
        self._ink = np.zeros(np.ceil(self._size).astype(int) + 1)
        self._boxes = np.empty((0, 4))

    def _place(self, at: ArrayLike) -> Array:
        """A position in points, from the lower left corner of the view."""
        return (self.axes.transData.transform(at) - self._origin) / self._unit

    def avoid(self, *points: ArrayLike) -> None:
        """Keep labels away from a line through these points."""
        corners = self._place([np.asarray(p, float) for p in points])
        for one, two in pairwise(corners):
            count = 2 + int(np.hypot(*(two - one)))
            cells = np.floor(np.linspace(one, two, count)).astype(int)
            inside = ((cells >= 0) & (cells < self._ink.shape)).all(axis=1)
            np.add.at(self._ink, tuple(cells[inside].T), 1.0)

    def occupy(self, point: Array) -> None:
        """Keep labels away from a mark."""
        around = self.point * np.array([(-3, -3), (3, -3), (3, 3), (-3, 3), (-3, -3)])
        self.avoid(*(point + around))

    def line(
        self, *points: ArrayLike, colour: str = QUIET, width: float = 0.6, **look: Any
    ) -> None:
        """A line that labels avoid."""
        self.avoid(*points)
        path = np.array([np.asarray(p, float) for p in points])
        self.axes.plot(*path.T, color=colour, lw=width, **look)

    def fill(self, polygon: Array, **look: Any) -> None:
        """A polygon; empty ones are not drawn."""
        if len(polygon) > 2:
            self.axes.fill(*polygon.T, **look)

    def ray(self, start: Array, direction: Array, colour: str, width: float, ls: Any = "-") -> None:
        """A line from a point to beyond the edge of the view."""
        reach = 2 * float(np.abs(self.corners - start).max())
        self.line(start, start + reach * direction, colour=colour, width=width, ls=ls)

    def span(
        self, one: ArrayLike, two: ArrayLike, text: str, towards: ArrayLike, colour: str = INK
    ) -> None:
        """A dimension: an arrow with two heads and a label beside its middle."""
        one, two = np.asarray(one, float), np.asarray(two, float)
        style = "<|-|>,head_width=0.14,head_length=0.36"
        if np.hypot(*(two - one)) < 12 * self.point:  # no room for heads
            style = "|-|,widthA=0.14,widthB=0.14"
        look = {"arrowstyle": style, "color": colour, "lw": 0.7, "shrinkA": 0, "shrinkB": 0}
        self.axes.annotate("", tuple(two), tuple(one), arrowprops=look, annotation_clip=False)
        self.avoid(one, two)
        if text:
            self.label(text, 0.5 * (one + two), towards, colour)

    def arc(
        self, centre: Array, radius: float, start: float, end: float, text: str, colour: str = INK
    ) -> None:
        """An angle from one direction to another [rad], with a label outside its middle."""
        turns = np.linspace(start, end, 3 + int(abs(end - start) * 20))
        path = centre + radius * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
        self.line(*path, colour=colour, width=0.8)
        middle = path[len(path) // 2]
        self.label(text, middle, middle - centre, colour)

    def label(
        self, text: str, at: ArrayLike, towards: ArrayLike, colour: str = INK, size: float = 8.5
    ) -> None:
        """A text as close to a point as possible, preferably in a direction."""
        at = np.asarray(at, float)
        shown = self.axes.text(at[0], at[1], text, color=colour, size=size, zorder=9)
        shown.set(ha="center", va="center", linespacing=1.15)
        shown.set_fontstyle("italic" if len(text) < 3 else "normal")  # symbols
        box = shown.get_window_extent()
        half = 0.5 * np.array([box.width, box.height]) / self._unit
        anchor = self._place(at)
        centre, reach = self._free_place(anchor, half, np.asarray(towards, float))
        self._boxes = np.vstack([self._boxes, [*(centre - half), *(centre + half)]])
        back = self.axes.transData.inverted()
        shown.set_position(tuple(back.transform(self._origin + centre * self._unit)))
        if reach > 10:  # too far away to be recognised as its label
            touch = np.clip(anchor, centre - half, centre + half)
            self.line(at, back.transform(self._origin + touch * self._unit), colour=colour)

    def caption(self, text: str, x: float, y: float) -> None:
        """A text centred just above a point, on top of lines, shifted to stay in the view."""
        shown = self.axes.text(x, y + 3 * self.point, text, size=8, va="bottom", zorder=8)
        shown.set_bbox({"boxstyle": "square,pad=0.1", "fc": BACKGROUND, "ec": "none"})
        half = 0.5 * shown.get_window_extent().width / self._unit * self.point
        x = min(max(x, self.corners[0][0] + half), self.corners[1][0] - half)
        shown.set(x=x, ha="center")
        box = shown.get_window_extent()
        ends = np.array([(box.x0, box.y0), (box.x1, box.y1)])
        self._boxes = np.vstack([self._boxes, ((ends - self._origin) / self._unit).ravel()])

    def _free_place(self, anchor: Array, half: Array, towards: Array) -> tuple[Array, float]:
        """The best centre for a box and its distance from the anchor, in points."""
        reach, turn = (g.ravel() for g in np.meshgrid(_REACHES, _TURNS, indexing="ij"))
        angle = math.atan2(towards[1], towards[0]) + np.radians(turn)
        direction = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        # Each box touches the circle of its radius, whatever the direction.
        centre = anchor + direction * (reach + np.abs(direction) @ half)[:, np.newaxis]
        low, high = centre - half, centre + half
        total = np.pad(self._ink.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
        x0, y0 = np.clip(np.floor(low - 0.5).astype(int), 0, self._ink.shape).T
        x1, y1 = np.clip(np.floor(high + 0.5).astype(int) + 1, 0, self._ink.shape).T
        inked = total[x1, y1] - total[x0, y1] - total[x1, y0] + total[x0, y0]
        boxes = self._boxes[:, np.newaxis]
        apart = (low - 1 > boxes[..., 2:]) | (high + 1 < boxes[..., :2])
        met = np.count_nonzero(~apart.any(axis=-1), axis=0)
        outside = np.count_nonzero((low < 0) | (high > self._size), axis=-1)
        cost = 0.8 * reach + 0.05 * np.abs(turn) + 4 * inked + 1e3 * met + 1e4 * outside
        best = int(np.argmin(cost))
        return centre[best], float(reach[best])


_REACHES = (2.0, 4.5, 8.0, 13.0, 20.0, 30.0, 45.0)
_TURNS = (0, 20, -20, 45, -45, 70, -70, 100, -100, 135, -135, 180)


def sheet(width: float, height: float) -> Figure:
    """A figure of a size in inches, at the resolution of its file: texts are laid out once."""
    figure = Figure(figsize=(width, height), dpi=200)
    # This canvas keeps its renderer; otherwise measuring each text would create one.
    FigureCanvasAgg(figure)
    return figure


def headline(axes: Axes, title: str, text: str = "") -> None:
    """A bold title with lines of text below it, above the axes."""
    lines = text.count("\n") + 1 if text else 0
    # The height is given, since matplotlib is slow to determine it.
    axes.set_title(title, loc="left", size=9, weight="bold", y=1.0, pad=4 + 10.2 * lines)
    if text:
        place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points"}
        axes.annotate(text, (0, 1), (0, 3), size=7.5, va="bottom", linespacing=1.25, **place)


def panel(figure: Figure, left: float, bottom: float, width: float, x: Pair, y: Pair) -> View:
    """A view of equal scales, placed in inches."""
    wide, high = figure.get_size_inches()
    height = width * (y[1] - y[0]) / (x[1] - x[0])
    axes = figure.add_axes((left / wide, bottom / high, width / wide, height / high))
    axes.locator_params(nbins=int(3.5 + width))
    # Fixed, since matplotlib would measure all tick labels to determine them.
    axes.xaxis.set_label_coords(0.5, -0.25 / height)
    axes.yaxis.set_label_coords(-0.4 / width, 0.5)
    return View(axes, x, y)

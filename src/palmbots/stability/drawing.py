"""What the figures of the analysis share: views whose labels cover nothing, and one state to draw.

Figures are laid out in inches by hand, so that the scale is known before the labels are placed.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from palmbots.errors import PalmbotsError
from palmbots.geometry import SIDES, Placement, place
from palmbots.modes import MODES, Mode, states
from palmbots.stability.situation import Pair, Situation
from palmbots.style import INK, QUIET

__all__ = [
    "MM",
    "Array",
    "State",
    "View",
    "clipped",
    "headline",
    "meeting",
    "panel",
    "sheet",
    "state_of",
]

Array = NDArray[np.float64]

MM = 1e3


def clipped(polygon: ArrayLike, normal: ArrayLike, most: float) -> Array:
    """The part of a polygon where normal · point ≤ most (Sutherland and Hodgman); may be empty."""
    points = np.asarray(polygon, float).reshape(-1, 2)
    room = most - points @ np.asarray(normal, float)
    kept: list[Array] = []
    for k in range(len(points)):
        one, two = room[k - 1], room[k]
        if (one < 0) != (two < 0):
            kept.append(points[k - 1] + one / (one - two) * (points[k] - points[k - 1]))
        if two >= 0:
            kept.append(points[k])
    return np.array(kept).reshape(-1, 2)


def meeting(one: Array, way: Array, two: Array, other: Array) -> Array | None:
    """Where the lines through two points meet; None: they are parallel."""
    across = way[0] * other[1] - way[1] * other[0]
    if abs(across) < 1e-9:
        return None
    apart = two - one
    return one + way * (apart[0] * other[1] - apart[1] * other[0]) / across


class View:
    """An area of a figure in data units, with labels that keep clear of what is drawn."""

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
        self.point = abs(x[1] - x[0]) / self._size[0]  # data units of such a point
        # How often a line passes each square of one point, and the labels: x0, y0, x1, y1.
        self._ink = np.zeros(np.ceil(self._size).astype(int) + 1)
        self._boxes = np.empty((0, 4))

    def _place(self, at: ArrayLike) -> Array:
        """A place in the view in points, from its lower left corner."""
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
        """Keep labels off a mark."""
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
        """A polygon; nothing where it is empty."""
        if len(polygon) > 2:
            self.axes.fill(*polygon.T, **look)

    def ray(self, start: Array, way: Array, colour: str, width: float, ls: Any = "-") -> None:
        """A line from a point to the edge of the view and beyond."""
        reach = 2 * float(np.abs(self.corners - start).max())
        self.line(start, start + reach * way, colour=colour, width=width, ls=ls)

    def span(
        self, one: ArrayLike, two: ArrayLike, text: str, towards: ArrayLike, colour: str = INK
    ) -> None:
        """A dimension: an arrow with two heads, and its label beside the middle."""
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
        """An angle from one direction to another [rad], with its label outside the middle."""
        turns = np.linspace(start, end, 3 + int(abs(end - start) * 20))
        path = centre + radius * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
        self.line(*path, colour=colour, width=0.8)
        middle = path[len(path) // 2]
        self.label(text, middle, middle - centre, colour)

    def label(
        self, text: str, at: ArrayLike, towards: ArrayLike, colour: str = INK, size: float = 8.5
    ) -> None:
        """A text as near to a point as it fits, in a direction if possible."""
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
        if reach > 10:  # too far off to tell what it belongs to
            touch = np.clip(anchor, centre - half, centre + half)
            self.line(at, back.transform(self._origin + touch * self._unit), colour=colour)

    def caption(self, text: str, x: float, y: float) -> None:
        """A text centred just above a point, over lines, moved sideways to be in the view."""
        shown = self.axes.text(x, y + 3 * self.point, text, size=8, va="bottom", zorder=8)
        shown.set_bbox({"boxstyle": "square,pad=0.1", "fc": "white", "ec": "none"})
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
        way = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        # Each box touches the circle of its radius, whatever the direction.
        centre = anchor + way * (reach + np.abs(way) @ half)[:, np.newaxis]
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
    """A figure of so many inches, at the resolution it is saved with: texts are laid out once."""
    figure = Figure(figsize=(width, height), dpi=200)
    # A canvas that keeps its renderer: another one would be made for every text that is measured.
    FigureCanvasAgg(figure)
    return figure


def headline(axes: Axes, title: str, text: str = "") -> None:
    """A bold title with lines of text below it, above the axes."""
    lines = text.count("\n") + 1 if text else 0
    # At a given height, for matplotlib takes long to find one.
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
    # Fixed, since matplotlib would measure all tick labels to find them.
    axes.xaxis.set_label_coords(0.5, -0.25 / height)
    axes.yaxis.set_label_coords(-0.4 / width, 0.5)
    return View(axes, x, y)


@dataclass(frozen=True)
class State:
    """The left palm shallow, the right one steep, the contacts somewhere."""

    at: Situation
    p: Pair  #: contact coordinates, m
    angles: Pair
    separation: float  #: d, m
    turn: float  #: ϑ
    placed: Placement  #: one row, m
    squeeze: Array  #: I_L and I_R, (side, end)
    balances: frozenset[Mode]
    closing: Mode | None  #: what happens when the palms are driven together

    def point(self, name: str, side: int | None = None) -> Array:
        """A point or the outline, as `Placement` names it, in mm."""
        points = MM * getattr(self.placed, name)[0]
        return points if side is None else points[side]

    def along(self, side: int) -> Array:
        """u, outward along a palm."""
        return np.array([(-1, 1)[side] * math.cos(self.angles[side]), math.sin(self.angles[side])])

    def normal(self, side: int) -> Array:
        """n, from a palm towards the object."""
        return np.array([(1, -1)[side] * math.sin(self.angles[side]), math.cos(self.angles[side])])

    def edge(self, side: int, slide: int) -> Array:
        """The edge of a friction cone that the force keeps to while sliding up (1) or down (-1)."""
        lean = self.angles[side] + slide * math.atan(self.at.friction[side])
        return np.array([(1, -1)[side] * math.sin(lean), math.cos(lean)])

    @property
    def upward(self) -> Array:
        """Against the effective gravity: weight and sideways force together."""
        return np.array([self.at.slope, 1.0]) / math.hypot(self.at.slope, 1.0)


def state_of(at: Situation, p_m: Pair) -> State:
    """The state with these contact coordinates.

    Raises:
        PalmbotsError: a contact is beyond its palm, or the object does not reach across.
    """
    for side, p, half in zip(SIDES, p_m, at.half_length, strict=True):
        if not abs(p) <= half:
            raise PalmbotsError(
                f"p_m: {side} value is {p:g}; allowed: on the palm, {-half:g} to {half:g} m"
            )
    angles = at.palms("left")
    cos, sin = np.cos(angles), np.sin(angles)
    heights = np.array(p_m) * sin + np.array(at.offset) * cos
    rise = float(heights[1] - heights[0])
    if not abs(rise) < at.width:
        raise PalmbotsError(
            f"p_m: contacts at {p_m[0]:g} and {p_m[1]:g} m differ in height by {abs(rise):.3g} m; "
            f"allowed: less than the object's width, {at.width:g} m"
        )
    span = math.sqrt((at.width - rise) * (at.width + rise))
    separation = span - float(np.array(p_m) @ cos - np.array(at.offset) @ sin)
    turn = math.asin(rise / at.width)
    found = states(
        width=at.width,
        com_x=at.com[0],
        com_y=at.com[1],
        theta_left=angles[0],
        theta_right=angles[1],
        p_left=p_m[0],
        p_right=p_m[1],
        friction_left=at.friction[0],
        friction_right=at.friction[1],
        offset_left=at.offset[0],
        offset_right=at.offset[1],
        slope=at.slope,
    )
    closing = int(found.closing)
    placed = place(
        at.spec, separation=[separation], midpoint=[0.0], palm=[angles], contact=[p_m], turn=[turn]
    )
    balances = frozenset(m for m, ok in zip(MODES, found.feasible, strict=True) if ok)
    mode = MODES[closing] if closing >= 0 else None
    return State(at, p_m, angles, separation, turn, placed, found.squeeze, balances, mode)

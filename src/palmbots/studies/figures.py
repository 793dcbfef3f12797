"""The picture of a study: curves over one key, maps over two, and what can be shown of more.

| what varies | picture |
|---|---|
| one key of a grid | drop rate and contact rms over it, with 95 % bands |
| two keys | a map of each for every controller, on common colour scales |
| three or four | a map of the drop rate for every pair of keys, mean over the others |
| more, or points of another design | the drop rate over each key by itself |
| points for Sobol indices | the indices of every key |
"""

import itertools
import os
import textwrap
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from palmbots.comparison_figure import LOOK, few_ticks
from palmbots.errors import PalmbotsError
from palmbots.pictures import save_figure
from palmbots.report import counted
from palmbots.studies.axes import Axis, Span
from palmbots.studies.report import number
from palmbots.studies.run import Done
from palmbots.studies.sensitivity import METRICS, sensitivities
from palmbots.style import styled
from palmbots.units import axis_label, name_of

__all__ = ["draw", "save"]

_NAMES = {"drop_rate": "dropped [%]", "rms_m": "contact rms [mm]"}
_SCALES = {"drop_rate": 100.0, "rms_m": 1e3}
_COLOURS = "cividis"  # equal steps look equal, with every kind of colour vision
_MOST_TEXTS = 150
_BINS = 8


def draw(done: Done) -> Figure:
    """The picture that suits the study.

    Raises `PalmbotsError` where nothing varies.
    """
    keys, kind = done.points.plan.keys, done.points.plan.study.design.kind
    if not keys:
        raise PalmbotsError("--plot: nothing varies; allowed: a study with at least one key")
    with styled():
        if kind == "sobol-indices":
            return _indices(done)
        if kind == "grid" and len(keys) == 1:
            return _curves(done)
        if kind == "grid" and len(keys) == 2:
            return _maps(done)
        if kind == "grid" and len(keys) <= 4:
            return _pairs(done)
        return _alone(done)


def save(done: Done, path: str | os.PathLike[str]) -> None:
    """Write the picture (PNG, SVG or PDF by suffix), whole or not at all."""
    save_figure(path, draw(done))


def _keys(done: Done) -> tuple[str, ...]:
    return done.points.plan.keys


def _look(controller: str) -> dict[str, Any]:
    colour, marker, line = LOOK[controller]
    return {"color": colour, "marker": marker, "linestyle": line, "markersize": 4}


def _carried(done: Done) -> str:
    """How many carries a cell has."""
    counts = done.values["carries"][0]
    counts = counts[counts > 0]
    least, most = (int(f(counts)) if counts.size else 0 for f in (np.min, np.max))
    many = f"{least:,} to {most:,} carries" if least < most else f"{most:,} carries"
    return f"{many} a cell, the same seeds in all of them"


def _wrapped(figure: Figure, text: str) -> str:
    """In lines that fit into the picture."""
    return textwrap.fill(text, int(13 * figure.get_figwidth()))


def _are_numbers(levels: Sequence[Any]) -> bool:
    return all(isinstance(v, int | float) and not isinstance(v, bool) for v in levels)


def _in_order(levels: Sequence[Any]) -> list[int]:
    """Numbers ascend, whatever order they are given in; names stay."""
    rising = _are_numbers(levels)
    return sorted(range(len(levels)), key=lambda i: levels[i] if rising else i)


def _places(levels: Sequence[Any]) -> tuple[NDArray[np.float64], list[str] | None]:
    """Where the levels of a key stand on an axis; with names where they are no numbers."""
    if _are_numbers(levels):
        return np.array(levels, float), None
    return np.arange(len(levels), dtype=float), [number(v) for v in levels]


def _along(panel: Any, axis: Axis, x: NDArray[np.float64], names: list[str] | None) -> None:
    """The axis of a key: its names, or as many numbers as there is room for."""
    if names is not None:
        panel.set_xticks(x, names)
    elif isinstance(axis, Span) and axis.scale == "log":
        panel.set_xscale("log")
        panel.xaxis.set_major_locator(LogLocator(subs=(1, 3)))
        panel.xaxis.set_major_formatter(FormatStrFormatter("%g"))
        panel.xaxis.set_minor_formatter(NullFormatter())
    else:
        panel.xaxis.set_major_locator(few_ticks())


def _tick(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else number(value)


def _curves(done: Done) -> Figure:
    (key,) = done.points.plan.keys
    levels = done.points.levels(key)
    order = _in_order(levels)
    x, names = _places([levels[i] for i in order])
    figure = Figure(figsize=(7.2, 3.4), layout="constrained")
    panels = figure.subplots(1, 2)
    for c, controller in enumerate(done.points.plan.study.controllers):
        for panel, metric in zip(panels, METRICS, strict=True):
            values, ends = (v[order] if v is not None else v for v in done.values[metric])
            assert values is not None and ends is not None
            y, scale = values[:, c] * _SCALES[metric], _SCALES[metric]
            look = _look(controller)
            panel.plot(x, y, label=controller, **look)
            low, high = ends[:, c, 0] * scale, ends[:, c, 1] * scale
            panel.fill_between(x, low, high, color=look["color"], alpha=0.2, linewidth=0)
    for panel, metric in zip(panels, METRICS, strict=True):
        panel.set(xlabel=axis_label(key), ylabel=_NAMES[metric])
        panel.set_ylim(0, 1.05 * panel.get_ylim()[1])
        _along(panel, done.points.plan.study.vary[key], x, names)
    _legend(figure, panels[0], f"{_carried(done)}; bands are 95 % intervals")
    return figure


def _legend(figure: Figure, panel: Any, title: str) -> None:
    handles, labels = panel.get_legend_handles_labels()
    wrapped = "\n".join(_wrapped(figure, line) for line in title.split("\n"))
    legend = figure.legend(handles, labels, loc="outside upper center", ncols=4, title=wrapped)
    legend.get_title().set_multialignment("center")


def _maps(done: Done) -> Figure:
    controllers, shape = done.points.plan.study.controllers, done.points.shape
    rows, columns = len(METRICS), len(controllers)
    figure = Figure(figsize=(max(2.9 * columns + 1.2, 5.4), 2.7 * rows + 0.3), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for r, metric in enumerate(METRICS):
        grid = _SCALES[metric] * done.values[metric][0].reshape(*shape, columns)
        _row_of_maps(
            figure, panels[r], [grid[..., c] for c in range(columns)], _NAMES[metric], done,
            done.points.plan.keys,
        )  # fmt: skip
    for panel, controller in zip(panels[0], controllers, strict=True):
        panel.set_title(controller)
    for panel in panels[:-1].flat:
        panel.set_xlabel("")
    figure.suptitle(_wrapped(figure, _carried(done)), fontsize=7.5)
    return figure


def _row_of_maps(
    figure: Figure,
    panels: Sequence[Any],
    grids: Sequence[NDArray[np.float64]],
    name: str,
    done: Done,
    keys: Sequence[str],
) -> None:
    """Maps on one colour scale; the second key goes up, the first one to the right."""
    finite = np.concatenate([g[np.isfinite(g)] for g in grids] or [np.zeros(1)])
    top = float(finite.max()) if finite.size and finite.max() > 0 else 1.0
    levels = [done.points.levels(key) for key in keys]
    orders = [_in_order(of) for of in levels]
    image: Any = None
    for panel, given in zip(panels, grids, strict=True):
        grid = given[np.ix_(*orders)]
        panel.grid(False)
        panel.set_facecolor("#DDDDDD")
        image = panel.imshow(grid.T, origin="lower", aspect="auto", cmap=_COLOURS, vmin=0, vmax=top)
        for axis, of, order in zip((panel.xaxis, panel.yaxis), levels, orders, strict=True):
            told = [_tick(of[i]) for i in order]
            # Side by side there is room for some 36 letters, one above the other for ten names.
            room = 10 if axis is panel.yaxis else max(36 // (1 + max(map(len, told))), 1)
            step = -(-len(told) // room)
            axis.set_ticks(range(0, len(told), step), told[::step])
        panel.set_xlabel(axis_label(keys[0]))
        if grid.size <= _MOST_TEXTS:
            _texts(panel, grid, top)
    panels[0].set_ylabel(axis_label(keys[1]))
    figure.colorbar(image, ax=list(panels), label=name)


def _texts(panel: Any, grid: NDArray[np.float64], top: float) -> None:
    for (i, k), value in np.ndenumerate(grid):
        if np.isnan(value):
            panel.text(i, k, "refused", ha="center", va="center", fontsize=6)
            continue
        told = f"{value:.3g}" if value < 100 else f"{value:.0f}"
        colour = "white" if value < 0.45 * top else "black"
        panel.text(i, k, told, ha="center", va="center", fontsize=7.5, color=colour)


def _pairs(done: Done) -> Figure:
    keys, controllers = done.points.plan.keys, done.points.plan.study.controllers
    pairs = list(itertools.combinations(range(len(keys)), 2))
    columns = len(controllers)
    figure = Figure(figsize=(2.9 * columns + 1.6, 2.4 * len(pairs) + 0.4), layout="constrained")
    panels = figure.subplots(len(pairs), columns, squeeze=False)
    grid = 100 * done.values["drop_rate"][0].reshape(*done.points.shape, columns)
    for row, pair in zip(panels, pairs, strict=True):
        others = tuple(k for k in range(len(keys)) if k not in pair)
        seen = _mean(grid, others)
        _row_of_maps(
            figure, row, [seen[..., c] for c in range(columns)], _NAMES["drop_rate"], done,
            [keys[k] for k in pair],
        )  # fmt: skip
    for panel, controller in zip(panels[0], controllers, strict=True):
        panel.set_title(controller)
    told = f"{_carried(done)}; mean over the keys that a map does not show"
    figure.suptitle(_wrapped(figure, told), fontsize=7.5)
    return figure


def _mean(values: NDArray[np.float64], axes: Any) -> NDArray[np.float64]:
    """The mean of what there is: NaN only where nothing is."""
    there = np.isfinite(values)
    count = there.sum(axis=axes)
    total = np.where(there, values, 0).sum(axis=axes)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _alone(done: Done) -> Figure:
    keys, controllers = done.points.plan.keys, done.points.plan.study.controllers
    columns = min(len(keys), 3)
    rows = -(-len(keys) // columns)
    figure = Figure(figsize=(2.5 * columns + 0.4, 2.3 * rows + 0.8), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, sharey=True)
    rates = 100 * done.values["drop_rate"][0]
    for panel in panels.flat[len(keys) :]:
        panel.remove()
    for k, key in enumerate(keys):
        panel = panels.flat[k]
        x, groups, names = _groups(done.points.column(key), done.points.plan.study.vary[key])
        for c, controller in enumerate(controllers):
            each = [rates[g, c][np.isfinite(rates[g, c])] for g in groups]
            mean = np.array([np.mean(v) if v.size else np.nan for v in each])
            half = [1.96 * np.std(v, ddof=1) / np.sqrt(v.size) if v.size > 1 else 0 for v in each]
            look = _look(controller)
            panel.plot(x, mean, label=controller, **look)
            panel.fill_between(
                x, np.maximum(mean - half, 0), np.minimum(mean + half, 100), color=look["color"],
                alpha=0.2, linewidth=0,
            )  # fmt: skip
        panel.set_xlabel(axis_label(key))
        _along(panel, done.points.plan.study.vary[key], x, names)
    panels[0, 0].set_ylim(bottom=0)  # last: it ends the search for limits, which all panels share
    for row in panels:
        row[0].set_ylabel(_NAMES["drop_rate"])
    points = counted(len(done.points.values), "point")
    _legend(
        figure, panels[0, 0], f"mean over {points}, {_carried(done)};\nbands: 95 % over the points"
    )
    return figure


def _groups(
    column: Sequence[Any],
    axis: Axis,
) -> tuple[NDArray[np.float64], list[NDArray[np.intp]], list[str] | None]:
    """The points by one key: its levels, or bins with equally many points of a range."""
    if not isinstance(axis, Span):
        levels = [axis[i] for i in _in_order(axis) if axis[i] in column]
        x, names = _places(levels)
        return x, [np.array([i for i, v in enumerate(column) if v == one]) for one in levels], names
    values = np.array(column, float)
    groups = np.array_split(np.argsort(values, kind="stable"), _BINS)
    return np.array([values[g].mean() for g in groups]), groups, None


def _indices(done: Done) -> Figure:
    controllers = done.points.plan.study.controllers
    found = sensitivities(done.points, done.values)
    most = {key: max((i.total for i in found if i.key == key), default=0.0) for key in _keys(done)}
    keys = sorted(most, key=lambda key: most[key])  # bars grow upwards: the largest stands on top
    figure = Figure(figsize=(7.4, 0.42 * len(keys) + 1.6), layout="constrained")
    panels = figure.subplots(1, len(METRICS), sharey=True)
    width = 0.8 / len(controllers)
    for panel, metric in zip(panels, METRICS, strict=True):
        for c, controller in enumerate(controllers):
            mine = {i.key: i for i in found if (i.controller, i.metric) == (controller, metric)}
            if not mine:
                continue
            at = np.arange(len(keys)) + (c - (len(controllers) - 1) / 2) * width
            colour = LOOK[controller][0]
            pick: Callable[[str], list[float]] = lambda name, mine=mine: [  # noqa: E731
                getattr(mine[key], name) for key in keys
            ]
            panel.barh(
                at, pick("total"), 0.9 * width, color=colour, alpha=0.35,
                label=f"{controller}, total", xerr=pick("total_half"),
                error_kw={"elinewidth": 0.8, "capsize": 1.5},
            )  # fmt: skip
            panel.barh(
                at, np.maximum(pick("first"), 0), 0.45 * width, color=colour,
                label=f"{controller}, alone",
            )  # fmt: skip
        panel.set(xlabel="share of the variance (Sobol index)", title=_TITLES[metric])
        panel.set_xlim(left=0)
        panel.set_yticks(range(len(keys)), [name_of(key) for key in keys])
        panel.grid(axis="y", visible=False)
        if not panel.patches:
            panel.set_xlim(0, 1)
            panel.text(0.5, 0.5, "is the same everywhere", ha="center", transform=panel.transAxes)
    points = counted(len(done.points.values), "point")
    full = max(panels, key=lambda panel: len(panel.patches))
    _legend(figure, full, f"{points}, {_carried(done)}; whiskers: 95 % of the total")
    return figure


_TITLES = {"drop_rate": "drop rate", "rms_m": "contact rms"}

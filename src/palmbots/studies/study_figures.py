# SPDX-License-Identifier: Apache-2.0
"""The figure of a study: curves over one key, maps over two, and projections of more.

| what varies | figure |
|---|---|
| one key of a grid | every metric over that key, with 95 % bands |
| two keys of a grid | a map of every metric for each controller, on common colour scales |
| three or four keys of a grid | a map of the drop rate for every pair, mean over the others |
| more keys, or points of another design | the drop rate over each key |
| points for Sobol indices | the indices of every key |
"""

import itertools
import os
import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from palmbots._util.confidence_intervals import Z95
from palmbots._util.text import format_number, plural
from palmbots.errors import PalmbotsError
from palmbots.scene.key_units import name_of
from palmbots.studies.axes import Axis, Span
from palmbots.studies.sobol import METRICS, SobolIndex, sobol_indices
from palmbots.studies.study_runner import StudyResult
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import (
    COLOUR_MAP,
    ON_MAP,
    RULE,
    axis_label,
    controller_looks,
    from_zero,
    key_label,
    styled,
)
from palmbots.viz.sweep_figure import few_ticks

_MAX_LABELLED_CELLS = 150
_BINS = 8


def draw(result: StudyResult) -> Figure:
    """The figure that suits the study.

    Raises:
        PalmbotsError: nothing varies.
    """
    keys, kind = result.points.plan.keys, result.points.plan.study.design.kind
    if not keys:
        raise PalmbotsError("plot: nothing varies in this study; a figure needs at least one key")
    with styled():
        if kind == "sobol-indices":
            return _indices(result)
        if kind == "grid" and len(keys) == 1:
            return _curves(result)
        if kind == "grid" and len(keys) == 2:
            return _maps(result)
        if kind == "grid" and len(keys) <= 4:
            return _pairs(result)
        return _over_each_key(result)


def save(result: StudyResult, path: str | os.PathLike[str]) -> None:
    """Write the figure (PNG, SVG or PDF by suffix), completely or not at all."""
    write_figure(path, draw(result))


def _metric_label(metric: str) -> str:
    display = METRICS[metric]
    return axis_label(display.heading, display.unit.strip())


def _look(result: StudyResult, controller: str) -> dict[str, Any]:
    """Colour, marker and line of a controller."""
    colour, marker, line = controller_looks(result.points.plan.controller_names)[controller]
    return {"color": colour, "marker": marker, "linestyle": line, "markersize": 4}


def _sample_size(result: StudyResult) -> str:
    """How many carries a cell has."""
    counts = result.values["carries"][0]
    counts = counts[counts > 0]
    least, most = (int(f(counts)) if counts.size else 0 for f in (np.min, np.max))
    number = f"{least:,} to {most:,}" if least < most else f"{most:,}"
    return f"{number} carries per cell, same seeds in all cells"


def _wrapped(figure: Figure, text: str) -> str:
    """The text in lines that fit into the figure."""
    return textwrap.fill(text, int(13 * figure.get_figwidth()))


def _are_numbers(levels: Sequence[Any]) -> bool:
    return all(isinstance(v, int | float) and not isinstance(v, bool) for v in levels)


def _in_order(levels: Sequence[Any]) -> list[int]:
    """Order of the levels on an axis: numbers ascend, names keep their order."""
    ascend = _are_numbers(levels)
    return sorted(range(len(levels)), key=lambda i: levels[i] if ascend else i)


def _places(levels: Sequence[Any]) -> tuple[NDArray[np.float64], list[str] | None]:
    """Positions of the levels of a key on an axis, and their names unless they are numbers."""
    if _are_numbers(levels):
        return np.array(levels, float), None
    return np.arange(len(levels), dtype=float), [format_number(v) for v in levels]


def _set_axis(panel: Any, axis: Axis, x: NDArray[np.float64], names: list[str] | None) -> None:
    """Ticks of the axis of a key: its names, or a few numbers."""
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
    return f"{value:.4g}" if isinstance(value, float) else format_number(value)


def _curves(result: StudyResult) -> Figure:
    (key,) = result.points.plan.keys
    levels = result.points.levels(key)
    order = _in_order(levels)
    x, names = _places([levels[i] for i in order])
    figure = Figure(figsize=(7.2, 3.4), layout="constrained")
    panels = figure.subplots(1, len(METRICS))
    for c, controller in enumerate(result.points.plan.controller_names):
        for panel, metric in zip(panels, METRICS, strict=True):
            values, ends = result.values[metric]
            assert ends is not None
            scale = METRICS[metric].scale
            y = values[order, c] * scale
            look = _look(result, controller)
            panel.plot(x, y, label=controller, **look)
            low, high = ends[order, c, 0] * scale, ends[order, c, 1] * scale
            panel.fill_between(x, low, high, color=look["color"], alpha=0.2, linewidth=0)
    for panel, metric in zip(panels, METRICS, strict=True):
        panel.set(xlabel=key_label(key), ylabel=_metric_label(metric))
        from_zero(panel.yaxis, 1.05 * panel.get_ylim()[1])
        _set_axis(panel, result.points.plan.study.vary[key], x, names)
    _legend(figure, panels[0], f"{_sample_size(result)}; bands are 95 % intervals")
    return figure


def _legend(figure: Figure, panel: Any, title: str) -> None:
    handles, labels = panel.get_legend_handles_labels()
    columns = len(handles) if len(handles) <= 5 else 4
    wrapped = "\n".join(_wrapped(figure, line) for line in title.split("\n"))
    legend = figure.legend(
        handles, labels, loc="outside upper center", ncols=columns, title=wrapped
    )
    legend.get_title().set_multialignment("center")


def _maps(result: StudyResult) -> Figure:
    controllers, shape = result.points.plan.controller_names, result.points.shape
    rows, columns = len(METRICS), len(controllers)
    figure = Figure(figsize=(max(2.9 * columns + 1.2, 5.4), 2.7 * rows + 0.3), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for r, metric in enumerate(METRICS):
        grid = METRICS[metric].scale * result.values[metric][0].reshape(*shape, columns)
        grids = [grid[..., c] for c in range(columns)]
        label = _metric_label(metric)
        _row_of_maps(figure, panels[r], grids, label, result, result.points.plan.keys)
    for panel, controller in zip(panels[0], controllers, strict=True):
        panel.set_title(controller)
    for panel in panels[:-1].flat:
        panel.set_xlabel("")
    figure.suptitle(_wrapped(figure, _sample_size(result)), fontsize=7.5)
    return figure


def _row_of_maps(
    figure: Figure,
    panels: Sequence[Any],
    grids: Sequence[NDArray[np.float64]],
    name: str,
    result: StudyResult,
    keys: Sequence[str],
) -> None:
    """Maps on one colour scale: the first key to the right, the second one upwards."""
    finite = np.concatenate([g[np.isfinite(g)] for g in grids] or [np.zeros(1)])
    top = float(finite.max()) if finite.size and finite.max() > 0 else 1.0
    levels = [result.points.levels(key) for key in keys]
    orders = [_in_order(of) for of in levels]
    image: Any = None
    for panel, given in zip(panels, grids, strict=True):
        grid = given[np.ix_(*orders)]
        panel.grid(False)
        panel.set_facecolor(RULE)
        image = panel.imshow(
            grid.T, origin="lower", aspect="auto", cmap=COLOUR_MAP, vmin=0, vmax=top
        )
        for axis, of, order in zip((panel.xaxis, panel.yaxis), levels, orders, strict=True):
            texts = [_tick(of[i]) for i in order]
            # There is room for about 36 letters side by side, and for ten names above each other.
            limit = 10 if axis is panel.yaxis else max(36 // (1 + max(map(len, texts))), 1)
            step = -(-len(texts) // limit)
            axis.set_ticks(range(0, len(texts), step), texts[::step])
        panel.set_xlabel(key_label(keys[0]))
        if grid.size <= _MAX_LABELLED_CELLS:
            _label_cells(panel, grid, top)
    panels[0].set_ylabel(key_label(keys[1]))
    figure.colorbar(image, ax=list(panels), label=name)


def _label_cells(panel: Any, grid: NDArray[np.float64], top: float) -> None:
    for (i, k), value in np.ndenumerate(grid):
        if np.isnan(value):
            panel.text(i, k, "refused", ha="center", va="center", fontsize=6)
            continue
        text = f"{value:.3g}" if value < 100 else f"{value:.0f}"
        colour = ON_MAP["dark" if value < 0.45 * top else "light"]
        panel.text(i, k, text, ha="center", va="center", fontsize=7.5, color=colour)


def _pairs(result: StudyResult) -> Figure:
    keys, controllers = result.points.plan.keys, result.points.plan.controller_names
    pairs = list(itertools.combinations(range(len(keys)), 2))
    columns = len(controllers)
    figure = Figure(figsize=(2.9 * columns + 1.6, 2.4 * len(pairs) + 0.4), layout="constrained")
    panels = figure.subplots(len(pairs), columns, squeeze=False)
    grid = 100 * result.values["drop_rate"][0].reshape(*result.points.shape, columns)
    for row, pair in zip(panels, pairs, strict=True):
        others = tuple(k for k in range(len(keys)) if k not in pair)
        projection = _mean(grid, others)
        grids = [projection[..., c] for c in range(columns)]
        label = _metric_label("drop_rate")
        _row_of_maps(figure, row, grids, label, result, [keys[k] for k in pair])
    for panel, controller in zip(panels[0], controllers, strict=True):
        panel.set_title(controller)
    title = f"{_sample_size(result)}; mean over the other keys"
    figure.suptitle(_wrapped(figure, title), fontsize=7.5)
    return figure


def _mean(values: NDArray[np.float64], axes: Any) -> NDArray[np.float64]:
    """The mean of the finite values; NaN only where there is none."""
    is_finite = np.isfinite(values)
    count = is_finite.sum(axis=axes)
    total = np.where(is_finite, values, 0).sum(axis=axes)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _over_each_key(result: StudyResult) -> Figure:
    keys, controllers = result.points.plan.keys, result.points.plan.controller_names
    columns = min(len(keys), 3)
    rows = -(-len(keys) // columns)
    figure = Figure(figsize=(2.5 * columns + 0.4, 2.3 * rows + 0.8), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, sharey=True)
    rates = 100 * result.values["drop_rate"][0]
    for panel in panels.flat[len(keys) :]:
        panel.remove()
    for k, key in enumerate(keys):
        panel = panels.flat[k]
        x, groups, names = _groups(result.points.column(key), result.points.plan.study.vary[key])
        for c, controller in enumerate(controllers):
            each = [rates[g, c][np.isfinite(rates[g, c])] for g in groups]
            mean = np.array([np.mean(v) if v.size else np.nan for v in each])
            half = [Z95 * np.std(v, ddof=1) / np.sqrt(v.size) if v.size > 1 else 0 for v in each]
            look = _look(result, controller)
            panel.plot(x, mean, label=controller, **look)
            panel.fill_between(
                x, np.maximum(mean - half, 0), np.minimum(mean + half, 100), color=look["color"],
                alpha=0.2, linewidth=0,
            )  # fmt: skip
        panel.set_xlabel(key_label(key))
        _set_axis(panel, result.points.plan.study.vary[key], x, names)
    from_zero(
        panels[0, 0].yaxis, panels[0, 0].get_ylim()[1]
    )  # last: it fixes the limits, which all panels share
    for row in panels:
        row[0].set_ylabel(_metric_label("drop_rate"))
    points = plural(len(result.points.values), "point")
    title = f"mean over {points}, {_sample_size(result)};\nbands: 95 % intervals of that mean"
    _legend(figure, panels[0, 0], title)
    return figure


def _groups(
    column: Sequence[Any],
    axis: Axis,
) -> tuple[NDArray[np.float64], list[NDArray[np.intp]], list[str] | None]:
    """The points grouped by one key: by level, or in bins of a range with equally many points."""
    if not isinstance(axis, Span):
        levels = [axis[i] for i in _in_order(axis) if axis[i] in column]
        x, names = _places(levels)
        return x, [np.array([i for i, v in enumerate(column) if v == one]) for one in levels], names
    values = np.array(column, float)
    groups = np.array_split(np.argsort(values, kind="stable"), _BINS)
    return np.array([values[g].mean() for g in groups]), groups, None


def _indices(result: StudyResult) -> Figure:
    names = result.points.plan.controller_names
    indices = sobol_indices(result.points, result.values)
    totals = {
        key: max((i.total for i in indices if i.key == key), default=0.0)
        for key in result.points.plan.keys
    }
    keys = sorted(totals, key=lambda key: totals[key])  # from the bottom: the largest is at the top
    figure = Figure(figsize=(7.4, 0.42 * len(keys) + 1.6), layout="constrained")
    panels = figure.subplots(1, len(METRICS), sharey=True)
    width = 0.8 / len(names)
    for panel, (metric, display) in zip(panels, METRICS.items(), strict=True):
        for c, controller in enumerate(names):
            own = {i.key: i for i in indices if (i.controller, i.metric) == (controller, metric)}
            if own:
                y = np.arange(len(keys)) + (c - (len(names) - 1) / 2) * width
                colour = _look(result, controller)["color"]
                _bars(panel, y, width, [own[key] for key in keys], colour, controller)
        panel.set(xlabel="share of the variance (Sobol index)", title=display.title)
        from_zero(panel.xaxis, panel.get_xlim()[1])
        panel.set_yticks(range(len(keys)), [name_of(key) for key in keys])
        panel.grid(axis="y", visible=False)
        if not panel.patches:
            panel.set_xlim(0, 1)
            panel.text(
                0.5, 0.5, "is the same at all points", ha="center", transform=panel.transAxes
            )
    points = plural(len(result.points.values), "point")
    fullest = max(panels, key=lambda panel: len(panel.patches))
    title = f"{points}, {_sample_size(result)}; whiskers: 95 % interval of total"
    _legend(figure, fullest, title)
    return figure


def _bars(
    panel: Any,
    y: NDArray[np.floating[Any]],
    width: float,
    indices: Sequence[SobolIndex],
    colour: str,
    controller: str,
) -> None:
    """The bars of one controller: its total indices, and the first-order indices in front."""
    panel.barh(
        y, [i.total for i in indices], 0.9 * width, color=colour, alpha=0.35,
        label=f"{controller}, total", xerr=[i.total_half for i in indices],
        error_kw={"elinewidth": 0.8, "capsize": 1.5},
    )  # fmt: skip
    panel.barh(
        y, [max(i.first, 0.0) for i in indices], 0.45 * width, color=colour,
        label=f"{controller}, alone",
    )  # fmt: skip

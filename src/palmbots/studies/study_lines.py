# SPDX-License-Identifier: Apache-2.0
"""What people read of a study."""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from palmbots._util.confidence_intervals import wilson
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.text import format_number, plural
from palmbots.studies.variables import STATISTICS, Statistic

if TYPE_CHECKING:
    from palmbots.studies.study_runner import StudyResult

_MOST_ROWS = 40
_WIDTH, _GAP = 80, 2
_LISTED = 3  # refusals, and points of each


def study_lines(result: "StudyResult") -> Iterator[Item]:
    """The cells, totals, refusals, sensitivities and files of a study."""
    yield from _cells(result)
    if result.carries:
        low, high = wilson(result.drops, result.carries)
        stalls = f", {plural(result.stalls, 'carry')} stalled" if result.stalls else ""
        yield (
            f"{plural(result.carries, 'carry')}, "
            f"{100 * result.drops / result.carries:.3g} % dropped "
            f"({100 * low:.3g}–{100 * high:.3g}){stalls}"
        )
    yield from _refusals(result)
    yield from _sensitivity(result)
    if result.lost_workers:
        lost = ", ".join(result.lost_workers)
        yield (
            f"{plural(len(result.lost_workers), 'worker')} lost ({lost}); others carried their "
            "chunks"
        )
    resumed = f"   {plural(result.resumed, 'carry')} from earlier runs" if result.resumed else ""
    yield quiet(f"{result.seconds:.1f} s{resumed}   results {result.hash}")
    yield Line(f"results in {result.output}", is_whole=True)


def _cells(result: "StudyResult") -> Iterator[Item]:
    """One block per point: its values, then one row per controller."""
    plan, controllers = result.points.plan, result.points.plan.controller_names
    counts = {int(n) for n in result.values["carries"][0].flat}
    varies = len(counts) != 1
    each = "" if varies else f"{plural(counts.pop(), 'carry')} per cell; "
    yield bold(f"study {plan.name}: {each}intervals: 95 %")
    if plan.study.about:
        yield quiet(plan.study.about)
    statistics = _shown_statistics(len(controllers))
    heads = ["controller", *(["carries"] if varies else [])]
    for statistic in statistics:
        assert statistic.display is not None
        heading = statistic.display.heading.format(first=controllers[0])
        heads.append(f"{heading} [{statistic.display.unit.strip()}]")
    points = range(min(len(result.points.values), max(1, _MOST_ROWS // len(controllers))))
    blocks = [
        [_row(result, statistics, i, c, varies) for c in range(len(controllers))] for i in points
    ]
    widths = _column_widths(heads, [row for block in blocks for row in block])
    yield Table([list(map(bold, heads))], gap=_GAP, widths=widths)
    for i, block in zip(points, blocks, strict=True):
        if plan.keys:
            yield _place(result, i)
        yield Table(block, gap=_GAP, widths=widths)
    if hidden := len(result.points.values) - len(points):
        yield Line(f"{plural(hidden, 'further point')} in {result.results}", is_whole=True)


def _shown_statistics(controllers: int) -> list[Statistic]:
    """The statistics of the report; comparisons with the first controller come last."""
    shown = [
        statistic
        for statistic in STATISTICS.values()
        if statistic.display and (controllers > 1 or not statistic.is_difference)
    ]
    return sorted(shown, key=lambda statistic: statistic.is_difference)


def _row(
    result: "StudyResult", statistics: list[Statistic], i: int, c: int, with_carries: bool
) -> list[str]:
    values = result.values
    cells = [result.points.plan.controller_names[c]]
    if with_carries:
        cells.append(f"{values['carries'][0][i, c]:.0f}")
    for statistic in statistics:
        display = statistic.display
        assert display is not None
        sign = "+" if display.is_signed else ""
        is_empty = statistic.is_difference and c == 0
        cells.append("" if is_empty else _spread(values[statistic.name], i, c, display.scale, sign))
    return cells


def _column_widths(heads: list[str], rows: list[list[str]]) -> list[int]:
    """Widths that fit the window.

    Heads continue below at a blank. Where space is short, so do the cells of the last columns.
    """
    columns = list(zip(*rows, strict=True))
    least = [max(map(len, head.split())) for head in heads]
    widths = [max(n, *map(len, column)) for n, column in zip(least, columns, strict=True)]
    for k in reversed(range(1, len(columns))):
        if sum(widths) + _GAP * len(widths) <= _WIDTH:
            break
        parts = [len(part) + 1 for cell in columns[k] for part in cell.split(" (")]
        widths[k] = max(least[k], *parts)
    return widths


def _place(result: "StudyResult", point: int) -> str:
    """The values of the keys at a point."""
    pairs = zip(result.points.plan.keys, result.points.values[point], strict=True)
    return ", ".join(f"{key} = {_value(result, value)}" for key, value in pairs)


def _refusals(result: "StudyResult") -> Iterator[Item]:
    """Each reason once, with the points to which it applies."""
    names = result.points.plan.controller_names
    places: dict[tuple[int, str], list[str]] = defaultdict(list)
    for (point, controller), reason in result.points.rejected_cells.items():
        places[controller, reason].append(_place(result, point))
    for k, ((controller, reason), found) in enumerate(places.items()):
        if k == _LISTED:
            yield f"{plural(len(result.points.rejected_cells), 'cell')} refused in total"
            break
        rest = f" and {len(found) - _LISTED} more" if len(found) > _LISTED else ""
        at = f" {'; '.join(found[:_LISTED])}{rest}" if found[0] else ""
        yield f"{names[controller]} refuses{at}: {reason}"


def _sensitivity(result: "StudyResult") -> Iterator[Item]:
    """Sobol indices, grouped by metric and controller."""
    groups = defaultdict(list)
    for index in result.sensitivity:
        groups[index.metric, index.controller].append(index)
    if not groups:
        return
    yield bold("Sobol indices: share of the variance, with 95 % intervals")
    for (metric, controller), indices in sorted(groups.items()):
        rows = [
            (
                f"  {one.key}",
                f"{one.first:.3f} ± {one.first_half:.3f}",
                f"{one.total:.3f} ± {one.total_half:.3f}",
            )
            for one in sorted(indices, key=lambda index: -index.total)
        ]
        heads = ("first-order", "total")
        yield Table(rows, (f"{metric}, {controller}", *heads), right=heads)


def _value(result: "StudyResult", value: Any) -> str:
    """A value of a key; with few digits where the points were chosen at random."""
    is_random = not result.points.is_grid and isinstance(value, float)
    return f"{value:.4g}" if is_random else format_number(value)


def _spread(statistic: Any, i: int, c: int, scale: float, sign: str = "") -> str:
    """An estimate with its interval, to two digits of the interval."""
    values, ends = statistic
    if math.isnan(values[i, c]):
        return "–"
    low, high = (scale * end for end in ends[i, c])
    if math.isnan(low):  # of a single carry
        return f"{scale * values[i, c]:{sign}.1f}"
    digits = max(0, min(4, 1 - math.floor(math.log10(high - low)))) if high > low else 2
    to = " to " if sign else "–"  # a dash before a minus sign is hard to read
    return f"{scale * values[i, c]:{sign}.{digits}f} ({low:.{digits}f}{to}{high:.{digits}f})"

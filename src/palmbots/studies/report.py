"""What `palmbots study` prints for people."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from palmbots.compare import wilson
from palmbots.report import console_for_people, counted, files_written
from palmbots.studies.design import Points
from palmbots.studies.explain import Cost
from palmbots.studies.run import Done
from palmbots.studies.sensitivity import sensitivities

__all__ = ["cost_report", "number", "study_report"]

_ANY_WIDTH = 10_000  # columns: a pipe or a file has no edge at which to break or cut a line
_MOST_ROWS = 40
_QUIET = "dim"


def study_report(done: Done, written: Sequence[Path]) -> None:
    """What was carried, the cells, and where it all is."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = _ANY_WIDTH
    plan = done.points.plan
    if plan.study.about:
        console.print(plan.study.about, style=_QUIET, markup=False)
    table = _cells(done)
    widest = console.options.update(width=_ANY_WIDTH)
    console.width = max(console.width, Measurement.get(console, widest, table).maximum)
    console.print(table)
    cells = len(done.points.values) * len(plan.study.controllers)
    if cells > _MOST_ROWS:
        console.print(f"{cells - _MOST_ROWS} more cells are in {done.results}")
    if done.carries:
        low, high = wilson(done.drops, done.carries)
        console.print(
            f"{counted(done.carries, 'carry')}, {100 * done.drops / done.carries:.3g} % dropped "
            f"({100 * low:.3g}–{100 * high:.3g})" + _stalls(done)
        )
    refused = list(done.points.refused.items())
    if len(refused) > 3:
        console.print(f"resilient refused {len(refused)} points, such as")
    for point, why in refused if len(refused) <= 3 else refused[:1]:
        values = done.points.values[point]
        told = [f"{k} = {_at(done, v)}" for k, v in zip(plan.keys, values, strict=True)]
        at = f" {', '.join(told)}" if told else ""
        console.print(f"resilient refused{at}: {why}", markup=False)
    _sensitivity(console, done)
    kept = f"   {counted(done.resumed, 'carry')} had been kept" if done.resumed else ""
    console.print(f"in {done.seconds:.1f} s{kept}   results {done.hash}", style=_QUIET)
    files_written(console, written)
    console.print(f"kept in {done.output}", markup=False)


def _sensitivity(console: Console, done: Done) -> None:
    found = sensitivities(done.points, done.values)
    if not found:
        return
    table = Table(title="Sobol indices: share of the variance, with 95 % intervals")
    for head in ("controller", "metric", "key"):
        table.add_column(head, no_wrap=True)
    for head in ("alone", "total"):
        table.add_column(head, justify="right", no_wrap=True)
    last = None
    for one in sorted(found, key=lambda i: (i.metric, i.controller, -i.total)):
        group = (one.controller, one.metric)
        if last not in (None, group):
            table.add_section()
        head = group if group != last else ("", "")
        table.add_row(
            *head, one.key, f"{one.first:.3f} ± {one.first_half:.3f}",
            f"{one.total:.3f} ± {one.total_half:.3f}",
        )  # fmt: skip
        last = group
    console.print(table)


def _stalls(done: Done) -> str:
    return f", {counted(done.stalls, 'carry')} stalled" if done.stalls else ""


def _cells(done: Done) -> Table:
    plan, values = done.points.plan, done.values
    table = Table(title=f"{plan.name}: every interval is of 95 %")
    for key in plan.keys:
        table.add_column(key, justify="right", no_wrap=True)
    table.add_column("controller", no_wrap=True)
    several = len(plan.study.controllers) > 1
    heads = ["carries", "dropped", "contact rms"]
    if several:
        heads.append(f"dropped more than {plan.study.controllers[0]}")
    for head in heads:
        table.add_column(head, justify="right", no_wrap=True)
    rows = 0
    for i, point in enumerate(done.points.values):
        for c, controller in enumerate(plan.study.controllers):
            if rows == _MOST_ROWS:
                return table
            rows += 1
            told = [_at(done, v) if c == 0 else "" for v in point]
            cells = [
                f"{values['carries'][0][i, c]:.0f}",
                _spread(values["drop_rate"], i, c, 100, " %"),
                _spread(values["rms_m"], i, c, 1e3, " mm"),
            ]
            if several:
                cells.append(
                    _spread(values["drop_rate_difference"], i, c, 100, " %", "+") if c else ""
                )
            table.add_row(
                *told, controller, *cells, end_section=c + 1 == len(plan.study.controllers)
            )
    return table


def cost_report(points: Points, cost: Cost) -> None:
    """What a study will take."""
    console = console_for_people()
    plan = points.plan
    most = "at most " if plan.study.stop else ""
    rows = [
        ("points", f"{cost.points} ({_of_points(points)})"),
        ("cells", f"{cost.cells} ({', '.join(plan.study.controllers)})"),
        ("carries", f"{most}{cost.carries:,}, {plan.study.seeds.count:,} a cell"),
        ("chunks", f"{cost.chunks:,} of at most {cost.carries_a_chunk:,} carries"),
        ("time", f"{most}about {_duration(cost.seconds)} on {counted(cost.threads, 'thread')}"),
        *(("", f"{name}: {ms:.2g} ms a carry") for name, ms in cost.by_controller.items()),
        ("disk", f"{most}about {_bytes(cost.disk_bytes)}"),
        ("memory", f"about {_bytes(cost.memory_bytes)} besides Python's own"),
    ]
    if points.refused:
        rows.append(("refused", f"{counted(len(points.refused), 'point')} by the resilient one"))
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 3, 0, 0))
    for name, told in rows:
        table.add_row(name, told)
    console.print(table)


def _of_points(points: Points) -> str:
    if points.is_grid:
        sizes = zip(points.plan.keys, points.shape, strict=False)
        return " × ".join(f"{n} {key}" for key, n in sizes) or "nothing varies"
    return f"{points.plan.study.design.kind} over {counted(len(points.plan.keys), 'key')}"


def _duration(seconds: float) -> str:
    for size, unit in ((86400, "days"), (3600, "h"), (60, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.1f} {unit}"
    return f"{seconds:.1f} s"


def _bytes(n: int) -> str:
    for size, unit in ((1e9, "GB"), (1e6, "MB")):
        if n >= size:
            return f"{n / size:.1f} {unit}"
    return f"{n / 1e3:.0f} kB"


def number(value: Any) -> str:
    """A value of a key, as short as it can be."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return Text(str(value)).plain
    return short if float(short := f"{value:g}") == value else repr(value)


def _at(done: Done, value: Any) -> str:
    """A value of a key in a table; of points that were chosen at random, so many digits as help."""
    chosen = not done.points.is_grid and isinstance(value, float)
    return f"{value:.4g}" if chosen else number(value)


def _spread(of: Any, i: int, c: int, scale: float, unit: str, sign: str = "") -> str:
    values, ends = of
    if math.isnan(values[i, c]):
        return "–"
    low, high = (scale * end for end in ends[i, c])
    if math.isnan(low):  # of a single carry
        return f"{scale * values[i, c]:{sign}.1f}{unit}"
    digits = max(0, min(4, 1 - math.floor(math.log10(high - low)))) if high > low else 2
    to = " to " if sign else "–"  # a dash before a minus sign is hard to read
    return f"{scale * values[i, c]:{sign}.{digits}f}{unit} ({low:.{digits}f}{to}{high:.{digits}f})"

# SPDX-License-Identifier: Apache-2.0
"""What a result shows to people, as data: lines and tables of texts, some with a mark.

Python prints this as text, a notebook as HTML, a terminal in colours (`palmbots.cli.console`). A
quantity takes its unit from the end of its name, as in ``time_s``.
"""

import html
import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

from palmbots._types import BySide
from palmbots._util.text import data_size, format_number, millimetres

Mark = Literal["", "bold", "good", "bad", "warning", "quiet"]


class Marked(str):
    """A text with a mark, which a terminal shows as a colour."""

    mark: Mark = ""


def _marked(text: str, mark: Mark) -> Marked:
    found = Marked(text)
    found.mark = mark
    return found


def bold(text: str) -> Marked:
    """A text that matters."""
    return _marked(text, "bold")


def good(text: str) -> Marked:
    """A text that says that something holds."""
    return _marked(text, "good")


def bad(text: str) -> Marked:
    """A text that says that something does not hold."""
    return _marked(text, "bad")


def quiet(text: str) -> Marked:
    """A text for those who look closely."""
    return _marked(text, "quiet")


def verdict(is_good: bool, yes: str, no: str) -> Marked:
    """The first word of a report."""
    return good(yes) if is_good else bad(no)


@dataclass(frozen=True, init=False)
class Line:
    """A line of texts."""

    parts: tuple[str, ...]
    indent: int
    """Columns by which the line, and what continues it, is moved to the right."""
    is_whole: bool
    """Whether the line is never broken, so that it can be copied."""

    def __init__(self, *parts: str, indent: int = 0, is_whole: bool = False) -> None:
        object.__setattr__(self, "parts", parts)
        object.__setattr__(self, "indent", indent)
        object.__setattr__(self, "is_whole", is_whole)

    def __str__(self) -> str:
        return " " * self.indent + "".join(self.parts)


def warn_word(text: str) -> Marked:
    """A text that says that something is open, or may be wrong."""
    return _marked(text, "warning")


def warning(text: str) -> Line:
    """The line of a warning."""
    return Line(warn_word("warning: "), text)


def written_file(path: Path) -> Line:
    """The line on a file that was written, or on a folder, with its size."""
    files = [path, *path.rglob("*")] if path.is_dir() else [path]
    size = sum(file.stat().st_size for file in files if file.is_file())
    return Line(f"wrote {path}  {data_size(size)}", is_whole=True)


@dataclass(frozen=True)
class Table:
    """Rows of cells, with or without heads."""

    rows: Sequence[Sequence[str]]
    heads: Sequence[str] = ()
    right: Collection[str] = ()
    """The heads of the columns that are aligned to the right."""
    gap: int = 3
    """Columns between two columns of the table."""
    title: str = ""
    widths: Sequence[int] = ()
    """Of the columns, all but the first to the right; cells continue below. Empty: what fits."""


Item: TypeAlias = str | Line | Table


def as_text(items: Iterable[Item], most_rows: int = 12) -> str:
    """Lines and tables as plain text; a table with more rows is cut."""
    lines: list[str] = []
    for item in items:
        lines += _text_rows(item, most_rows) if isinstance(item, Table) else [str(item)]
    return "\n".join(line.rstrip() for line in lines)


def _text_rows(table: Table, most_rows: int) -> list[str]:
    rows = [list(row) for row in table.rows[:most_rows]]
    if table.heads:
        rows.insert(0, [head.replace("\n", " ") for head in table.heads])
    count = max(map(len, rows), default=0)
    widths = table.widths or [
        max(len(row[k]) for row in rows if k < len(row)) for k in range(count)
    ]
    to_right = [
        k > 0 if table.widths else k < len(table.heads) and table.heads[k] in table.right
        for k in range(count)
    ]
    lines = [table.title] if table.title else []
    for row in rows:
        cells = (
            f"{cell:>{width}}" if right else f"{cell:<{width}}"
            for cell, width, right in zip(row, widths, to_right, strict=False)
        )
        lines.append((" " * table.gap).join(cells))
    hidden = len(table.rows) - most_rows
    return [*lines, f"… and {hidden} more"] if hidden > 0 else lines


def as_html(items: Iterable[Item]) -> str:
    """Lines and tables as HTML."""
    found = []
    for item in items:
        if isinstance(item, Table):
            rows = [f"<tr>{''.join(_cell('td', cell) for cell in row)}</tr>" for row in item.rows]
            if item.heads:
                heads = "".join(_cell("th", head) for head in item.heads)
                rows.insert(0, f"<tr>{heads}</tr>")
            found.append(f"<table>{''.join(rows)}</table>")
        else:
            indent = item.indent if isinstance(item, Line) else 0
            text = html.escape(str(item).strip())
            weight = "" if found else ";font-weight:bold"
            found.append(f"<div style='margin-left:{indent}ch{weight}'>{text}</div>")
    return "".join(found)


def _cell(kind: str, text: str) -> str:
    return f"<{kind} style='text-align:left'>{html.escape(text)}</{kind}>"


# What a name ends in, its unit, the factor to the unit in which people read it, and that unit;
# longer ends come first.
_UNITS = (
    ("bytes_per_s", "B/s", 1.0, " B/s"),
    ("_m_per_sqrt_s", "m/√s", 100.0, " cm/√s"),
    ("_m_s2", "m/s²", 1.0, " m/s²"),
    ("_m_s", "m/s", 100.0, " cm/s"),
    ("_per_m", "1/m", 1.0, " per m"),
    ("_per_s", "1/s", 1.0, " per s"),
    ("_deg", "°", 1.0, "°"),
    ("_rad", "rad", 180 / math.pi, "°"),
    ("_m", "m", 1.0, " m"),
    ("_s", "s", 1.0, " s"),
)


def unit_of(name: str) -> str:
    """The unit of a quantity, from the end of its name; 1 for a number of its own."""
    return next((unit for end, unit, _, _ in _UNITS if name.endswith(end)), "1")


def label_of(name: str) -> str:
    """The name of a quantity as people read it, without its unit."""
    for end, *_ in _UNITS:
        if name.endswith(end) and len(name) > len(end):
            name = name.removesuffix(end)
            break
    return name.replace("_", " ")


def quantity(name: str, value: Any) -> str | None:
    """A value as people read it, with the unit from its name; None: it is no short value."""
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    if isinstance(value, BySide):
        parts = [(side, quantity(name, one)) for side, one in value.items()]
        return ", ".join(f"{side} {text}" for side, text in parts) if parts[0][1] else None
    if isinstance(value, tuple) and len(value) == 2 and all(isinstance(v, float) for v in value):
        return " to ".join(_number(name, end) for end in value)
    return _number(name, value) if isinstance(value, int | float) else None


def _number(name: str, value: float) -> str:
    if isinstance(value, int):
        return f"{value:,}"
    for end, _, factor, unit in _UNITS:
        if name.endswith(end):
            return length(value) if end == "_m" else f"{factor * value:.4g}{unit}"
    return format_number(float(f"{value:.4g}"))


def length(metres: float) -> str:
    """A length: 1.50 m, or 12.3 mm."""
    return f"{metres:.2f} m" if abs(metres) >= 1 else millimetres(metres)

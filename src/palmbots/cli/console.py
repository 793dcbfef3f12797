# SPDX-License-Identifier: Apache-2.0
"""The console of all reports: no trailing blanks, common styles and texts, 80 columns in a pipe."""

import re
import sys
from collections.abc import Collection, Iterable
from typing import Any, TextIO, cast

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from palmbots._util.report import Item, Line, Mark, Marked, quiet
from palmbots._util.report import Table as TableOfTexts
from palmbots.cli._streams import WIDTH, text_width
from palmbots.cli._warnings import print_held_warnings

GOOD, BAD, QUIET = "bold green", "bold red", "dim"
_STYLES: dict[Mark, str] = {
    "": "default", "bold": "bold", "good": GOOD, "bad": BAD, "warning": "bold yellow",
    "quiet": QUIET,
}  # fmt: skip
_TRAILING_BLANKS = re.compile(r" +((?:\x1b\[[0-9;]*m)*)$", re.MULTILINE)


class _TrimmedStream:
    """A text stream that removes blanks at the ends of lines, which tables are padded with."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return self._stream.write(_TRAILING_BLANKS.sub(r"\1", text))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def report_console() -> Console:
    """A console on stdout; warnings that are held are printed before it.

    It is 80 columns wide in a pipe and as wide as the window in a terminal, but not narrower than
    80 columns: a terminal may break lines, but no table shortens numbers to fit. Running text is
    narrower where the variable COLUMNS asks for it. Markup is off, because units are written in
    brackets.
    """
    print_held_warnings()
    console = Console(
        highlight=False, markup=False, file=cast("TextIO", _TrimmedStream(sys.stdout))
    )
    console.width = max(console.width, WIDTH) if console.is_terminal else WIDTH
    return console


def print_report(items: Iterable[Item], about: str = "", console: Console | None = None) -> None:
    """Print the lines of a result.

    Args:
        items: the lines.
        about: of what the result is, such as the name of a scene.
        console: where to print, as wide as it is; None: on stdout.
    """
    width = console.width if console else None
    console = console or report_console()
    width = width or text_width(console.width)
    for item in _about(list(items), about, width) if about else items:
        if isinstance(item, TableOfTexts):
            console.print(_table(item))
            continue
        line = item if isinstance(item, Line) else Line(item)
        text = Text().join(map(_text, line.parts))
        if line.is_whole:
            console.print(Text(" " * line.indent).append_text(text), soft_wrap=True)
        else:
            console.print(indented(text, line.indent), width=width)


def _about(items: list[Item], about: str, width: int) -> list[Item]:
    """The lines, the first quiet text of the first two with what the result is about before it.

    If there is none, it follows the first line; a long one leaves it a line of its own.
    """
    for k, item in enumerate(items[:2]):
        line = Line(item) if isinstance(item, str) else item
        if isinstance(line, TableOfTexts) or line.indent:
            continue
        parts = list(line.parts)
        for n, part in enumerate(parts):
            if isinstance(part, Marked) and part.mark == "quiet":
                blanks = " " * (len(part) - len(part.lstrip()))
                parts[n] = quiet(f"{blanks}{about}, {part.lstrip()}")
                return [*items[:k], Line(*parts), *items[k + 1 :]]
    head = items[0] if isinstance(items[0], Line) else Line(str(items[0]))
    if len(str(head)) > WIDTH // 2 and len(str(head)) + 2 + len(about) > width:
        return [head, Line(quiet(about), is_whole=True), *items[1:]]
    return [Line(*head.parts, f"  {about}", is_whole=True), *items[1:]]


def _text(part: str) -> Text:
    mark = part.mark if isinstance(part, Marked) else ""
    return Text(part, style=_STYLES[mark])


def _table(table: TableOfTexts) -> Table:
    shown = plain_table(*table.heads, right=table.right, gap=table.gap)
    if table.title:
        shown.title, shown.title_style, shown.title_justify = table.title, "bold", "left"
    if not table.heads:
        for k in range(max(map(len, table.rows), default=0)):
            width = table.widths[k] if table.widths else None
            shown.add_column(
                justify="right" if k and width else "left",
                width=width,
                no_wrap=k == 0 and not width,
                overflow="fold",
            )
    for row in table.rows:
        shown.add_row(*map(_text, row))
    return shown


def plain_table(*heads: str, right: Collection[str] = (), gap: int = 3) -> Table:
    """A table without lines; columns in `right` are aligned to the right."""
    table = Table(
        box=None,
        show_header=bool(heads),
        header_style="bold",
        pad_edge=False,
        padding=(0, gap, 0, 0),
    )
    for head in heads:
        table.add_column(Text(head), justify="right" if head in right else "left", overflow="fold")
    return table


def indented(text: str | Text, columns: int = 2) -> Padding:
    """A text whose lines are all indented, also those that result from wrapping."""
    return Padding(text if isinstance(text, Text) else Text(text), (0, 0, 0, columns))

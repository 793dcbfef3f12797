# SPDX-License-Identifier: Apache-2.0
"""What all results have in common: lines for people, a table for JSON, a figure."""

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from pkgutil import resolve_name
from typing import Any, ClassVar

from palmbots._util.arguments import one_of
from palmbots._util.named_registry import Registry
from palmbots._util.plain_values import keys_of, plain
from palmbots._util.report import Item, Table, as_html, as_text, label_of, quantity, written_file
from palmbots.errors import PalmbotsError

FIGURES: Registry[Callable[..., Any]] = Registry("figure")
"""Functions that draw a result, by the name of the figure: result → `matplotlib.figure.Figure`."""

WRITERS: Registry[Callable[..., None]] = Registry("writer")
"""Functions that write files, by what they write. ``figure``: path, figure → None."""


class Result:
    """Base of all results. A subclass is a frozen dataclass with ``repr=False``.

    JSON has its fields and its `derived` properties (`palmbots._util.plain_values`); people read
    its `lines`. Results are equal if they are of one kind and have the same JSON; they can be
    elements of sets, pickled and copied.
    """

    figure: ClassVar[str | None] = None
    """Name of the figure in `FIGURES` that `plot` draws; None: there is no figure."""
    more_figures: ClassVar[tuple[str, ...]] = ()
    """Names of the other figures in `FIGURES` that `plot` draws on request."""
    lines_of: ClassVar[str | None] = None
    """``module:function`` that yields the `lines` of this kind of result; None: it has no module
    of its own for them."""

    def __init_subclass__(cls) -> None:
        """Keep `dataclass` from comparing fields, which may be arrays, and from hashing them."""
        cls.__eq__, cls.__hash__ = Result.__eq__, Result.__hash__

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Result) or type(self) is not type(other):
            return NotImplemented
        return self.summary() == other.summary()

    def __hash__(self) -> int:
        return hash(json.dumps(self.summary(), sort_keys=True))

    def lines(self) -> Iterator[Item]:
        """What people read, in Python, in notebooks and in a terminal.

        The first line states the result. Unless a kind of result has lines of its own, a table of
        its short values follows.
        """
        if self.lines_of is not None:
            return resolve_name(self.lines_of)(self)
        return iter((type(self).__name__, Table(self.value_rows())))

    def value_rows(self, *names: str) -> list[tuple[str, str]]:
        """Short values with their labels and units.

        Args:
            names: of the fields; none: all that JSON has.
        """
        shown = names or keys_of(type(self))
        texts = [(name, quantity(name, getattr(self, name))) for name in shown]
        return [(f"  {label_of(name)}", text) for name, text in texts if text is not None]

    def headline(self) -> str:
        """The line that states the result."""
        return as_text(self.lines()).partition("\n")[0]

    def __repr__(self) -> str:
        return as_text(self.lines())

    def _repr_html_(self) -> str:
        return as_html(self.lines())

    def summary(self) -> dict[str, Any]:
        """What the command prints with ``--json``."""
        return plain(self)

    def plot(self, figure: str | None = None, **options: Any) -> Any:
        """Draw the result.

        Args:
            figure: the name of a figure of this kind of result; None: its main figure.
            options: options of that figure.

        Returns:
            The `matplotlib.figure.Figure`; save it with its ``savefig``.

        Raises:
            PalmbotsError: this kind of result has no figure, or none of that name.
        """
        if self.figure is None:
            raise PalmbotsError(f"plot: there is no figure of a {type(self).__name__}")
        name = self.figure if figure is None else figure
        one_of("figure", name, (self.figure, *self.more_figures))
        return FIGURES.get(name)(self, **options)

    def save_figure(
        self, path: str | os.PathLike[str], figure: str | None = None, **options: Any
    ) -> None:
        """Draw the result and write it as PNG, SVG or PDF, by the suffix of the path.

        The file appears only when it is complete.

        Raises:
            PalmbotsError: this kind of result has no such figure, or the file cannot be written.
        """
        WRITERS.get("figure")(path, self.plot(figure, **options))


@dataclass(frozen=True, repr=False)
class Files(Result):
    """Files that were written."""

    files: tuple[Path, ...]

    def lines(self) -> Iterator[Item]:
        """Their names and sizes."""
        yield from map(written_file, self.files)

# SPDX-License-Identifier: Apache-2.0
"""What all results have in common: a short text, a table for notebooks, a figure."""

import html
import os
from collections.abc import Callable
from typing import Any

from palmbots._util.arguments import one_of
from palmbots._util.named_registry import Registry
from palmbots.errors import PalmbotsError

FIGURES: Registry[Callable[..., Any]] = Registry("figure")
"""Functions that draw a result, by the name of the figure: result → `matplotlib.figure.Figure`."""

WRITERS: Registry[Callable[..., None]] = Registry("writer")
"""Functions that write files, by what they write. ``figure``: path, figure → None."""

_MOST_LINES = 10


class Result:
    """Base of all results. A subclass is a dataclass with ``repr=False``."""

    figure: str | None = None
    """Name of the figure in `FIGURES` that `plot` draws; None: there is no figure."""
    more_figures: tuple[str, ...] = ()
    """Names of the other figures in `FIGURES` that `plot` draws on request."""

    def headline(self) -> str:
        """One line that states the result."""
        return type(self).__name__

    def facts(self) -> dict[str, str]:
        """The main figures, each with its unit, by name; at most nine."""
        return {}

    def __repr__(self) -> str:
        facts = list(self.facts().items())[: _MOST_LINES - 1]
        width = max((len(name) for name, _ in facts), default=0)
        return "\n".join([self.headline(), *(f"  {n:<{width}}  {text}" for n, text in facts)])

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
            f"<td style='text-align:left'>{html.escape(text)}</td></tr>"
            for name, text in self.facts().items()
        )
        return f"<table><caption>{html.escape(self.headline())}</caption>{rows}</table>"

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

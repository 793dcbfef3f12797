# SPDX-License-Identifier: Apache-2.0
"""An assessment as one page with its pictures, in HTML or PDF, which needs no other file."""

from __future__ import annotations

import base64
import html
import io
import os
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots._util.atomic_files import check_suffix, write_whole
from palmbots._util.command import Option, writes
from palmbots._util.report import Item, Table, as_text
from palmbots.assessment.answer import WORDS
from palmbots.assessment.assess import Assessment

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STYLE = """
body { max-width: 52rem; margin: 2rem auto; padding: 0 1rem; font: 16px/1.45 sans-serif; }
table { border-collapse: collapse; margin: .4rem 0; }
th, td { padding: .1rem 1rem .1rem 0; text-align: left; }
p { margin: .2rem 0; } h2 { margin: 1.4rem 0 .2rem; font-size: 1.15rem; }
img { max-width: 100%; margin: .6rem 0; } code { color: #555; }
@media print { h2, table, img { break-inside: avoid; } }
"""
_COLOURS = {
    "yes": "#00694f", "likely": "#00694f", "partly": "#7a5200", "no": "#a33c00", "open": "#555555"
}  # fmt: skip


SUFFIXES = (".html", ".pdf")
_WIDTH_IN, _MARGIN_IN, _LINE_IN, _COLUMNS = 8.27, 0.6, 0.17, 98


@writes("assess", path=Option("--out -o", metavar="FILE", suffixes=(".html", ".pdf")))
def write_page(assessment: Assessment, path: str | os.PathLike[str]) -> list[Path]:
    """Write the page.

    Args:
        assessment: of the scene.
        path: write one page with pictures to this file, which ends in .html or .pdf.

    Raises:
        PalmbotsError: the file cannot be written, or has another suffix.
    """
    if check_suffix(path, SUFFIXES) == ".pdf":
        from palmbots.viz.save_figure import write_figure

        write_figure(path, _sheet(assessment))
    else:
        write_whole(path, "\n".join(_page(assessment)) + "\n")
    return [Path(path)]


def _sheet(assessment: Assessment) -> Figure:
    """The page as one figure, as tall as it has to be."""
    from matplotlib.figure import Figure
    from matplotlib.image import imread

    from palmbots.viz.style import styled

    lines = [*_text(assessment)]
    figures = [*_outcomes(assessment), assessment.analysis.plot()]
    pictures = [imread(io.BytesIO(_png(figure, 200))) for figure in figures]
    wide = _WIDTH_IN - 2 * _MARGIN_IN
    heights = [wide * picture.shape[0] / picture.shape[1] for picture in pictures]
    tall = 2 * _MARGIN_IN + _LINE_IN * len(lines) + sum(heights)
    with styled():
        figure = Figure(figsize=(_WIDTH_IN, tall))
        level = tall - _MARGIN_IN
        for text, style in lines:
            x, y = _MARGIN_IN / _WIDTH_IN, level / tall
            look: dict[str, Any] = {"size": 8, **style}
            figure.text(x, y, text.replace("$", r"\$"), va="top", **look)
            level -= _LINE_IN
        for picture, height in zip(pictures, heights, strict=True):
            level -= height
            box = (_MARGIN_IN / _WIDTH_IN, level / tall, wide / _WIDTH_IN, height / tall)
            axes = figure.add_axes(box)
            axes.imshow(picture, interpolation="none", aspect="auto")
            axes.set_axis_off()
        return figure


def _text(assessment: Assessment) -> Iterator[tuple[str, dict[str, Any]]]:
    """The lines of the sheet with their looks."""
    bold: dict[str, Any] = {"weight": "bold"}
    quiet: dict[str, Any] = {"color": "#555555", "family": "monospace", "size": 7}
    yield assessment.scene.spelled, bold
    headline = f"{WORDS[assessment.verdict]}: {assessment.conclusion}"
    looks = bold | {"color": _COLOURS[assessment.verdict]}
    yield from ((line, looks) for line in textwrap.wrap(headline, _COLUMNS))
    for answer, table in assessment.paragraphs():
        yield "", {}
        yield answer.question, bold
        yield answer.word, bold | {"color": _COLOURS[answer.verdict]}
        yield from ((line, {}) for line in textwrap.wrap(answer.text, _COLUMNS))
        if table is not None:
            yield from ((line, quiet) for line in as_text([table]).splitlines())
        yield from ((line, quiet) for line in textwrap.wrap(answer.command, _COLUMNS))


def _page(assessment: Assessment) -> Iterator[str]:
    name = html.escape(assessment.scene.spelled)
    yield f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{name}</title>'
    colours = "".join(f".{verdict} {{ color: {hue}; }}\n" for verdict, hue in _COLOURS.items())
    yield f"<style>{_STYLE}{colours}</style>"
    yield f"<h1>{name}</h1>"
    verdict = assessment.verdict
    headline = html.escape(f"{WORDS[verdict]}: {assessment.conclusion}")
    yield f'<p><strong class="{verdict}">{headline}</strong></p>'
    for figure in _outcomes(assessment):
        yield _image(figure, "how often each controller fails")
    for answer, table in assessment.paragraphs():
        yield f"<h2>{html.escape(answer.question)}</h2>"
        word = html.escape(answer.word)
        yield f'<p><strong class="{answer.verdict}">{word}</strong> {html.escape(answer.text)}</p>'
        yield from (_table(table) for table in [table] if table is not None)
        yield f"<p><code>{html.escape(answer.command)}</code></p>"
    yield "<h2>Contacts at which each property holds, on the whole palms</h2>"
    yield _image(assessment.analysis.plot(), "the contacts at which the object is held")
    yield "</html>"


def _table(item: Item) -> str:
    assert isinstance(item, Table)
    cells = [("th", item.heads)] if item.heads else []
    rows = [*cells, *(("td", row) for row in item.rows)]
    lines = []
    for kind, row in rows:
        parts = (f"<{kind}>{html.escape(cell.strip())}</{kind}>" for cell in row)
        lines.append(f"<tr>{''.join(parts)}</tr>")
    return "\n".join(["<table>", *lines, "</table>"])


def _png(figure: Figure, dpi: int) -> bytes:
    from palmbots.viz.style import styled

    stream = io.BytesIO()
    with styled():
        figure.savefig(stream, format="png", dpi=dpi, metadata={"Software": None})
    return stream.getvalue()


def _image(figure: Figure, text: str) -> str:
    data = base64.b64encode(_png(figure, 110)).decode()
    return f'<img alt="{html.escape(text)}" src="data:image/png;base64,{data}">'


def _outcomes(assessment: Assessment) -> Iterator[Figure]:
    """Failures of each controller, with intervals; nothing where no carry can begin."""
    from matplotlib.figure import Figure

    from palmbots.viz.style import axis_label, controller_looks, from_zero, styled

    counts = assessment.counts
    if not counts:
        return
    with styled():
        figure = Figure(figsize=(6.3, 0.6 + 0.32 * len(counts)), layout="constrained")
        axes = figure.subplots()
        looks = controller_looks(one.controller for one in counts)
        for k, one in enumerate(counts):
            low, high = (100 * end for end in one.failure_interval)
            colour, marker, _ = looks[one.controller]
            rate = 100 * one.failure_rate
            axes.plot([low, high], [k, k], color=colour)
            axes.plot(rate, k, marker=marker, color=colour, clip_on=False)
        axes.set_yticks(range(len(counts)), [one.controller for one in counts])
        axes.invert_yaxis()
        from_zero(axes.xaxis, max(100 * one.failure_interval[1] for one in counts) * 1.05)
        axes.set_xlabel(axis_label("carries that fail, with 95 % intervals", "%"))
    yield figure

# SPDX-License-Identifier: Apache-2.0
"""An assessment as one HTML page with its pictures, which needs no other file."""

from __future__ import annotations

import base64
import html
import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots._util.atomic_files import write_whole
from palmbots._util.command import Option, writes
from palmbots._util.report import Item, Table
from palmbots.assessment.assess import Assessment

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STYLE = """
body { max-width: 52rem; margin: 2rem auto; padding: 0 1rem; font: 16px/1.45 sans-serif; }
table { border-collapse: collapse; margin: .4rem 0; }
th, td { padding: .1rem 1rem .1rem 0; text-align: left; }
p { margin: .2rem 0; } h2 { margin: 1.4rem 0 .2rem; font-size: 1.15rem; }
img { max-width: 100%; margin: .6rem 0; } code, .open { color: #555; }
.yes, .likely { color: #00694f; } .partly { color: #7a5200; } .no { color: #a33c00; }
@media print { h2, table, img { break-inside: avoid; } }
"""


@writes("assess", path=Option("--out -o", metavar="FILE"))
def write_page(assessment: Assessment, path: str | os.PathLike[str]) -> list[Path]:
    """Write the page.

    Args:
        assessment: of the scene.
        path: write one HTML page with pictures to this file.

    Raises:
        PalmbotsError: the file cannot be written.
    """
    write_whole(path, "\n".join(_page(assessment)) + "\n")
    return [Path(path)]


def _page(assessment: Assessment) -> Iterator[str]:
    name = html.escape(assessment.scene.spelled)
    yield f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{name}</title>'
    yield f"<style>{_STYLE}</style>"
    yield f"<h1>{name}</h1>"
    conclusion = html.escape(assessment.conclusion)
    yield f'<p><strong class="{assessment.verdict}">{conclusion}</strong></p>'
    yield _image(_outcomes(assessment), "how often each controller fails")
    for answer, table in assessment.paragraphs():
        yield f"<h2>{html.escape(answer.question)}</h2>"
        word = html.escape(answer.word)
        yield f'<p><strong class="{answer.verdict}">{word}</strong> {html.escape(answer.text)}</p>'
        yield from (_table(table) for table in [table] if table is not None)
        yield f"<p><code>{html.escape(answer.command)}</code></p>"
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


def _image(figure: Figure, text: str) -> str:
    from palmbots.viz.style import styled

    stream = io.BytesIO()
    with styled():
        figure.savefig(stream, format="png", dpi=110, metadata={"Software": None})
    data = base64.b64encode(stream.getvalue()).decode()
    return f'<img alt="{html.escape(text)}" src="data:image/png;base64,{data}">'


def _outcomes(assessment: Assessment) -> Any:
    """Failures of each controller, with intervals."""
    from matplotlib.figure import Figure

    from palmbots.viz.style import axis_label, controller_looks, styled

    with styled():
        counts = assessment.counts
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
        axes.set_xlim(0, max(100 * one.failure_interval[1] for one in counts) * 1.05)
        axes.set_xlabel(axis_label("carries that fail, with 95 % intervals", "%"))
        return figure

# SPDX-License-Identifier: Apache-2.0
"""Mermaid diagrams of the book, drawn by Graphviz when the site is built.

Forges draw them with JavaScript. The site shows them without any. Understood is what the generated
parts of the book use: arrows with labels, and names of states.
"""

import json
import re
from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.ext.graphviz import graphviz

_ARROW = re.compile(r"(\[\*\]|\w+)\s*-->\s*(\w+)(?:\s*:\s*(.+))?")
_NAME = re.compile(r"(\w+)\s*:\s*(.+)")
_LINE_LENGTH = 24  # characters of a label


def dot_source(text: str) -> str:
    """A Mermaid diagram in the language of Graphviz.

    Raises:
        ValueError: a line is not understood.
    """
    first, *lines = [line.strip() for line in text.splitlines() if line.strip()]
    if first not in ("graph TD", "stateDiagram-v2"):
        raise ValueError(f"diagram: unknown kind {first!r}")
    body = []
    for line in lines:
        if arrow := _ARROW.fullmatch(line):
            start, end, label = arrow.groups()
            if start == "[*]":
                body.append('"[*]" [shape=point width=0.12]')
            body.append(f"{json.dumps(start)} -> {json.dumps(end)} [label={_label(label or '')}]")
        elif name := _NAME.fullmatch(line):
            body.append(f"{json.dumps(name[1])} [label={_label(name[2])}]")
        else:
            raise ValueError(f"diagram: not understood: {line!r}")
    head = (
        'bgcolor=transparent; node [shape=box style="rounded,filled" fillcolor="#f4f6f8" '
        'color="#6b7785" fontname="sans-serif" fontsize=12 margin="0.12,0.06"]; '
        'edge [color="#6b7785" fontname="sans-serif" fontsize=10 fontcolor="#3c4650"];'
    )
    return f"digraph {{ {head} " + "; ".join(body) + " }"


def _label(text: str) -> str:
    """The text in lines of moderate length."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + len(word) >= _LINE_LENGTH:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return json.dumps("\n".join(lines), ensure_ascii=False)


class Mermaid(Directive):
    """A diagram."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The drawing."""
        drawing = graphviz()
        drawing["code"] = dot_source("\n".join(self.content))
        drawing["options"] = {"docname": self.state.document.settings.env.docname}
        drawing["alt"] = "diagram: " + "; ".join(line.strip() for line in self.content[1:6])
        return [drawing]


def setup(app: Any) -> dict[str, bool]:
    """Register the directive."""
    app.setup_extension("sphinx.ext.graphviz")
    app.add_directive("mermaid", Mermaid)
    return {"parallel_read_safe": True}

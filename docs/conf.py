# SPDX-License-Identifier: Apache-2.0
"""Sphinx: the book as a site (`make book`)."""

import re
import shutil
import sys
import tomllib
from pathlib import Path
from typing import Any

from sphinx.errors import SphinxError

_ROOT = Path(__file__).resolve().parents[1]
_PROJECT = tomllib.loads((_ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

project = "palmbots"
author = copyright = "the palmbots authors"
version = release = _PROJECT["version"]

sys.path.insert(0, str(Path(__file__).parent / "_ext"))
import made_pages  # noqa: E402

extensions = [
    "myst_nb",
    "mermaid_diagrams",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
]
root_doc = "README"
exclude_patterns = ["style", "_ext", "_templates", "_static"]
graphviz_output_format = "svg"

# Docstrings: `name` is code, and types are in the text where they matter.
default_role = "code"
autodoc_typehints = "none"
autodoc_default_options = {"exclude-members": "model_config"}

# Markdown as on a forge: headings have anchors.
myst_heading_anchors = 3
myst_fence_as_directive = ["mermaid"]
myst_enable_extensions = ["colon_fence", "deflist"]

# Notebooks run anew in every build, and a cell that fails ends it.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_execution_in_temp = True
nb_merge_streams = True

html_theme = "furo"
html_title = "palmbots"
html_show_sphinx = False
html_copy_source = False
html_theme_options = {"footer_icons": []}
templates_path = ["_templates"]
html_static_path = ["_static"]
html_css_files = ["page_link.css"]
html_sidebars = {
    "**": [
        "sidebar/brand.html",
        "sidebar/search.html",
        "page_link.html",
        "sidebar/scroll-start.html",
        "sidebar/navigation.html",
        "sidebar/scroll-end.html",
    ]
}


def _contents(text: str) -> str:
    """The tables of contents: one for each bold heading of the first page, with its links."""
    parts = re.split(r"^\*\*(.+)\*\*$", text, flags=re.MULTILINE)
    tables = []
    for caption, body in zip(parts[1::2], parts[2::2], strict=True):
        pages = [page for page in re.findall(r"\]\(([^)#]+)\.md\)", body) if "../" not in page]
        tables.append(
            f"```{{toctree}}\n:hidden:\n:caption: {caption}\n\n" + "\n".join(pages) + "\n```\n"
        )
    return "\n".join(tables)


def _complete(_: object, name: str, source: list[str]) -> None:
    """Append to three pages what the build makes."""
    if name == root_doc:
        source[0] += "\n" + _contents(source[0])
    elif name == "reference/cli":
        source[0] += "\n" + made_pages.command_line()
    elif name == "reference/api":
        source[0] += "\n" + made_pages.public_names()


def _without_defaults(_app: object, kind: str, *rest: Any) -> tuple[str, str] | None:
    """No signature for a class of a scene: it would list every key of it with its default."""
    _name, documented = rest[:2]
    return ("()", "") if kind == "class" and hasattr(documented, "model_fields") else None


def _escape_bars(_app: object, _kind: str, *rest: Any) -> None:
    """|p| is an absolute value, and no substitution."""
    lines: list[str] = rest[-1]
    lines[:] = [re.sub(r"(?<!`)\|(\w+)\|", r"\\|\1\\|", line) for line in lines]


def _first_page(app: Any, fault: Exception | None) -> None:
    """A server shows index.html for a folder."""
    if fault is None and app.builder.name == "html":
        shutil.copy(Path(app.outdir) / f"{root_doc}.html", Path(app.outdir) / "index.html")


NOTEBOOKS_LIMIT_S = 300


def _notebook_times(app: Any, fault: Exception | None) -> None:
    """Print how long all notebooks took together; more than the limit ends the build."""
    if fault is not None or app.builder.name != "html":
        return
    found = (data.get("exec_data") for data in app.env.nb_metadata.values())
    times = [data["runtime"] for data in found if data and data["runtime"] is not None]
    print(f"{len(times)} notebooks ran in {sum(times):.0f} s")
    if sum(times) > NOTEBOOKS_LIMIT_S:
        raise SphinxError(f"notebooks: allowed: at most {NOTEBOOKS_LIMIT_S} s in all")


def setup(app: Any) -> None:
    """Register what changes pages while they are read."""
    app.connect("source-read", _complete)
    app.connect("autodoc-process-signature", _without_defaults)
    app.connect("autodoc-process-docstring", _escape_bars)
    app.connect("build-finished", _first_page)
    app.connect("build-finished", _notebook_times)

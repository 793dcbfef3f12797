# SPDX-License-Identifier: Apache-2.0
"""Tables of what commands print with --json, from the docstrings of their results."""

import ast
import inspect
import re
from collections.abc import Iterator
from typing import Any

from palmbots._util.plain_values import keys_of
from palmbots.assessment.carried import Carried
from palmbots.stability.design_result import Design


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {"keys of carry": table(Carried), "keys of design": table(Design)}


def table(kind: type) -> str:
    """Every key with its meaning, as Markdown; those whose name says it come last."""
    known = dict(pair for base in reversed(kind.__mro__[:-1]) for pair in _meanings(base))
    keys = keys_of(kind)
    rows = [f"| `{key}` | {known[key]} |" for key in keys if key in known]
    others = ", ".join(f"`{key}`" for key in keys if key not in known)
    heads = "| key of `--json` | meaning |\n|---|---|\n"
    return heads + "\n".join([*rows, f"| {others} | what their names say |"])


def _meanings(kind: Any) -> Iterator[tuple[str, str]]:
    """The docstrings of the fields and properties of a class, as Markdown about JSON."""
    (node,) = ast.parse(inspect.getsource(kind)).body
    assert isinstance(node, ast.ClassDef)
    for k, one in enumerate(node.body):
        match one, node.body[k + 1 : k + 2]:
            case ast.AnnAssign(target=ast.Name(id=name)), [
                ast.Expr(value=ast.Constant(value=str(text)))
            ]:
                pass
            case ast.FunctionDef(name=name), _:
                text = ast.get_docstring(one) or ""
            case _:
                continue
        text = " ".join(text.split()).replace("``", "`")
        yield name, re.sub(r"\bNone\b", "null", text).rstrip(".")

# SPDX-License-Identifier: Apache-2.0
"""The public names of the package, each with the first paragraph of its docstring."""

import ast
import importlib
import inspect
import re
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, Literal, get_args, get_origin

import palmbots


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    rooms = [name for name in sorted(palmbots.__all__) if inspect.ismodule(_value(palmbots, name))]
    modules = [palmbots, *(importlib.import_module(f"palmbots.{name}") for name in rooms)]
    return {"public names": "\n\n".join(map(_section, modules))}


def _section(module: ModuleType) -> str:
    lines = [f"## {module.__name__}", "", _first_paragraph(module.__doc__), ""]
    lines += ["| name | what it is |", "|---|---|"]
    for name in sorted(module.__all__, key=str.lower):
        value = _value(module, name)
        if inspect.ismodule(value) and module is palmbots:
            continue  # it has a section of its own
        lines.append(f"| `{_shown(name, value)}` | {_meaning(module, name, value)} |")
    return "\n".join(lines)


def _value(module: ModuleType, name: str) -> Any:
    return getattr(module, name)


def _shown(name: str, value: Any) -> str:
    """The name, and the arguments of a function without their types."""
    if not isinstance(value, FunctionType):
        return name
    signature = inspect.signature(value)
    plain = [p.replace(annotation=p.empty) for p in signature.parameters.values()]
    text = re.sub(r"<class '(?:\w+\.)*(\w+)'>", r"\1", str(inspect.Signature(plain)))
    return name + re.sub(r"<(?:[^<>]|<\w+>)*>", "…", text)  # a function, with its address


def _meaning(module: ModuleType, name: str, value: Any) -> str:
    is_documented = inspect.isclass(value) or inspect.ismodule(value) or inspect.isroutine(value)
    text = value.__doc__ if is_documented else _comment_below(module, name)
    if get_origin(value) is Literal and text is None:
        text = f"One of {', '.join(f'`{choice!r}`' for choice in get_args(value))}."
    return _first_paragraph(text).replace("|", "\\|")


def _first_paragraph(text: str | None) -> str:
    return " ".join(inspect.cleandoc(text or "").split("\n\n")[0].split())


def _comment_below(module: ModuleType, name: str) -> str | None:
    """The string below the assignment of a constant or type, where the name is defined."""
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                if (alias.asname or alias.name) == name and node.module:
                    return _comment_below(importlib.import_module(node.module), alias.name)
    for statement, below in zip(tree.body, tree.body[1:], strict=False):
        targets = statement.targets if isinstance(statement, ast.Assign) else ()
        if isinstance(statement, ast.AnnAssign):
            targets = [statement.target]
        if any(isinstance(t, ast.Name) and t.id == name for t in targets):
            is_text = isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant)
            return str(below.value.value) if is_text else None  # type: ignore[attr-defined]
    return None

# SPDX-License-Identifier: Apache-2.0
"""What `make book` appends to two pages: the help of every command, and every public name."""

import inspect
from typing import Any

from typer.main import get_command

import palmbots
from palmbots.cli.main import build_app

_WIDTH = 80


def command_line() -> str:
    """The help of every command, as the terminal shows it in 80 columns."""
    return "\n\n".join(_sections(get_command(build_app()), "palmbots", None))


def _sections(command: Any, name: str, parent: Any) -> list[str]:
    """A section for the command, and one for each command that it contains."""
    context = command.context_class(
        command,
        info_name=name,
        parent=parent,
        terminal_width=_WIDTH,
        **command.context_settings,
    )
    lines = [line.rstrip() for line in command.get_help(context).strip().splitlines()]
    text = "\n".join([f"## {context.command_path}", "", "```text", *lines, "```"])
    inner = command.list_commands(context) if hasattr(command, "commands") else ()
    return [text, *(s for n in inner for s in _sections(command.commands[n], n, context))]


def public_names() -> str:
    """A section for the package, and one for each public room of it."""
    rooms = [n for n in dir(palmbots) if inspect.ismodule(getattr(palmbots, n))]
    modules = ["palmbots", *(f"palmbots.{room}" for room in rooms)]
    options = "   :members:\n   :imported-members:"
    return "\n".join(
        f"## {name}\n\n```{{eval-rst}}\n.. automodule:: {name}\n{options}\n```\n"
        for name in modules
    )

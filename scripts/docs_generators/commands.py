# SPDX-License-Identifier: Apache-2.0
"""The help of every command, as the terminal shows it in 80 columns."""

from typing import Any

from typer.main import get_command

from palmbots.cli.main import build_app

_WIDTH = 80


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {"commands": "\n\n".join(_sections(get_command(build_app()), "palmbots", None))}


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

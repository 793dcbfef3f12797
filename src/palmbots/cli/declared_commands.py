# SPDX-License-Identifier: Apache-2.0
"""Which commands there are, read from the source of the package.

``palmbots --help`` and Ctrl-C must not wait for the modules of all commands. So the declarations
(`palmbots._util.command`) are found as text: a line that begins with ``@command(``, and what
follows it up to the end of the docstring.
"""

import importlib
import inspect
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import palmbots
from palmbots._util.command import COMMANDS, Command
from palmbots.cli import commands

_MARK, _QUOTES = "\n@command(", '"""'
_NAME = re.compile(r'\s*"([^"]+)"')
_ORDER = re.compile(r"\border=(\d+)")
_FUNCTION = re.compile(r"^def (\w+)\(", re.MULTILINE)


@dataclass(frozen=True)
class Declared:
    """What the list of commands shows of one, and where the rest stands."""

    name: str
    module: str
    order: int
    summary: str
    """The first line of its docstring; of a group, that of its module."""


@cache
def declared_commands() -> dict[str, Declared]:
    """All commands and groups, by name, in the order of ``palmbots --help``."""
    found = sorted(_declarations(), key=lambda one: (one.order, one.name))
    names = dict.fromkeys(one.name for one in found)
    return {name: next(one for one in found if one.name == name) for name in names}


def is_command(name: str) -> bool:
    """Whether there is a command or group of this name."""
    return _own_module(name) is not None or name in declared_commands()


def commands_of(name: str) -> list[Command]:
    """The command of this name, or those of this group, with their functions."""
    importlib.import_module(_own_module(name) or declared_commands()[name].module)
    return [one for key, one in COMMANDS.items() if key.partition(" ")[0] == name]


def _own_module(name: str) -> str | None:
    """The module of a command with code of its own, which has a name like it: no search then."""
    module = f"{name.replace('-', '_')}_command"
    is_there = os.path.exists(os.path.join(commands.__path__[0], f"{module}.py"))
    return f"{commands.__name__}.{module}" if is_there else None


def _declarations() -> Iterator[Declared]:
    root = os.path.dirname(str(palmbots.__file__))
    for folder, _, files in os.walk(root):
        for file in files:
            if not file.endswith(".py"):
                continue
            path = os.path.join(folder, file)
            with open(path, "rb") as source:
                data = source.read()
            if _MARK.encode() in data:
                place = os.path.relpath(path, os.path.dirname(root)).removesuffix(".py")
                yield from _declared(data.decode(), place.replace(os.sep, "."))


def _declared(text: str, module: str) -> Iterator[Declared]:
    first, *others = text.split(_MARK)
    for one in others:
        head, docstring, _ = one.split(_QUOTES, 2)
        given, order, function = _NAME.match(head), _ORDER.search(head), _FUNCTION.search(head)
        assert order is not None and function is not None, module
        name = given[1] if given else function[1].replace("_", "-")
        group, _, within = name.partition(" ")
        shown = first.split(_QUOTES)[1] if within else docstring
        yield Declared(group, module, int(order[1]), shown.partition("\n")[0])


def results_of(command: Command) -> list[Any]:
    """The kinds of results that a command prints with ``--json``."""
    places = [place.partition(":") for place in command.results]
    if places:
        return [getattr(importlib.import_module(module), kind) for module, _, kind in places]
    return [kind for kind in (annotation_of(command, "return"),) if kind is not int]


def annotation_of(command: Command, parameter: str) -> Any:
    """The type of a parameter of its function; of ``return``, the type of the result."""
    function: Any = inspect.unwrap(command.function)
    given = function.__annotations__[parameter]
    return eval(given, function.__globals__) if isinstance(given, str) else given

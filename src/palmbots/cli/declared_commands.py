# SPDX-License-Identifier: Apache-2.0
"""Which commands there are and what options they have, read from the source of the package.

``palmbots --help``, ``palmbots NAME --help`` and Ctrl-C must not wait for the modules that do the
work. So the declarations (`palmbots._util.command`) are read as text: a line that begins with
``@command(`` or ``@writes(``, and what follows it up to the end of the docstring.
"""

import ast
import importlib
import inspect
import itertools
import os
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from types import UnionType
from typing import Any, get_args

import palmbots
from palmbots._util.command import Option, command, writes
from palmbots.cli import commands

_ROOT = os.path.dirname(str(palmbots.__file__))
_MARK, _QUOTES = re.compile(r"^@(?:command|writes)\(", re.MULTILINE), '"""'
_MARKS = (b"\n@command(", b"\n@writes(")
_NAME = re.compile(r'@\w+\(\s*"([^"]+)"')
_ORDER = re.compile(r"\border=(\d+)")
_FUNCTION = re.compile(r"^def (\w+)\(", re.MULTILINE)

_GROUPS = {"init": "Write a file to start from."}

REQUIRED: Any = inspect.Parameter.empty
"""In place of a default: the parameter has none."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a declared function."""

    annotation: str
    default: Any
    meaning: str = ""
    """Of a key of ``**options``: its docstring. Without a value, the function does not get it."""


@dataclass(frozen=True)
class Declared:
    """A function with a declaration, as its source has it."""

    module: str
    text: str
    """From the declaration to the end of the docstring."""
    source: str
    """Of the whole module."""

    @cached_property
    def function_name(self) -> str:
        """The name of the function."""
        found = _FUNCTION.search(self.text)
        assert found is not None, self.module
        return found[1]

    @cached_property
    def name(self) -> str:
        """Of the command; two words: a command within a group."""
        given = _NAME.match(self.text)
        return given[1] if given else self.function_name.replace("_", "-")

    @property
    def group(self) -> str:
        """The first word of the name, which stands in ``palmbots --help``."""
        return self.name.partition(" ")[0]

    @property
    def order(self) -> int | None:
        """Its place in ``palmbots --help``; None: it writes the result of a command."""
        found = _ORDER.search(self.text) if self.text.startswith("@command") else None
        return int(found[1]) if found else None

    @property
    def summary(self) -> str:
        """The first line of its docstring, or what its group is for."""
        return _GROUPS.get(self.group) or self.text.split(_QUOTES, 2)[1].partition("\n")[0]

    @cached_property
    def _node(self) -> ast.FunctionDef:
        (node,) = ast.parse(self.text).body
        assert isinstance(node, ast.FunctionDef)
        return node

    @cached_property
    def declaration(self) -> Any:
        """The `command` or `writes` above the function."""
        known = {"command": command, "writes": writes, "Option": Option}
        return eval(ast.unparse(self._node.decorator_list[0]), known)

    @property
    def options(self) -> dict[str, Option]:
        """The options that the declaration has, by parameter."""
        return self.declaration.options

    @cached_property
    def docstring(self) -> str:
        """The docstring, without its indentation."""
        return ast.get_docstring(self._node) or ""

    @cached_property
    def parameters(self) -> dict[str, Parameter]:
        """The parameters of the function in their order."""
        given = self._node.args
        plain = [*given.posonlyargs, *given.args]
        defaults = [*[None] * (len(plain) - len(given.defaults)), *given.defaults]
        pairs = zip([*plain, *given.kwonlyargs], [*defaults, *given.kw_defaults], strict=True)
        found = {
            one.arg: Parameter(self._kind(one.annotation), self._value(default))
            for one, default in pairs
        }
        gathered = given.kwarg
        if gathered is None or gathered.arg not in self.options:
            return found
        # They stand behind the option that the declaration names before them.
        before = [*found][: len(plain)]
        before += itertools.takewhile(lambda key: key != gathered.arg, self.options)
        place = [*found].index(before[-1]) + 1
        rows = [*found.items()]
        return dict([*rows[:place], *self._gathered(gathered).items(), *rows[place:]])

    def _gathered(self, argument: ast.arg) -> dict[str, Parameter]:
        """The keys of a typed dictionary of the module, as in ``**grid: Unpack[GridOptions]``."""
        name = ast.unparse(argument.annotation or ast.Name("str"))[len("Unpack[") : -1]
        found = re.search(rf"^class {name}\(TypedDict.*?(?=^\S)", self.source, re.M | re.S)
        assert found is not None, name
        (node,) = ast.parse(found[0]).body
        assert isinstance(node, ast.ClassDef)
        return {
            field.target.id: Parameter(ast.unparse(field.annotation), None, str(text.value.value))
            for field, text in itertools.pairwise(node.body)
            if isinstance(field, ast.AnnAssign)
            and isinstance(field.target, ast.Name)
            and isinstance(text, ast.Expr)
            and isinstance(text.value, ast.Constant)
            and not ast.unparse(field.annotation).startswith("Sequence")  # nobody types a polygon
        }

    @property
    def returned(self) -> str:
        """What the function returns."""
        return ast.unparse(self._node.returns or ast.Name("Any"))

    def _kind(self, annotation: ast.expr | None) -> str:
        """An annotation; in place of an alias of the module what it stands for."""
        text = ast.unparse(annotation or ast.Name("str"))
        found = re.search(rf"^{re.escape(text)}: TypeAlias = (.*)$", self.source, re.MULTILINE)
        return found[1] if found else text

    def _value(self, default: ast.expr | None) -> Any:
        """A default: a literal, or a constant of the module."""
        if default is None:
            return REQUIRED
        if isinstance(default, ast.Name):
            found = re.search(rf"^{default.id}\b.* = (.*)$", self.source, re.MULTILINE)
            return ast.literal_eval(found[1]) if found else None
        return ast.literal_eval(default)

    def load(self) -> Callable[..., Any]:
        """The function itself."""
        return getattr(importlib.import_module(self.module), self.function_name)


@cache
def declared_commands() -> dict[str, Declared]:
    """The commands, by name, in the order of ``palmbots --help``; of a group, its first one."""
    found: dict[str, Declared] = {}
    for one in sorted(_commands(_declarations()), key=lambda one: (one.order or 0, one.name)):
        found.setdefault(one.group, one)
    return found


def is_command(name: str) -> bool:
    """Whether there is a command or group of this name."""
    return bool(_own_file(name)) or name in declared_commands()


def commands_of(name: str) -> list[Declared]:
    """The command of this name, or those of this group."""
    return [one for one in _commands(_found_for(name)) if one.group == name]


def writer_of(one: Declared) -> Declared | None:
    """What writes the result of a command; None: nothing does."""
    found = _found_for(one.group)
    return next((other for other in found if other.order is None and other.name == one.name), None)


def results_of(one: Declared) -> list[Any]:
    """The kinds of results that a command prints with ``--json``."""
    from palmbots._util.results import Files

    places = [place.partition(":") for place in one.declaration.results]
    if places:
        return [getattr(importlib.import_module(module), kind) for module, _, kind in places]
    if one.returned == "int":
        return []
    if one.returned in ("Path", "list[Path]"):
        return [Files]
    scope = vars(importlib.import_module(one.module))
    found = eval(one.returned, dict(scope))
    return list(get_args(found)) if isinstance(found, UnionType) else [found]


def _commands(found: Iterable[Declared]) -> list[Declared]:
    return [one for one in found if one.order is not None]


def _own_file(name: str) -> str | None:
    """The file that is named like a command, and has all of it; None: there is none."""
    rooms = (entry.path for entry in os.scandir(_ROOT) if entry.is_dir())
    file = f"{name.replace('-', '_')}_command.py"
    places = (os.path.join(room, file) for room in (commands.__path__[0], *rooms))
    return next(filter(os.path.exists, places), None)


def _found_for(name: str) -> Iterable[Declared]:
    """The declarations among which those of a command are, without a search where it has a file."""
    own = _own_file(name)
    return _declarations() if own is None else _in_file(own)


@cache
def _declarations() -> tuple[Declared, ...]:
    folders = os.walk(_ROOT)
    return tuple(
        one
        for folder, _, files in folders
        for file in files
        if file.endswith(".py")
        for one in _in_file(os.path.join(folder, file))
    )


def _in_file(path: str) -> Iterator[Declared]:
    with open(path, "rb") as source:
        data = source.read()
    if not any(mark in data for mark in _MARKS):
        return
    text = data.decode()
    module = os.path.relpath(path, os.path.dirname(_ROOT)).removesuffix(".py").replace(os.sep, ".")
    for mark in _MARK.finditer(text):
        opened = text.index(_QUOTES, mark.start())
        end = text.index(_QUOTES, opened + 3) + 3
        yield Declared(module, text[mark.start() : end], text)

# SPDX-License-Identifier: Apache-2.0
"""The options that parameters of a declared function become: their types, names and help."""

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import typer

from palmbots._types import Interval, Region, Side
from palmbots._util.arguments import one_of, show
from palmbots._util.command import Option
from palmbots.cli.declared_commands import Declared
from palmbots.cli.options import SHARED, input_path, output_path
from palmbots.errors import PalmbotsError


class _SceneLike: ...


class _ControllerLike: ...


class _Types(dict[str, Any]):
    """What the names in annotations mean here; another name is a text."""

    def __missing__(self, name: str) -> Any:
        return str


_TYPES = _Types(
    {kind.__name__: kind for kind in (bool, float, int, list, str, tuple, Path, Sequence)}
    | {"os": os, "PathLike": os.PathLike, "Literal": Literal, "Interval": Interval, "Side": Side}
    | {"SceneLike": _SceneLike, "ControllerLike": _ControllerLike, "Overrides": list[str] | None}
    | {"FilePath": str | os.PathLike[str], "Region": Region}
)


@dataclass(frozen=True)
class _Kind:
    """How a parameter is typed, and what the function gets of it."""

    parsed: Any
    """The type that Typer parses."""
    read: Callable[[Any], Any] | None = None
    """Makes the argument of the function, where it differs."""
    is_path: bool = False
    is_scene: bool = False
    is_controller: bool = False
    """The name of a controller, or of several."""


@dataclass(frozen=True)
class Given:
    """An option of a command that is a parameter of its function."""

    option: Option
    name: str
    """As typed, with dashes."""
    kind: _Kind
    annotation: Any
    """Of the option, for Typer."""
    default: Any


def options_of(one: Declared, skip: int = 0) -> dict[str, Given]:
    """The parameters that become options."""
    is_whole = skip > 0 or one.returned == "int"
    found: dict[str, Given] = {}
    for key, parameter in [*one.parameters.items()][skip:]:
        if parameter.meaning:
            help = _help(one, parameter.meaning)
            found[key] = option_of(key, Option(help=help), parameter.annotation, None)
            continue
        is_name = parameter.annotation == "str" and key in ("scene", "controller")
        shared = Option() if is_whole else None  # a public function may keep a name as it is
        if is_whole or not is_name:
            shared = SHARED.get(key, shared)
        option = one.options.get(key, shared)
        if option is not None and not key.startswith("on_"):
            if not option.help:
                option = replace(option, help=_argument_help(one, key))
            is_place = skip > 0 and not found  # of what is written
            default = None if is_place else parameter.default
            found[key] = option_of(key, option, parameter.annotation, default)
    return found


def shared_option(key: str, annotation: str, default: Any) -> tuple[Any, Any]:
    """An option that a command has although its function has no such parameter."""
    option = option_of(key, SHARED[key], annotation, default)
    return option.annotation, option.default


def option_of(key: str, option: Option, annotation: str, default: Any) -> Given:
    """The option that a parameter becomes."""
    names = option.names.split() or [_name_of(key, option)]
    kind = _kind(eval(annotation, {}, _TYPES), option, names[0])
    if option.percent and default is not None:
        default = 100 * default
    if option.is_argument or option.is_file:
        names = [option.metavar or key.upper()]
        parser = input_path if kind.is_path else None
        made: Any = typer.Argument(parser=parser, metavar=names[0], help=option.help)
    else:
        made = typer.Option(
            *names,
            metavar=option.metavar or ("LOW HIGH" if kind.parsed == Interval else None),
            help=option.help,
            hidden=option.is_hidden,
            show_default="[default:" not in option.help,
            parser=output_path if kind.is_path else None,
        )
    parsed: Any = kind.parsed | None if default is None else kind.parsed
    return Given(option, names[0], kind, Annotated[parsed, made], default)


def _kind(hint: Any, option: Option, name: str) -> _Kind:
    """How a parameter with this annotation is typed."""
    inner = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    kinds = [kind for kind in inner if kind is not type(None)]
    first, last = kinds[0], kinds[-1]
    if first in (_SceneLike, _ControllerLike):
        return _Kind(str, is_scene=first is _SceneLike, is_controller=first is _ControllerLike)
    if last is Path or get_origin(last) is os.PathLike:
        return _Kind(Path, is_path=True)
    if get_origin(last) is Literal:
        words = get_args(last)
        if len(kinds) > 1:
            return _Kind(str, partial(_interval_or_word, name, words))
        return _Kind(str, partial(_word, name, words))
    if last == list[tuple[float, int]]:
        return _Kind(list[str], partial(_timed, name))
    if get_origin(last) is Sequence:
        (item,) = get_args(last)
        of_item = _kind(item, option, name)
        if option.is_argument:
            return _Kind(list[of_item.parsed], is_path=of_item.is_path)
        read = partial(_numbers, name) if item is float else _names
        return _Kind(str, read, is_controller=of_item.is_controller)
    return _Kind(last)


def _word(name: str, words: tuple[str, ...], value: str) -> str:
    one_of(name, value, words)
    return value


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",")]


def _argument_help(one: Declared, key: str) -> str:
    """What ``Args:`` says on a parameter, as help of an option."""
    found = re.search(rf"^    {key}: (.*(?:\n {{8}}.*)*)", one.docstring, re.MULTILINE)
    assert found is not None, f"{one.name}: the docstring has no line on {key}"
    return _help(one, found[1])


def _help(one: Declared, text: str) -> str:
    """The first sentence of a text, as help of an option."""
    first = re.split(r"\.(?:\s|$)", " ".join(text.split()), maxsplit=1)[0]
    is_word = first.startswith("`")
    first = as_typed(one, re.sub(r"; None: (.*)", r" [default: \1]", first))
    return f"{first if is_word else first[0].upper() + first[1:]}."


def as_typed(one: Declared, text: str) -> str:
    """The text with the names of options in place of parameters, and without the marks of code."""
    for key, option in one.options.items():
        text = re.sub(rf"(?<!`)`{key}`(?!`)", _name_of(key, option), text)
    return text.replace("`", "")


def _name_of(key: str, option: Option) -> str:
    """An option as it is typed."""
    name = f"--{key.replace('_', '-')}{'-percent' if option.percent else ''}"
    return (option.names.split() or [name])[0]


def _numbers(option: str, text: str) -> list[float]:
    """The numbers of an option such as ``--values 0.1,0.2``."""

    def number(part: str) -> float:
        try:
            return int(part)  # a key for whole numbers rejects 1.0
        except ValueError:
            return float(part)

    try:
        return [number(part) for part in text.split(",")]
    except ValueError:
        raise PalmbotsError(
            f"{option}: value is {show(text)}; allowed: numbers separated by commas, as in 0.1,0.2"
        ) from None


def _timed(option: str, texts: list[str]) -> list[tuple[float, int]]:
    """A repeated option that is a time and a seed, as in ``--fork 1.5:3``."""
    found = []
    for text in texts:
        at_s, _, seed = text.partition(":")
        try:
            found.append((float(at_s), int(seed)))
        except ValueError:
            raise PalmbotsError(
                f"{option}: value is {text or show(text)}; allowed: TIME:SEED, a time in s and a "
                "whole number"
            ) from None
    return found


def _interval_or_word(option: str, words: Sequence[str], text: str) -> Any:
    """An option that is a word, or the two ends of an interval, as in ``--region -0.05,0.05``."""
    if text in words:
        return text
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        raise PalmbotsError(
            f"{option}: value is {show(text)}; allowed: {', '.join(words)}, or two numbers "
            "separated by a comma, as in -0.05,0.05"
        ) from None
    return low, high

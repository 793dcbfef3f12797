# SPDX-License-Identifier: Apache-2.0
"""A command made of the function that declares it (`palmbots._util.command`).

The options have the order, the types and the defaults of the function's parameters, and
their help from its docstring. What all commands share is added here: scene and ``--set``,
``--unproved``, ``--out`` and ``--json``, progress, and the exit status. The function's module is
imported when the command runs.
"""

import contextlib
import inspect
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from os import PathLike
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import typer

from palmbots._types import Interval, Side
from palmbots._util.arguments import one_of
from palmbots._util.command import Option
from palmbots.cli._progress import progress, staged_progress
from palmbots.cli._run import (
    check_output,
    controller_of,
    interval_or_word,
    load,
    number_list,
    print_result,
)
from palmbots.cli._warnings import warn
from palmbots.cli.declared_commands import Declared, writer_of
from palmbots.cli.options import DONE, FAILED, SHARED, input_path, output_path
from palmbots.errors import PalmbotsError

_SECTION = re.compile(r"^(Args|Note|Raises|Returns):$", re.MULTILINE)


class _SceneLike: ...


class _ControllerLike: ...


class _Types(dict[str, Any]):
    """What the names in annotations mean here; another name is a text."""

    def __missing__(self, name: str) -> Any:
        return str


_TYPES = _Types(
    {kind.__name__: kind for kind in (bool, float, int, list, str, tuple, PathLike, Path, Sequence)}
    | {"Interval": Interval, "Literal": Literal, "Side": Side, "Overrides": list[str] | None}
    | {"SceneLike": _SceneLike, "ControllerLike": _ControllerLike}
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
class _Given:
    """An option of a command that is a parameter of its function."""

    option: Option
    name: str
    """As typed, with dashes."""
    kind: _Kind
    annotation: Any
    """Of the option, for Typer."""
    default: Any


def typer_function(one: Declared) -> Callable[..., int]:
    """The function of which Typer takes arguments, options and help."""
    given = _options_of(one)
    writer = writer_of(one)
    written = {} if writer is None else _options_of(writer, 1)
    shown: dict[str, tuple[Any, Any]] = {}
    for key, option in given.items():
        shown[key] = option.annotation, option.default
        if option.kind.is_controller:
            shown["unproved"] = _shared("unproved", "bool", False)
    if any(option.kind.is_scene for option in given.values()) and "scene" not in one.options:
        shown.setdefault("overrides", _shared("overrides", "Overrides", None))
    shown |= {key: (option.annotation, option.default) for key, option in written.items()}
    if one.declaration.figure:
        help = f"Write {one.declaration.figure} to this folder."
        place = _option("out", Option(help=help, metavar="DIR"), "Path | None", None)
        shown["out"] = place.annotation, None
    shown.setdefault("as_json", _shared("as_json", "bool", False))

    def run(**chosen: Any) -> int:
        if one.returned == "int":
            return one.load()(**_arguments(given, chosen))
        return _run(one, given, writer, written, chosen)

    kind = inspect.Parameter.KEYWORD_ONLY
    made: Any = run
    made.__name__ = one.function_name
    made.__doc__ = help_of(one)
    made.__annotations__ = {key: annotation for key, (annotation, _) in shown.items()}
    made.__signature__ = inspect.Signature(
        [
            inspect.Parameter(key, kind, default=default, annotation=annotation)
            for key, (annotation, default) in shown.items()
        ]
    )
    return run


def help_of(one: Declared) -> str:
    """The docstring up to its first section, without the marks of code, and the exit status."""
    text = _SECTION.split(one.docstring)[0].strip()
    failure = one.declaration.failure
    failed = f"\n\nExit status 1: {failure[1]}." if failure[0] else ""
    return text.replace("`", "") + failed


def _run(
    one: Declared,
    given: dict[str, _Given],
    writer: Declared | None,
    written: dict[str, _Given],
    chosen: dict[str, Any],
) -> int:
    as_json, changes = chosen.pop("as_json"), chosen.pop("overrides", None)
    unproved = chosen.pop("unproved", False)
    figure, failure = one.declaration.figure, one.declaration.failure[0]
    out = chosen.pop("out") if figure else None
    check_output(out)
    to_write = {key: chosen.pop(key) for key in written}
    _check_place(written, to_write)
    to_write = _arguments(written, to_write)
    arguments = _arguments({key: given[key] for key in chosen}, chosen)
    about = _about(given, arguments)
    for key, option in given.items():
        value = arguments.get(key)
        if option.kind.is_scene and value is not None:
            arguments[key] = load(value, changes)
        elif option.kind.is_controller and value is not None:
            arguments[key] = _controllers(value, unproved=unproved, quiet=as_json)
    with _callbacks(one, as_json) as called:
        result = one.load()(**arguments, **called)
    items: list[Any] = list(getattr(result, "files", ()))
    if out is not None:
        from palmbots._util.atomic_files import folder

        items.append(folder(out) / figure)
        result.save_figure(items[-1])
    place = next(iter(to_write.values()), None)
    if writer is not None and place is not None:
        with _callbacks(writer, as_json) as called:
            items += writer.load()(result, *to_write.values(), **called)
    print_result(
        result,
        as_json=as_json,
        about=about,
        written=[item for item in items if isinstance(item, Path)],
        after=[item for item in items if not isinstance(item, Path)],
    )
    return DONE if not failure or getattr(result, failure) else FAILED


def _about(given: dict[str, _Given], arguments: dict[str, Any]) -> str:
    """What the result is about: the files, or the name of the scene."""
    files = [str(arguments[key]) for key, option in given.items() if option.option.is_file]
    return " ".join(files) or arguments.get("scene") or ""


def _controllers(names: Any, *, unproved: bool, quiet: bool) -> Any:
    """The entry of a controller, or those of several."""
    if isinstance(names, str):
        return controller_of(names, unproved=unproved, quiet=quiet)
    return [
        controller_of(name, unproved=unproved and name.endswith(".toml"), quiet=quiet)
        for name in names
    ]


def _check_place(written: dict[str, _Given], chosen: dict[str, Any]) -> None:
    """Check, before the work, that the result can be written.

    Raises:
        PalmbotsError: it cannot, or there is an option of what is written, but no place for it.
    """
    place, *others = written.values() or [None]
    if place is None:
        return
    path, *values = chosen.values()
    if path is None:
        for option, value in zip(others, values, strict=True):
            if value != option.default:
                raise PalmbotsError(f"{option.name} needs {place.name} {place.option.metavar}")
    elif place.option.metavar == "DIR":
        check_output(path)
    else:
        from palmbots._util.atomic_files import check_file

        check_file(path)


@contextlib.contextmanager
def _callbacks(one: Declared, quiet: bool) -> Iterator[dict[str, Any]]:
    """What a function calls while it works."""
    found: dict[str, Any] = {}
    with contextlib.ExitStack() as stack:
        if "on_warning" in one.parameters:
            found["on_warning"] = warn
        if "on_stage" in one.parameters:
            found["on_stage"] = stack.enter_context(staged_progress(quiet))
        elif one.declaration.progress:
            shown = progress(one.declaration.progress, quiet)
            found["on_progress"] = stack.enter_context(shown)
        yield found


def _arguments(given: dict[str, _Given], chosen: dict[str, Any]) -> dict[str, Any]:
    """What the function gets of what was typed."""
    found: dict[str, Any] = {}
    for key, one in given.items():
        scale = 100 if one.option.percent else 1
        value = one.option.checked(one.name, chosen[key], scale)
        if value is not None and one.kind.read is not None:
            value = one.kind.read(value)
        found[key] = value / scale if one.option.percent else value
    return found


def _options_of(one: Declared, skip: int = 0) -> dict[str, _Given]:
    """The parameters that become options."""
    is_whole = skip > 0 or one.returned == "int"
    found: dict[str, _Given] = {}
    for key, parameter in [*one.parameters.items()][skip:]:
        option = one.options.get(key, SHARED.get(key, Option() if is_whole else None))
        if option is not None and not key.startswith("on_"):
            if not option.help:
                option = replace(option, help=_argument_help(one, key))
            found[key] = _option(key, option, parameter.annotation, parameter.default)
    return found


def _shared(key: str, annotation: str, default: Any) -> tuple[Any, Any]:
    option = _option(key, SHARED[key], annotation, default)
    return option.annotation, option.default


def _option(key: str, option: Option, annotation: str, default: Any) -> _Given:
    """The option that a parameter becomes."""
    name = f"--{key.replace('_', '-')}{'-percent' if option.percent else ''}"
    names = option.names.split() or [name]
    kind = _kind(eval(annotation, {}, _TYPES), option, names[0])
    if option.percent:
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
    parsed = kind.parsed | None if default is None else kind.parsed
    return _Given(option, names[0], kind, Annotated[parsed, made], default)


def _kind(hint: Any, option: Option, name: str) -> _Kind:
    """How a parameter with this annotation is typed."""
    inner = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    kinds = [kind for kind in inner if kind is not type(None)]
    first, last = kinds[0], kinds[-1]
    if first in (_SceneLike, _ControllerLike):
        return _Kind(str, is_scene=first is _SceneLike, is_controller=first is _ControllerLike)
    if last is Path or get_origin(last) is PathLike:
        return _Kind(Path, is_path=True)
    if get_origin(last) is Literal:
        words = get_args(last)
        if len(kinds) > 1:
            return _Kind(str, partial(interval_or_word, name, words))
        return _Kind(str, partial(_word, name, words))
    if get_origin(last) is Sequence:
        (item,) = get_args(last)
        of_item = _kind(item, option, name)
        if option.is_argument:
            return _Kind(list[of_item.parsed], is_path=of_item.is_path)
        read = partial(number_list, name) if item is float else _names
        return _Kind(str, read, is_controller=of_item.is_controller)
    return _Kind(last)


def _word(name: str, words: tuple[str, ...], value: str) -> str:
    one_of(name, value, words)
    return value


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",")]


def _argument_help(one: Declared, key: str) -> str:
    """The first sentence on a parameter in ``Args:``, as help of an option."""
    found = re.search(rf"^    {key}: (.*(?:\n {{8}}.*)*)", one.docstring, re.MULTILINE)
    assert found is not None, f"{one.name}: the docstring has no line on {key}"
    first = re.split(r"\.(?:\s|$)", " ".join(found[1].split()), maxsplit=1)[0]
    first = re.sub(r"; None: (.*)", r" [default: \1]", first).replace("`", "")
    return f"{first[0].upper()}{first[1:]}."

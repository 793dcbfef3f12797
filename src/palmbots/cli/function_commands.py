# SPDX-License-Identifier: Apache-2.0
"""A command made of the public function that declares it (`palmbots._util.command`).

The options have the order, the types and the defaults of the function's parameters, and
their help from its docstring. What all commands share is added here: scene and ``--set``,
``--unproved``, ``--out`` and ``--json``, progress, and the exit status.
"""

import inspect
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin

import typer

from palmbots._util.command import Command, Option
from palmbots.cli._progress import progress
from palmbots.cli._run import check_output, controller_of, load, number_list, print_result
from palmbots.cli.declared_commands import annotation_of
from palmbots.cli.options import (
    DONE,
    FAILED,
    ControllerOption,
    JsonOption,
    PrecisionOption,
    SceneArgument,
    SeedOption,
    SetOption,
    UnprovedOption,
    input_argument,
    output_option,
)

_COMMON = {
    "scene": SceneArgument,
    "overrides": SetOption,
    "controller": ControllerOption,
    "seed": SeedOption,
    "precision": PrecisionOption,
}
_SECTION = re.compile(r"^(Args|Note|Raises|Returns):$", re.MULTILINE)


@dataclass(frozen=True)
class _Given:
    """An option of a command that is a parameter of its function."""

    option: Option
    name: str
    """As typed, with dashes."""
    annotation: Any
    """Of the option, for Typer."""
    default: Any
    read: Callable[[Any], Any]
    """Makes the argument of the function."""


def typer_function(command: Command) -> Callable[..., int]:
    """The function of which Typer takes arguments, options and help."""
    parameters = inspect.signature(command.function).parameters
    given = {key: _given(command, key) for key in parameters if key in command.options}
    shown: dict[str, tuple[Any, Any]] = {}
    for key, parameter in parameters.items():
        if key in given:
            shown[key] = given[key].annotation, given[key].default
        elif key in _COMMON:
            shown[key] = _COMMON[key], parameter.default
        if key in ("controller", "controllers"):
            shown["unproved"] = UnprovedOption, False
    if "scene" in shown and "scene" not in given:
        shown.setdefault("overrides", (SetOption, None))
    if command.figure:
        help = f"Write {command.figure} to this folder."
        shown["out"] = Annotated[Path | None, output_option(help)], None
    shown["as_json"] = JsonOption, False

    def run(**chosen: Any) -> int:
        return _run(command, given, chosen)

    kind = inspect.Parameter.KEYWORD_ONLY
    made: Any = run
    made.__name__ = command.function.__name__
    made.__doc__ = help_of(command)
    made.__annotations__ = {key: annotation for key, (annotation, _) in shown.items()}
    made.__signature__ = inspect.Signature(
        [
            inspect.Parameter(key, kind, default=default, annotation=annotation)
            for key, (annotation, default) in shown.items()
        ]
    )
    return run


def help_of(command: Command) -> str:
    """The docstring up to its first section, without the marks of code, and the exit status."""
    text = _SECTION.split(inspect.getdoc(command.function) or "")[0].strip()
    failed = f"\n\nExit status 1: {command.failure[1]}." if command.failure[0] else ""
    return text.replace("`", "") + failed


def _run(command: Command, given: dict[str, _Given], chosen: dict[str, Any]) -> int:
    as_json, out = chosen.pop("as_json"), chosen.pop("out", None)
    changes, unproved = chosen.pop("overrides", None), chosen.pop("unproved", False)
    check_output(out)
    for key, one in given.items():
        scale = 100 if one.option.percent else 1
        chosen[key] = one.read(one.option.checked(one.name, chosen[key], scale))
    files = [str(chosen[key]) for key, one in given.items() if one.option.is_file]
    about = " ".join(files) or chosen.get("scene", "")
    if chosen.get("scene") is not None:
        chosen["scene"] = load(chosen["scene"], changes)
    resolve = partial(controller_of, quiet=as_json)
    if "controller" in chosen:
        chosen["controller"] = resolve(chosen["controller"], unproved=unproved)
    if chosen.get("controllers") is not None:
        chosen["controllers"] = [
            resolve(name, unproved=unproved and name.endswith(".toml"))
            for name in chosen["controllers"]
        ]
    home = sys.modules[command.function.__module__]
    function = getattr(home, command.function.__name__)
    if command.progress:
        with progress(command.progress, as_json) as report:
            result = function(**chosen, on_progress=report)
    else:
        result = function(**chosen)
    print_result(result, as_json=as_json, about=about, out=out, file=command.figure)
    return DONE if not command.failure[0] or getattr(result, command.failure[0]) else FAILED


def _given(command: Command, key: str) -> _Given:
    """The option that a parameter becomes."""
    option = command.options[key]
    parameter = inspect.signature(command.function).parameters[key]
    default: Any = parameter.default
    name = f"--{key.replace('_', '-')}{'-percent' if option.percent else ''}"
    names = option.names.split() or [name]
    if option.percent:
        default = 100 * default
    help = option.help or _argument_help(command, key)
    if option.is_file:
        file: Any = input_argument(option.metavar or key.upper(), help)
        return _Given(option, key, Annotated[Path, file], default, lambda value: value)
    kind, read = _kind(str if key == "scene" else annotation_of(command, key), option, names[0])
    annotation = Annotated[
        kind | None if default is None else kind,
        typer.Option(*names, metavar=option.metavar, help=help),
    ]
    return _Given(option, names[0], annotation, default, read)


def _kind(annotation: Any, option: Option, name: str) -> tuple[Any, Callable[[Any], Any]]:
    """The type that Typer parses, and the function that makes the argument of it."""
    is_optional = type(None) in get_args(annotation)
    kind = get_args(annotation)[0] if is_optional else annotation
    if option.percent:
        return kind, lambda value: value / 100
    if get_origin(kind) is not Sequence:
        return kind, lambda value: value
    read = partial(number_list, name) if get_args(kind)[0] is float else _names
    return str, lambda text: None if text is None else read(text)


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",")]


def _argument_help(command: Command, key: str) -> str:
    """The first sentence on a parameter in ``Args:``, as help of an option."""
    text = inspect.getdoc(command.function) or ""
    found = re.search(rf"^    {key}: (.*(?:\n {{8}}.*)*)", text, re.MULTILINE)
    assert found is not None, f"{command.name}: the docstring has no line on {key}"
    first = re.split(r"\.(?:\s|$)", " ".join(found[1].split()), maxsplit=1)[0]
    first = re.sub(r"; None: (.*)", r" [default: \1]", first).replace("`", "")
    return f"{first[0].upper()}{first[1:]}."

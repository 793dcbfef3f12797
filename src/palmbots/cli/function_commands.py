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
from collections.abc import Callable, Iterator
from pathlib import Path
from shlex import quote
from typing import Any

from palmbots._util.command import Option
from palmbots._util.exit_status import DONE, FAILED
from palmbots.cli._progress import progress, staged_progress
from palmbots.cli._run import (
    check_output,
    controller_of,
    load,
    print_result,
)
from palmbots.cli._streams import say
from palmbots.cli._warnings import print_held_warnings, warn
from palmbots.cli.declared_commands import Declared, writer_of
from palmbots.cli.parameter_options import Given, as_typed, option_of, options_of, shared_option
from palmbots.errors import PalmbotsError

_SECTION = re.compile(r"^(Args|Note|Raises|Returns):$", re.MULTILINE)


def typer_function(one: Declared) -> Callable[..., int]:
    """The function of which Typer takes arguments, options and help."""
    given = options_of(one)
    writer = None if one.returned == "int" else writer_of(one)
    written = {} if writer is None else options_of(writer, 1)
    shown: dict[str, tuple[Any, Any]] = {}
    for key, option in given.items():
        shown[key] = option.annotation, option.default
        if option.kind.is_controller:
            shown["unproved"] = shared_option("unproved", "bool", False)
    if any(option.kind.is_scene for option in given.values()) and "scene" not in one.options:
        shown.setdefault("overrides", shared_option("overrides", "Overrides", None))
    shown |= {key: (option.annotation, option.default) for key, option in written.items()}
    if one.declaration.figure:
        help = f"Write {one.declaration.figure} to this folder, or to this .png, .svg or .pdf file."
        place = option_of("out", Option(help=help, metavar="DIR"), "Path | None", None)
        shown["out"] = place.annotation, None
    shown.setdefault("as_json", shared_option("as_json", "bool", False))

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
    return as_typed(one, text) + failed


def _run(
    one: Declared,
    given: dict[str, Given],
    writer: Declared | None,
    written: dict[str, Given],
    chosen: dict[str, Any],
) -> int:
    as_json, changes = chosen.pop("as_json"), chosen.pop("overrides", None)
    unproved = chosen.pop("unproved", False)
    figure, failure = one.declaration.figure, one.declaration.failure[0]
    out = chosen.pop("out") if figure else None
    check_output(out, or_picture=True)
    to_write = _arguments(written, {key: chosen.pop(key) for key in written})
    _check_place(written, to_write)
    arguments = _arguments({key: given[key] for key in chosen}, chosen)
    from palmbots._util.results import Files  # here, as all that --help does not need

    about = _about(given, arguments)
    for key, option in given.items():
        value = arguments.get(key)
        if option.kind.is_scene and value is not None:
            if one.declaration.takes_pairs and _is_pair(value):
                arguments["overrides"] = changes
            else:
                arguments[key] = load(value, changes)
        elif option.kind.is_controller and value is not None:
            arguments[key] = _controllers(value, unproved=unproved, quiet=as_json)
    with _callbacks(one, as_json) as called:
        for key, parameter in one.parameters.items():
            if parameter.meaning and arguments[key] is None:
                del arguments[key]
        result = _result(one.load()(**arguments, **called))
    items: list[Any] = []
    if writer is not None and next(iter(to_write.values())) is not None:
        with _callbacks(writer, as_json) as called:
            items = writer.load()(result, *to_write.values(), **called)
    print_result(
        result,
        as_json=as_json,
        about="" if isinstance(result, Files) else about,
        written=[item for item in items if isinstance(item, Path)],
        after=[*(item for item in items if not isinstance(item, Path)), *_then(one, arguments)],
        out=out,
        file=figure,
    )
    return DONE if not failure or getattr(result, failure) else FAILED


def _is_pair(value: str) -> bool:
    """Whether the file that is given in place of a scene is a pair file."""
    from palmbots.pair.pair_file import is_pair_file

    return is_pair_file(value)


def _then(one: Declared, arguments: dict[str, Any]) -> Iterator[Any]:
    """What to run next."""
    from palmbots._util.report import Line

    if text := one.declaration.then.format(**{k: quote(str(v)) for k, v in arguments.items()}):
        yield Line(f"next: {text}", indent=2, is_whole=True)


def _result(found: Any) -> Any:
    """What a function returns; the names of files that it wrote are a result, too."""
    from palmbots._util.results import Files, Result

    if isinstance(found, Result):
        return found
    return Files((found,) if isinstance(found, Path) else tuple(found))


def _about(given: dict[str, Given], arguments: dict[str, Any]) -> str:
    """What the result is about: the files, or the name of the scene."""
    files = [arguments[key] for key, option in given.items() if option.option.is_file]
    if not files:
        return arguments.get("scene") or ""
    names = files[0] if isinstance(files[0], list) else files
    return str(names[0]) if len(names) == 1 else ""


def _controllers(names: Any, *, unproved: bool, quiet: bool) -> Any:
    """The entry of a controller, or those of several."""
    if isinstance(names, str):
        return controller_of(names, unproved=unproved, quiet=quiet)
    return [
        controller_of(name, unproved=unproved and name.endswith(".toml"), quiet=quiet)
        for name in names
    ]


def _check_place(written: dict[str, Given], chosen: dict[str, Any]) -> None:
    """Check, before the work, that the result can be written.

    Raises:
        PalmbotsError: it cannot, or there is an option of what is written, but no place for it.
    """
    if not written:
        return
    place, *others = written.values()
    path, *values = chosen.values()
    if path is None:
        for option, value in zip(others, values, strict=True):
            if value != option.default:
                raise PalmbotsError(f"{option.name} needs {place.name} {place.option.metavar}")
    elif place.option.metavar == "DIR":
        check_output(path)
    else:
        from palmbots._util.atomic_files import check_file, check_suffix

        if place.option.suffixes:
            check_suffix(path, place.option.suffixes)
        check_file(path)


@contextlib.contextmanager
def _callbacks(one: Declared, quiet: bool) -> Iterator[dict[str, Any]]:
    """What a function calls while it works."""
    found: dict[str, Any] = {}
    with contextlib.ExitStack() as stack:
        if "on_warning" in one.parameters:
            found["on_warning"] = warn
        if "on_line" in one.parameters and not quiet:
            found["on_line"] = _say_at_once
        if "on_item" in one.parameters and not quiet:
            found["on_item"] = _print_at_once
        if "on_stage" in one.parameters:
            found["on_stage"] = stack.enter_context(staged_progress(quiet))
        elif one.declaration.progress:
            shown = progress(one.declaration.progress, quiet)
            found["on_progress"] = stack.enter_context(shown)
        yield found


def _say_at_once(text: str) -> None:
    """Print a line on stderr: a part of the result that is known already."""
    print_held_warnings()
    say(text)


def _print_at_once(item: Any) -> None:
    """Print a part of the report that is known already."""
    from palmbots.cli.console import print_report

    print_report([item])


def _arguments(given: dict[str, Given], chosen: dict[str, Any]) -> dict[str, Any]:
    """What the function gets of what was typed."""
    found: dict[str, Any] = {}
    for key, one in given.items():
        scale = 100 if one.option.percent else 1
        value = one.option.checked(one.name, chosen[key], scale)
        if value is not None and one.kind.read is not None:
            value = one.kind.read(value)
        found[key] = value / scale if value is not None and one.option.percent else value
    return found

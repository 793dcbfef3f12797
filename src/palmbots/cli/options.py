# SPDX-License-Identifier: Apache-2.0
"""Exit statuses, and the arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated, Any

import typer

from palmbots._util.command import Option

DONE, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
CLOSED_PIPE = 141
"""The pipe on stdout is closed: what a shell reports of programs that SIGPIPE ends."""


def output_path(text: str) -> Path:
    """Parser of an option that names a file or folder to write.

    An empty name would mean the working directory. It usually results from an unset variable of the
    shell, as in ``--out "$DIR"``.
    """
    if not text:
        raise typer.BadParameter('value is ""; allowed: a name (. is the working directory)')
    return Path(text)


def input_path(text: str) -> Path:
    """Parser of an argument that names a file to read."""
    if not text:
        raise typer.BadParameter('value is ""; allowed: the name of a file')
    return Path(text)


def input_argument(metavar: str, help: str) -> Any:
    """An argument that names a file to read."""
    return typer.Argument(parser=input_path, metavar=metavar, help=help)


def output_option(help: str, *names: str, metavar: str = "DIR") -> Any:
    """An option that names what to write; `names` defaults to ``--out``."""
    return typer.Option(*(names or ("--out",)), parser=output_path, metavar=metavar, help=help)


def interval_option(name: str, meaning: str) -> Any:
    """An option with the two ends of an interval."""
    return typer.Option(name, metavar="LOW HIGH", help=f"{meaning} [default: as in the scene].")


SceneArgument = Annotated[
    str,
    typer.Argument(metavar="SCENE", help="Built-in scene (see palmbots scenes) or TOML file."),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Override a scene key (repeatable); list them: palmbots keys.",
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
ControllerOption = Annotated[
    str,
    typer.Option(
        "--controller",
        "-c",
        metavar="NAME",
        help="Name (see palmbots controllers), module:Class, FILE.py:Class, or a policy "
        "FILE.toml or FILE.toml@station.",
    ),
]
UnprovedOption = Annotated[
    bool,
    typer.Option(
        "--unproved", help="Run a policy even if the check of its derived algorithm fails."
    ),
]
SeedOption = Annotated[int, typer.Option("--seed", help="Random seed.")]
PrecisionOption = Annotated[
    str, typer.Option("--precision", metavar="NAME", help="double or float.")
]
WorldOption = Annotated[
    # cli.main fills in the names: the module that knows them takes long to import.
    str, typer.Option("--world", metavar="NAME", help="Simulated world: {worlds}.")
]
FormatOption = Annotated[
    str, typer.Option("--format", metavar="NAME", help="Figure format: png, svg or pdf.")
]
LogOption = Annotated[
    Path | None, output_option("Folder for the log [default: log_folder of PAIR].", "--log")
]
NoLogOption = Annotated[bool, typer.Option("--no-log", help="Write no log.")]

SHARED = {
    "scene": Option(
        help="Built-in scene (see palmbots scenes) or TOML file.",
        metavar="SCENE",
        is_argument=True,
    ),
    "overrides": Option(
        "--set", "Override a scene key (repeatable); list them: palmbots keys.", "KEY=VALUE"
    ),
    "controller": Option(
        "--controller -c",
        "Name (see palmbots controllers), module:Class, FILE.py:Class, or a policy FILE.toml or "
        "FILE.toml@station.",
        "NAME",
    ),
    "unproved": Option(help="Run a policy even if the check of its derived algorithm fails."),
    "seed": Option(help="Random seed."),
    "precision": Option(help="double or float.", metavar="NAME"),
    "as_json": Option("--json", "Print one JSON object and nothing else."),
}
"""Options of parameters with these names, in all commands."""

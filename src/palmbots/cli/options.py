# SPDX-License-Identifier: Apache-2.0
"""The arguments and options that several commands share."""

from pathlib import Path

import typer

from palmbots._util.command import Option
from palmbots._util.user_paths import user_path


def output_path(text: str) -> Path:
    """Parser of an option that names a file or folder to write.

    An empty name would mean the working directory. It usually results from an unset variable of the
    shell, as in ``--out "$DIR"``.
    """
    if not text:
        raise typer.BadParameter('value is ""; allowed: a name (. is the working directory)')
    return user_path(text)


def input_path(text: str) -> Path:
    """Parser of an argument that names a file to read."""
    if not text:
        raise typer.BadParameter('value is ""; allowed: the name of a file')
    return user_path(text)


SHARED = {
    "scene": Option(
        help="Built-in scene (see palmbots scenes) or TOML file.",
        metavar="SCENE",
        is_argument=True,
    ),
    "overrides": Option(
        "--set --with",
        "Override a scene key, or the keys of a file such as palmbots fit writes (repeatable; "
        "single keys override files); list them: palmbots keys.",
        "KEY=VALUE|FILE.toml",
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
    # palmbots.cli.main fills in the names: the module that knows them takes long to import.
    "world": Option(help="Simulated world: {worlds}.", metavar="NAME"),
    "pair": Option(help="The pair.toml of both robots.", metavar="PAIR", is_argument=True),
    "side": Option(help="left or right.", metavar="SIDE"),
    "lockstep": Option(help="Let world and robots wait for each other in every tick."),
    "rate": Option(help="Run at this multiple of real time.", least=0.01, most=100.0),
    "log": Option(help="Folder for the log [default: log_folder of PAIR].", metavar="DIR"),
    "no_log": Option(help="Write no log."),
    "plain": Option(help="Print lines, not a screen; the default if stdout is no terminal."),
    "as_json": Option("--json", "Print one JSON object and nothing else."),
}
"""Options of parameters with these names, in all commands."""

# SPDX-License-Identifier: Apache-2.0
"""The command group `palmbots init`: files to start from."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, JsonOption
from palmbots.errors import PalmbotsError

ORDER = 190
EXAMPLE = "palmbots init scene my.toml"
RESULTS = ("palmbots.cli.answers:Files",)
COMMAND = typer.Typer(help="Write a file to start from.")


@COMMAND.command("scene", epilog=f"Example: {EXAMPLE}")
def init_scene(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="New TOML file.")],
    as_json: JsonOption = False,
) -> int:
    """Write the default scene with the unit and meaning of every key.

    An existing file is never overwritten.
    """
    from palmbots._util.atomic_files import write_whole
    from palmbots.cli.answers import Files
    from palmbots.scene.key_reference import default_scene_toml

    if not path.name.endswith(".toml"):
        raise PalmbotsError(f"FILE: value is {path}; allowed: a name that ends in .toml")
    write_whole(path, default_scene_toml(), new=True)
    print_result(Files((path,)), as_json=as_json, written=[path])
    return DONE


@COMMAND.command("pair", epilog="Example: palmbots init pair pair.toml")
def init_pair(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="New TOML file.")],
    as_json: JsonOption = False,
) -> int:
    """Write the settings of a pair of robots, a random key and boot counters.

    Existing files are never overwritten.
    """
    from palmbots.cli.answers import Files
    from palmbots.pair import pair_file

    written = pair_file.init_pair(path)
    print_result(Files(tuple(written)), as_json=as_json, written=written)
    return DONE

# SPDX-License-Identifier: Apache-2.0
"""The command group `palmbots init`: files to start from."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots.cli._run import print_json
from palmbots.cli.options import DONE, JsonOption
from palmbots.errors import PalmbotsError

ORDER = 190
EXAMPLE = "palmbots init scene my.toml"
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
    from palmbots.cli.console import print_written_files, report_console
    from palmbots.scene.key_reference import default_scene_toml
    from palmbots.scene.scene import Scene

    if not path.name.endswith(".toml"):
        raise PalmbotsError(f"FILE: value is {path}; allowed: a name that ends in .toml")
    write_whole(path, default_scene_toml(), new=True)
    if as_json:
        print_json({"file": str(path), "scene": Scene().model_dump()})
    else:
        print_written_files(report_console(), [path])
    return DONE


@COMMAND.command("pair", epilog="Example: palmbots init pair pair.toml")
def init_pair(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="New TOML file.")],
    as_json: JsonOption = False,
) -> int:
    """Write the settings of a pair of robots, a random key and boot counters.

    Existing files are never overwritten.
    """
    from palmbots.cli.console import print_written_files, report_console
    from palmbots.pair import pair_file

    written = pair_file.init_pair(path)
    if as_json:
        print_json({"files": [str(file) for file in written]})
    else:
        print_written_files(report_console(), written)
    return DONE

# SPDX-License-Identifier: Apache-2.0
"""Write a file to start from.

The commands within `palmbots init`.
"""

from pathlib import Path
from typing import Annotated

import typer

from palmbots._util.command import command
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, JsonOption
from palmbots.errors import PalmbotsError


@command(
    "init scene",
    order=190,
    example="palmbots init scene my.toml",
    results=("palmbots.cli.answers:Files",),
)
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


@command(
    "init pair",
    order=190,
    example="palmbots init pair pair.toml",
    results=("palmbots.cli.answers:Files",),
)
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

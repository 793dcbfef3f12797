# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots firmware`."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots._util.command import command
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, JsonOption


@command(
    order=214,
    example="palmbots firmware pair.toml --out images",
    results=("palmbots.cli.answers:Files",),
)
def firmware(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for the images.")] = Path("firmware"),
    as_json: JsonOption = False,
) -> int:
    """Make images for boards that are the robots of a pair.

    left.hex and right.hex are the robots, dongle.hex is the radio of the station. No compiler is
    needed. Each image counts boots of its own: flash it into one board, once.
    """
    from palmbots.boards.images import write_images
    from palmbots.cli.answers import Files

    files = write_images(pair, out)
    print_result(Files(tuple(files)), as_json=as_json, written=files)
    return DONE

# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots flash`."""

from pathlib import Path
from typing import Annotated, Optional

import typer

from palmbots._util.command import command
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, JsonOption


@command(
    order=216, example="palmbots flash images/left.hex", results=("palmbots.cli.answers:Files",)
)
def flash(
    image: Annotated[Path, typer.Argument(metavar="IMAGE", help="A .hex of palmbots firmware.")],
    drive: Annotated[
        Optional[Path],  # noqa: UP045 (typer reads it)
        typer.Option("--drive", help="The board's drive, if more than one is connected."),
    ] = None,
    again: Annotated[
        bool, typer.Option("--again", help="Flash an image again that no board has run.")
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Copy an image to a board that is connected by USB.

    An image that has been flashed already is refused: a flashed board forgets how often it has
    booted, and would accept old packets as new.
    """
    from palmbots.boards import flashing
    from palmbots.cli.answers import Files

    file = flashing.flash(image, drive, again=again)
    print_result(Files((file,)), as_json=as_json, written=[file])
    return DONE

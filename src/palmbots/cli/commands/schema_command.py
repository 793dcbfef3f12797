# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots schema`."""

import json
from typing import Annotated

import typer

from palmbots._util.command import command
from palmbots.cli._run import print_json
from palmbots.cli.options import DONE, JsonOption


@command(order=180, example="palmbots schema scene", results=("palmbots.cli.answers:SchemaTable",))
def schema(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="scene, log, or a command that has --json.")
    ],
    as_json: JsonOption = False,
) -> int:
    """Print the JSON Schema of scenes, logs or --json.

    The schemas have the form of draft 2020-12. --json prints the same in one line.
    """
    from palmbots.cli.json_schemas import schema_of

    found = schema_of(name)
    if as_json:
        print_json(found)
    else:
        print(json.dumps(found, indent=2, ensure_ascii=False))
    return DONE

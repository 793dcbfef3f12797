# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots robot`."""

from typing import Annotated

import typer

from palmbots.cli._run import print_json
from palmbots.cli.options import DONE, JsonOption

__all__ = ["COMMAND", "EXAMPLE", "ORDER"]

ORDER = 200
EXAMPLE = "palmbots robot pair.toml --side left"


def robot(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    side: Annotated[str, typer.Option("--side", metavar="SIDE", help="left or right.")],
    as_json: JsonOption = False,
) -> int:
    """Run the program of one robot of a pair until the carry ends.

    The robot is a simulated one: its world is another process (palmbots world).
    """
    from palmbots._types import SIDES
    from palmbots._util.arguments import one_of
    from palmbots.node.lockstep_robot import run_robot
    from palmbots.node.pair_file import load_pair

    one_of("--side", side, SIDES)
    epoch = run_robot(load_pair(pair), side)  # type: ignore[arg-type]
    if as_json:
        print_json({"side": side, "boots": epoch})
    return DONE


COMMAND = robot

# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots robot`."""

from dataclasses import asdict
from typing import Annotated, Any

import typer

from palmbots.cli._run import print_json
from palmbots.cli.options import DONE, JsonOption

__all__ = ["COMMAND", "EXAMPLE", "ORDER"]

ORDER = 205
EXAMPLE = "palmbots robot pair.toml --side left"


def robot(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    side: Annotated[str, typer.Option("--side", metavar="SIDE", help="left or right.")],
    lockstep: Annotated[
        bool, typer.Option("--lockstep", help="World and robots wait for each other every tick.")
    ] = False,
    rate: Annotated[float, typer.Option("--rate", help="Run at this multiple of real time.")] = 1.0,
    as_json: JsonOption = False,
) -> int:
    """Run the program of one robot of a pair.

    It reaches its hardware by the driver of the pair, and the others by its link. Ctrl-C ends it:
    the wheels stop. With --json it prints what the link has sent, received and lost.
    """
    from palmbots._types import SIDES
    from palmbots._util.arguments import one_of
    from palmbots.runtime.live_robot import run_live_robot
    from palmbots.runtime.lockstep_robot import run_robot
    from palmbots.runtime.pair_file import load_pair

    one_of("--side", side, SIDES)
    chosen: Any = side
    if lockstep:
        found: dict[str, Any] = {"boots": run_robot(load_pair(pair), chosen)}
    else:
        found = asdict(run_live_robot(load_pair(pair), chosen, _checked(rate)))
    if as_json:
        print_json({"side": side} | found)
    return DONE


def _checked(rate: float) -> float:
    from palmbots.runtime.launcher import check_rate

    return check_rate(rate)


COMMAND = robot

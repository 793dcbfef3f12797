# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots robot`."""

from typing import Annotated, Any

import typer

from palmbots._util.command import command
from palmbots.cli._run import check_rate, print_json
from palmbots.cli.options import DONE, JsonOption, LogOption, NoLogOption


@command(
    order=205,
    example="palmbots robot pair.toml --side left",
    results=("palmbots.robot.robot_loop:RobotEnd",),
)
def robot(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    side: Annotated[str, typer.Option("--side", metavar="SIDE", help="left or right.")],
    lockstep: Annotated[
        bool, typer.Option("--lockstep", help="World and robots wait for each other every tick.")
    ] = False,
    rate: Annotated[float, typer.Option("--rate", help="Run at this multiple of real time.")] = 1.0,
    log: LogOption = None,
    no_log: NoLogOption = False,
    as_json: JsonOption = False,
) -> int:
    """Run the program of one robot of a pair.

    Its driver moves the robot. That of a new pair is simulated: it needs a palmbots world.
    """
    from palmbots._types import SIDES
    from palmbots._util.arguments import one_of
    from palmbots.pair.pair_file import load_pair

    one_of("--side", side, SIDES)
    chosen: Any = side
    pair_of = load_pair(pair).with_logs(log, is_off=no_log)
    if lockstep:
        from palmbots.robot.lockstep_robot import run_lockstep_robot

        end = run_lockstep_robot(pair_of, chosen)
    else:
        from palmbots.robot.live_robot import run_live_robot

        end = run_live_robot(pair_of, chosen, check_rate(rate), _say)
    if as_json:
        print_json(end)
    return DONE


def _say(line: str) -> None:
    from palmbots.cli._streams import say

    say(f"palmbots: {line}")

# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots ros2`."""

import math
import signal
from typing import Annotated, Any

import typer

from palmbots._util.command import command
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, JsonOption
from palmbots.errors import PalmbotsError


@command(
    order=209,
    example="palmbots ros2 pair.toml --side left",
    results=("palmbots.cli.answers:Published",),
)
def ros2(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    side: Annotated[str, typer.Option("--side", metavar="SIDE", help="left or right.")],
    seconds: Annotated[
        float | None, typer.Option("--seconds", help="End after this time; without it: at Ctrl-C.")
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Publish what a robot does as ROS 2 topics (DDS).

    Run it on the computer of the robot, beside `palmbots robot`. It only watches: nothing that
    arrives by ROS 2 reaches the robot's program. No installation of ROS 2 is needed.
    """
    from palmbots._types import SIDES
    from palmbots._util.arguments import one_of
    from palmbots.cli.answers import Published
    from palmbots.pair.pair_file import load_pair
    from palmbots.ros2.ros2_bridge import run_bridge

    one_of("--side", side, SIDES)
    if seconds is not None and not 0.1 <= seconds <= 1e6:
        raise PalmbotsError(
            f"--seconds: value is {seconds:g}; allowed: a number from 0.1 to 1000000"
        )
    chosen: Any = side

    def show(line: str) -> None:
        if not as_json:
            print(line, flush=True)

    # systemd ends a service by this signal: other nodes learn at once that the topics end.
    signal.signal(signal.SIGTERM, _end)
    published = run_bridge(
        load_pair(pair), chosen, seconds=math.inf if seconds is None else seconds, on_change=show
    )
    print_result(Published(chosen, published), as_json=as_json)
    return DONE


def _end(number: int, _: object) -> None:
    raise SystemExit(128 + number)

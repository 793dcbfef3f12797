# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots ros2`."""

import math
import signal

from palmbots._types import Side
from palmbots._util.command import Option, command
from palmbots._util.exit_status import DONE
from palmbots.cli._run import print_result


@command(
    order=209,
    example="palmbots ros2 pair.toml --side left",
    results=("palmbots.cli.answers:Published",),
    seconds=Option(least=0.1, most=1e6),
)
def ros2(
    pair: str,
    side: Side,
    *,
    seconds: float | None = None,
    as_json: bool = False,
) -> int:
    """Publish what a robot does as ROS 2 topics (DDS).

    Run it on the computer of the robot, beside `palmbots robot`. It only watches: nothing that
    arrives by ROS 2 reaches the robot's program. No installation of ROS 2 is needed.

    Args:
        seconds: end after this time; without it, at Ctrl-C.
    """
    from palmbots.cli.answers import Published
    from palmbots.pair.pair_file import load_pair
    from palmbots.ros2.ros2_bridge import run_bridge

    def show(line: str) -> None:
        if not as_json:
            print(line, flush=True)

    # systemd ends a service by this signal: other nodes learn at once that the topics end.
    signal.signal(signal.SIGTERM, _end)
    published = run_bridge(
        load_pair(pair), side, seconds=math.inf if seconds is None else seconds, on_change=show
    )
    print_result(Published(side, published), as_json=as_json)
    return DONE


def _end(number: int, _: object) -> None:
    raise SystemExit(128 + number)

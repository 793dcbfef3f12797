# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots robot`."""

from pathlib import Path

from palmbots._types import Side
from palmbots._util.command import command
from palmbots._util.exit_status import DONE
from palmbots.cli._run import print_json
from palmbots.errors import PalmbotsError


@command(
    order=205,
    example="palmbots robot pair.toml --side left",
    results=("palmbots.robot.robot_loop:RobotEnd",),
)
def robot(
    pair: str,
    side: Side,
    lockstep: bool = False,
    rate: float = 1.0,
    log: Path | None = None,
    no_log: bool = False,
    probe: bool = False,
    as_json: bool = False,
) -> int:
    """Run the program of one robot of a pair.

    Its driver moves the robot. The driver of a new pair is simulated and needs a palmbots world.

    Args:
        probe: serve palmbots probe, which commands the motors, in place of a carry.
    """
    from palmbots.pair.pair_file import load_pair

    pair_of = load_pair(pair).with_logs(log, is_off=no_log)
    if probe:
        if as_json:
            raise PalmbotsError("--probe: does not work with --json; allowed: without it")
        from palmbots.robot.probe_robot import run_probe_robot

        run_probe_robot(pair_of, side, _say, lockstep=lockstep)
        return DONE
    if lockstep:
        from palmbots.robot.lockstep_robot import run_lockstep_robot

        end = run_lockstep_robot(pair_of, side, _say)
    else:
        from palmbots.robot.live_robot import run_live_robot

        end = run_live_robot(pair_of, side, rate, _say)
    if as_json:
        print_json(end)
    return DONE


def _say(line: str) -> None:
    from palmbots.cli._streams import say

    say(f"palmbots: {line}")

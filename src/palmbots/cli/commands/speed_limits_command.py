# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots speed-limits`."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots.cli._progress import progress
from palmbots.cli._run import check_output, load, print_result
from palmbots.cli.options import DONE, JsonOption, SceneArgument, SetOption, output_option

ORDER = 100
EXAMPLE = "palmbots speed-limits --carries 2 --out out"
RESULTS = ("palmbots.mujoco.validation.speed_limits:SpeedLimits",)


def speed_limits(
    scene: SceneArgument = "paper",
    carries: Annotated[int, typer.Option("--carries", help="Carries at each speed.")] = 4,
    changes: SetOption = None,
    out: Annotated[Path | None, output_option("Write speed.png to this folder.")] = None,
    as_json: JsonOption = False,
) -> int:
    """Find the limits of quasistatic mechanics.

    The report states the largest acceleration at which the same contact slides
    as at constant speed, and compares both worlds at several speeds.
    """
    from palmbots.mujoco.validation.speed_limits import find_speed_limits as find_limits

    chosen = load(scene, changes)
    check_output(out)
    with progress("accelerating", as_json) as report:
        result = find_limits(chosen, carries=carries, on_progress=report)
    print_result(result, as_json=as_json, out=out, file="speed.png")
    return DONE


COMMAND = speed_limits

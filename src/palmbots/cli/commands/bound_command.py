# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots bound`."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots.cli._progress import progress
from palmbots.cli._run import check_output, load, print_result
from palmbots.cli.options import DONE, JsonOption, SceneArgument, SetOption, output_option
from palmbots.errors import PalmbotsError

ORDER = 97
EXAMPLE = "palmbots bound --speeds stopping"
RESULTS = ("palmbots.optimum.drop_bound:Bound",)


def bound(
    scene: SceneArgument = "paper",
    speeds: Annotated[
        str, typer.Option("--speeds", metavar="NAME", help="corrections or stopping.")
    ] = "corrections",
    drop_rate_percent: Annotated[
        float,
        typer.Option("--drop-rate-percent", help="Share of carries that drop at the limit."),
    ] = 1.0,
    changes: SetOption = None,
    out: Annotated[Path | None, output_option("Write bound.png to this folder.")] = None,
    as_json: JsonOption = False,
) -> int:
    """Compute what no controller can beat.

    The result is the greatest noise at which any controller can drop as few as 1 % of
    carries, and the least drop rate at the scene's own noise.

    With --speeds corrections the robots keep their nominal speed and add opposite
    corrections. With --speeds stopping they may also stop.
    """
    from palmbots.optimum.drop_bound import bound as find_bound

    check_output(out)
    if not 0.1 <= drop_rate_percent <= 50:
        raise PalmbotsError(
            f"--drop-rate-percent: value is {drop_rate_percent:g}; allowed: 0.1 to 50"
        )
    with progress("solving", as_json) as report:
        result = find_bound(
            load(scene, changes), speeds, drop_rate=drop_rate_percent / 100, on_progress=report
        )
    print_result(result, as_json=as_json, about=scene, out=out, file="bound.png")
    return DONE


COMMAND = bound

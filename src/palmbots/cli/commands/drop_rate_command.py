# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots drop-rate`."""

from typing import Annotated

import typer

from palmbots.cli._progress import progress
from palmbots.cli._run import controller_of, load, print_result
from palmbots.cli.options import (
    DONE,
    ControllerOption,
    JsonOption,
    SceneArgument,
    SeedOption,
    SetOption,
    UnprovedOption,
)
from palmbots.errors import PalmbotsError

ORDER = 90
EXAMPLE = "palmbots drop-rate --set robot.noise_m_s=0.012 --relative-error-percent 20"
RESULTS = ("palmbots.simulation.rare_events:DropRate",)


def drop_rate(
    scene: SceneArgument = "paper",
    controller: ControllerOption = "distributed",
    unproved: UnprovedOption = False,
    relative_error_percent: Annotated[
        float,
        typer.Option(
            "--relative-error-percent",
            help="Half-width of the 95 % interval, relative to the rate.",
        ),
    ] = 20.0,
    effort: Annotated[
        int, typer.Option("--effort", help="Carries in each stage of the splitting.")
    ] = 1000,
    seed: SeedOption = 0,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Estimate a drop rate, down to one in a billion.

    The method is multilevel splitting; the estimate has a 95 % interval.
    """
    from palmbots.simulation.rare_events import estimate_drop_rate

    if not 1 <= relative_error_percent <= 100:
        raise PalmbotsError(
            f"--relative-error-percent: value is {relative_error_percent:g}; allowed: 1 to 100"
        )
    with progress("splitting", as_json) as report:
        result = estimate_drop_rate(
            load(scene, changes),
            controller_of(controller, unproved=unproved, quiet=as_json),
            seed=seed,
            relative_half_width=relative_error_percent / 100,
            effort=effort,
            on_progress=report,
        )
    print_result(result, as_json=as_json, about=scene)
    return DONE


COMMAND = drop_rate

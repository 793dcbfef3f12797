# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots noise-limit`."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots.cli._progress import progress
from palmbots.cli._run import check_output, controller_of, load, print_result
from palmbots.cli.options import (
    DONE,
    ControllerOption,
    JsonOption,
    SceneArgument,
    SeedOption,
    SetOption,
    UnprovedOption,
    output_option,
)
from palmbots.errors import PalmbotsError

ORDER = 95
EXAMPLE = "palmbots noise-limit -c resilient --set radio.loss=0.2"
RESULTS = ("palmbots.simulation.noise_limit:NoiseLimit",)


def noise_limit(
    scene: SceneArgument = "paper",
    controller: ControllerOption = "distributed",
    unproved: UnprovedOption = False,
    drop_rate_percent: Annotated[
        float,
        typer.Option("--drop-rate-percent", help="Share of carries that drop at the limit."),
    ] = 1.0,
    relative_error_percent: Annotated[
        float,
        typer.Option(
            "--relative-error-percent",
            help="Half-width of the 95 % interval, relative to the noise.",
        ),
    ] = 1.0,
    seed: SeedOption = 0,
    changes: SetOption = None,
    out: Annotated[Path | None, output_option("Write noise_limit.png to this folder.")] = None,
    as_json: JsonOption = False,
) -> int:
    """Find the noise at which 1 % of carries drop the object.

    The noise is the scene key robot.noise_m_s; the estimate has a 95 % interval.
    """
    from palmbots.simulation.noise_limit import noise_limit as find_limit

    check_output(out)
    for option, value, low, high in (
        ("--drop-rate-percent", drop_rate_percent, 0.1, 50),
        ("--relative-error-percent", relative_error_percent, 0.1, 10),
    ):
        if not low <= value <= high:
            raise PalmbotsError(f"{option}: value is {value:g}; allowed: {low:g} to {high:g}")
    with progress("carrying", as_json) as report:
        result = find_limit(
            load(scene, changes),
            controller_of(controller, unproved=unproved, quiet=as_json),
            drop_rate=drop_rate_percent / 100,
            relative_half_width=relative_error_percent / 100,
            seed=seed,
            on_progress=report,
        )
    print_result(result, as_json=as_json, about=scene, out=out, file="noise_limit.png")
    return DONE


COMMAND = noise_limit

# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots compare`."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots.cli._progress import progress
from palmbots.cli._run import check_output, controller_of, load, number_list, print_result
from palmbots.cli.options import (
    DONE,
    JsonOption,
    PrecisionOption,
    SceneArgument,
    SeedOption,
    SetOption,
    UnprovedOption,
    output_option,
)
from palmbots.errors import PalmbotsError

ORDER = 70
EXAMPLE = "palmbots compare --sweep robot.noise_m_s --values 0.01,0.02,0.03"
RESULTS = ("palmbots.simulation.sweep:Comparison",)


def compare(
    scene: SceneArgument = "paper",
    key: Annotated[
        str, typer.Option("--sweep", metavar="KEY", help="Vary this numeric scene key.")
    ] = "radio.latency_s",
    values: Annotated[
        str | None,
        typer.Option("--values", metavar="A,B,…", help="Values of the key [default: latencies]."),
    ] = None,
    controllers: Annotated[
        str | None,
        typer.Option(
            "--controllers", metavar="A,B,…", help="Controllers to compare [default: all shipped]."
        ),
    ] = None,
    carries: Annotated[
        int, typer.Option("--carries", "-n", help="Carries per controller and value.")
    ] = 200,
    seed: SeedOption = 0,
    precision: PrecisionOption = "double",
    changes: SetOption = None,
    out: Annotated[Path | None, output_option("Write compare.png to this folder.")] = None,
    unproved: UnprovedOption = False,
    as_json: JsonOption = False,
) -> int:
    """Compare controllers over a numeric scene key.

    The default key is the radio latency.
    """
    from palmbots.simulation.sweep import DEFAULT_SWEEP, DEFAULT_VALUES
    from palmbots.simulation.sweep import compare as run_comparison

    check_output(out)
    if values is None and key != DEFAULT_SWEEP:
        raise PalmbotsError(f"--sweep {key} needs --values, as in --values 0.1,0.2")
    with progress("comparing", as_json) as report:
        result = run_comparison(
            load(scene, changes),
            key=key,
            values=DEFAULT_VALUES if values is None else number_list("--values", values),
            controllers=None
            if controllers is None
            else [
                controller_of(name, unproved=unproved and name.endswith(".toml"), quiet=as_json)
                for name in map(str.strip, controllers.split(","))
            ],
            carries=carries,
            seed=seed,
            precision=precision,
            on_progress=report,
        )
    if not result.rows:
        raise PalmbotsError(result.refusal_lines()[0])
    print_result(result, as_json=as_json, out=out, file="compare.png")
    return DONE


COMMAND = compare

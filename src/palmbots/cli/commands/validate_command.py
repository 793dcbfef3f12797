# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots validate`."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots.cli._progress import progress
from palmbots.cli._run import check_output, controller_of, load, print_result
from palmbots.cli.options import (
    DONE,
    FAILED,
    ControllerOption,
    JsonOption,
    SceneArgument,
    SetOption,
    UnprovedOption,
    output_option,
)

ORDER = 110
EXAMPLE = "palmbots validate --states 100 --carries 3 --out out"
RESULTS = ("palmbots.mujoco.validation.validation:Validation",)


def validate(
    scene: SceneArgument = "paper",
    controller: ControllerOption = "distributed",
    unproved: UnprovedOption = False,
    states: Annotated[
        int | None, typer.Option("--states", help="Number of grid states to try [default: all].")
    ] = None,
    carries: Annotated[int, typer.Option("--carries", help="Number of paired carries.")] = 12,
    changes: SetOption = None,
    out: Annotated[Path | None, output_option("Write validation.png to this folder.")] = None,
    as_json: JsonOption = False,
) -> int:
    """Compare the MuJoCo world with the quasistatic one.

    Exit status 1: the worlds disagree.
    """
    from palmbots.mujoco.validation.validation import validate as run_validation

    chosen = load(scene, changes)
    check_output(out)
    entry = controller_of(controller, unproved=unproved, quiet=as_json)
    with progress("validating", as_json) as report:
        result = run_validation(
            chosen, controller=entry, states=states, carries=carries, on_progress=report
        )
    print_result(result, as_json=as_json, out=out, file="validation.png")
    return DONE if result.holds else FAILED


COMMAND = validate

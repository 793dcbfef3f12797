# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots analyze`."""

from pathlib import Path
from typing import Annotated, Any, cast

import typer

from palmbots._util.command import command
from palmbots.cli._run import check_output, load, print_result
from palmbots.cli.options import (
    DONE,
    FormatOption,
    JsonOption,
    SceneArgument,
    SetOption,
    output_option,
)
from palmbots.errors import PalmbotsError


@command(
    order=30,
    example="palmbots analyze --set palm.friction=0.4 --figures out",
    results=("palmbots.stability.analysis:Analysis",),
)
def analyze(
    scene: SceneArgument = "paper",
    figures: Annotated[
        Path | None, output_option("Write Figures 2 to 7 to this folder.", "--figures")
    ] = None,
    file_format: FormatOption = "png",
    region_m: Annotated[
        tuple[float, float] | None,
        typer.Option(
            "--region-m",
            metavar="LOW HIGH",
            help="Contact coordinates to consider [default: whole palms].",
        ),
    ] = None,
    p_left_m: Annotated[
        float | None, typer.Option(help="Left contact of the state in Figures 2 to 4.")
    ] = None,
    p_right_m: Annotated[
        float | None, typer.Option(help="Right contact of the state in Figures 2 to 4.")
    ] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Report whether the properties hold, and their margins.

    The report also states what limits them and the ranges of COM, friction,
    slope and acceleration in which they hold.
    """
    from palmbots._util.arguments import one_of
    from palmbots.stability.analysis import analyze as run_analysis

    one_of("--format", file_format, ("png", "svg", "pdf"))
    state = None
    if p_left_m is not None or p_right_m is not None:
        state = p_left_m or 0.0, p_right_m or 0.0
        if figures is None:
            raise PalmbotsError("--p-left-m and --p-right-m need --figures DIR")
    check_output(figures)
    result = run_analysis(load(scene, changes), region_m=region_m)
    written: list[Path] = []
    if figures is not None:
        from palmbots.stability.figures.analysis_figures import save_all

        written = save_all(result, figures, kind=cast("Any", file_format), p_m=state)
    print_result(result, as_json=as_json, about=scene, written=written)
    return DONE

# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots modes`."""

from typing import Annotated

import typer

from palmbots.cli._run import load, print_result
from palmbots.cli.options import DONE, JsonOption, SceneArgument, SetOption

ORDER = 20
EXAMPLE = "palmbots modes --theta-left-deg 5 --p-left-m -0.02"
RESULTS = ("palmbots.mechanics.mode_analysis:ContactModes",)


def modes(
    scene: SceneArgument = "paper",
    p_left_m: Annotated[float, typer.Option(help="Left contact coordinate, outward.")] = 0.0,
    p_right_m: Annotated[float, typer.Option(help="Right contact coordinate, outward.")] = 0.0,
    theta_left_deg: Annotated[
        float | None, typer.Option(help="Left palm angle [default: the scene's steep angle].")
    ] = None,
    theta_right_deg: Annotated[
        float | None, typer.Option(help="Right palm angle [default: the scene's steep angle].")
    ] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Report the contact modes of one state.

    The report states which of the nine modes balance, and which occur when the
    palms close or open.
    """
    from palmbots.mechanics.mode_analysis import modes as find_modes

    result = find_modes(
        load(scene, changes),
        p_left_m=p_left_m,
        p_right_m=p_right_m,
        theta_left_deg=theta_left_deg,
        theta_right_deg=theta_right_deg,
    )
    print_result(result, as_json=as_json)
    return DONE


COMMAND = modes

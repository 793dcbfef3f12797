# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots export`."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots._types import SIDES
from palmbots._util.command import command
from palmbots.cli._run import load, print_result
from palmbots.cli.options import DONE, JsonOption, SceneArgument, SetOption, output_option
from palmbots.errors import PalmbotsError


@command(
    order=120,
    example="palmbots export paper --mjcf paper.xml --urdf left.urdf --robot left",
    results=("palmbots.cli.answers:Exported",),
)
def export(
    scene: SceneArgument = "paper",
    mjcf: Annotated[
        Path | None,
        output_option("Write the scene as MJCF to this file.", "--mjcf", metavar="FILE"),
    ] = None,
    urdf: Annotated[
        Path | None,
        output_option("Write one robot as URDF to this file.", "--urdf", metavar="FILE"),
    ] = None,
    robot: Annotated[
        str, typer.Option("--robot", metavar="SIDE", help="Robot for --urdf: left or right.")
    ] = "left",
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Write the scene as MJCF, or one robot as URDF."""
    from palmbots._util.arguments import one_of
    from palmbots._util.atomic_files import check_file, write_whole
    from palmbots.cli.answers import Exported
    from palmbots.mujoco.mjcf import mjcf as scene_mjcf
    from palmbots.mujoco.urdf import robot_urdf

    one_of("--robot", robot, SIDES)
    if mjcf is None and urdf is None:
        raise PalmbotsError("export needs --mjcf FILE, --urdf FILE or both")
    for path in filter(None, (mjcf, urdf)):
        check_file(path)
    if mjcf is not None and urdf is not None and mjcf.resolve() == urdf.resolve():
        raise PalmbotsError(f"--urdf: value is {urdf}, the file of --mjcf; allowed: another file")
    chosen = load(scene, changes)
    texts: dict[Path, str] = {}
    if mjcf is not None:
        texts[mjcf] = scene_mjcf(chosen)
    if urdf is not None:
        texts[urdf] = robot_urdf(chosen, "left" if robot == "left" else "right")
    for path, text in texts.items():
        write_whole(path, text)
    written = tuple(texts)
    print_result(Exported(written, mjcf, urdf, chosen), as_json=as_json, written=written)
    return DONE

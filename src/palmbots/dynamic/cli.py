"""The commands of the dynamic world: `palmbots export`, `validate` and `speed`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from palmbots.cli_options import DONE, JsonOption, SceneArgument, SetOption, app, scene_of
from palmbots.errors import PalmbotsError

__all__ = ["export"]


@app.command(epilog="Example: palmbots export paper --mjcf paper.xml --urdf left.urdf --robot left")
def export(
    scene: SceneArgument = "paper",
    mjcf: Annotated[
        Path | None, typer.Option("--mjcf", metavar="FILE", help="The whole scene for MuJoCo.")
    ] = None,
    urdf: Annotated[
        Path | None, typer.Option("--urdf", metavar="FILE", help="One robot as URDF.")
    ] = None,
    robot: Annotated[
        str, typer.Option("--robot", help="Which robot --urdf writes: left or right.")
    ] = "left",
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Write the scene as MJCF, or a robot as URDF."""
    from palmbots.carry import one_of
    from palmbots.dynamic.model import mjcf as as_mjcf
    from palmbots.dynamic.urdf import robot_urdf
    from palmbots.files import write_whole
    from palmbots.report import console_for_people, files_written

    one_of("--robot", robot, ("left", "right"))
    if mjcf is None and urdf is None:
        raise PalmbotsError("export: nothing to write; allowed: --mjcf FILE, --urdf FILE or both")
    if mjcf is not None and mjcf == urdf:
        raise PalmbotsError(f"--urdf: value is {mjcf}, as of --mjcf; allowed: another file")
    chosen = scene_of(scene, changes)
    texts = {mjcf: as_mjcf(chosen) if mjcf is not None else ""}
    if urdf is not None:
        texts[urdf] = robot_urdf(chosen, "left" if robot == "left" else "right")
    written = [path for path in texts if path is not None]
    for path in written:
        write_whole(path, texts[path])
    if as_json:
        told = {"mjcf": mjcf, "urdf": urdf}
        names = {kind: None if path is None else str(path) for kind, path in told.items()}
        print(json.dumps(names | {"scene": chosen.model_dump()}, allow_nan=False))
    else:
        files_written(console_for_people(), written)
    return DONE

# SPDX-License-Identifier: Apache-2.0
"""A scene in the formats of other programs."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

from palmbots._types import SIDES, Overrides, Side
from palmbots._util.arguments import one_of
from palmbots._util.atomic_files import check_file, write_whole
from palmbots._util.command import Option, command
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.results import Files
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.mujoco.mjcf import mjcf as scene_mjcf
from palmbots.mujoco.urdf import robot_urdf
from palmbots.scene.scene import Scene, SceneLike, load_scene


@dataclass(frozen=True, repr=False)
class Exported(Files):
    """A scene in other formats."""

    files: tuple[Path, ...] = field(metadata=NOT_IN_JSON)
    mjcf: Path | None
    urdf: Path | None
    scene: Scene


@command(
    order=120,
    example="palmbots export paper --mjcf paper.xml --urdf left.urdf --robot left",
    mjcf=Option(metavar="FILE"),
    urdf=Option(metavar="FILE"),
    robot=Option(metavar="SIDE"),
)
def export(
    scene: SceneLike = "paper",
    *,
    mjcf: str | PathLike[str] | None = None,
    urdf: str | PathLike[str] | None = None,
    robot: Side = "left",
    overrides: Overrides = None,
) -> Exported:
    """Write the scene as MJCF, or one robot as URDF.

    Args:
        scene: a built-in name, a file, a table or a `Scene`.
        mjcf: write the scene as MJCF to this file.
        urdf: write one robot as URDF to this file.
        robot: robot for `urdf`: left or right.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: there is no file to write, or it cannot be written.
    """
    one_of("robot", robot, SIDES)
    files = {
        name: user_path(file) for name, file in (("mjcf", mjcf), ("urdf", urdf)) if file is not None
    }
    if not files:
        raise PalmbotsError("export needs --mjcf FILE, --urdf FILE or both")
    for path in files.values():
        check_file(path)
    if len({path.resolve() for path in files.values()}) < len(files):
        raise PalmbotsError(f"urdf: value is {urdf}, the file of --mjcf; allowed: another file")
    chosen = load_scene(scene, overrides)
    makers = {"mjcf": scene_mjcf, "urdf": lambda scene: robot_urdf(scene, robot)}
    texts = {path: makers[name](chosen) for name, path in files.items()}
    for path, text in texts.items():
        write_whole(path, text)
    return Exported(tuple(texts), files.get("mjcf"), files.get("urdf"), chosen)

# SPDX-License-Identifier: Apache-2.0
"""A scene, or its carries, in the formats of other programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from palmbots._types import SIDES, FilePath, Overrides, Side
from palmbots._util.arguments import one_of
from palmbots._util.atomic_files import check_file, check_new_folder, write_whole
from palmbots._util.command import Option, command
from palmbots._util.optional_imports import require
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.results import Files
from palmbots._util.user_paths import user_path
from palmbots.control.registry import ControllerLike, resolve
from palmbots.errors import PalmbotsError
from palmbots.interchange.carry_tables import write_table
from palmbots.interchange.lerobot_sets import frames_per_second, write_dataset
from palmbots.interchange.ros_bags import write_bag
from palmbots.logs.mcap_reader import read_log
from palmbots.logs.run_log_reader import log_of_carry
from palmbots.mujoco.mjcf import mjcf as scene_mjcf
from palmbots.mujoco.urdf import robot_urdf
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.simulation.result import Carry
from palmbots.simulation.single import carry
from palmbots.views.log_alignment import align
from palmbots.views.run_figures import carry_of
from palmbots.views.run_replay import read_run

_OF_CARRIES = {"parquet": write_table, "lerobot": write_dataset, "rosbag": write_bag}
_FOLDERS = ("lerobot", "rosbag")
_PACKAGES = {
    "parquet": ("pyarrow", "parquet"),
    "lerobot": ("pyarrow", "parquet"),
    "rosbag": ("rosbags", "rosbag"),
}
"""The package that a format needs, and its extra."""
_SCENE = "paper"
_CONTROLLER = "distributed"


@dataclass(frozen=True, repr=False)
class Exported(Files):
    """A scene, or its carries, in other formats."""

    files: tuple[Path, ...] = field(metadata=NOT_IN_JSON)
    mjcf: Path | None
    urdf: Path | None
    parquet: Path | None
    lerobot: Path | None
    rosbag: Path | None
    scene: Scene
    """Of the carries, if they are those of a log."""


@command(
    order=120,
    example="palmbots export paper --seeds 20 --parquet carries.parquet",
    progress="carries",
    mjcf=Option(metavar="FILE"),
    urdf=Option(metavar="FILE"),
    robot=Option(metavar="SIDE"),
    parquet=Option(metavar="FILE"),
    lerobot=Option(metavar="DIR"),
    rosbag=Option(metavar="DIR"),
    log=Option(metavar="LOG"),
    seeds=Option(least=1, most=100_000),
)
def export(
    scene: SceneLike = _SCENE,
    *,
    mjcf: FilePath | None = None,
    urdf: FilePath | None = None,
    robot: Side = "left",
    parquet: FilePath | None = None,
    lerobot: FilePath | None = None,
    rosbag: FilePath | None = None,
    log: FilePath | None = None,
    controller: ControllerLike = _CONTROLLER,
    seeds: int = 1,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> Exported:
    """Write a scene, or carries, in formats of other programs.

    Carries are simulated with the seeds 0, 1, and so on. With a log, the carry of the log is
    written instead; with a folder of robots' logs, the last carry that they show.

    Args:
        scene: a built-in name, a file, a table or a `Scene`.
        mjcf: write the scene as MJCF to this file.
        urdf: write one robot as URDF to this file.
        robot: robot for `urdf`: left or right.
        parquet: write all carries to this table, a row for each tick.
        lerobot: write all carries to this new folder as a dataset of LeRobot, without video.
        rosbag: write the carry to this new folder, with the topics of palmbots ros2.
        log: the log of a carry, or a folder with the logs of robots; its carry is exported.
        controller: a name, a class or a policy.
        seeds: number of carries.
        overrides: scene keys to set.
        on_progress: called with the completed fraction.

    Raises:
        SceneError: the scene cannot be read or is not valid, or a carry is refused.
        PalmbotsError: there is no file to write, or it cannot be written; the log cannot be read,
            or options do not go together; a package is missing.
    """
    one_of("robot", robot, SIDES)
    given = {"mjcf": mjcf, "urdf": urdf, "parquet": parquet}
    given |= {"lerobot": lerobot, "rosbag": rosbag}
    files = {name: user_path(file) for name, file in given.items() if file is not None}
    chosen = load_scene(scene, overrides)
    _check(files, given, log, seeds)
    if log is not None:
        _check_of_log(chosen, controller)
    makers = {"mjcf": scene_mjcf, "urdf": lambda scene: robot_urdf(scene, robot)}
    texts = {files[name]: make(chosen) for name, make in makers.items() if name in files}

    tables = {name: write for name, write in _OF_CARRIES.items() if name in files}
    done: list[int] = []

    def carries() -> Iterator[Carry]:
        if log is not None:
            yield logged
            return
        for seed in range(seeds):
            yield carry(chosen, controller, seed=seed)
            done.append(seed)
            if on_progress is not None:
                on_progress(len(done) / (seeds * len(tables)))

    if log is not None:
        logged = _carry_in(user_path(log))
        chosen = logged.scene
    if "lerobot" in files:
        frames_per_second(chosen)
    for path, text in texts.items():
        write_whole(path, text)
    for name, write in tables.items():
        write(carries(), files[name])
    return Exported(
        tuple(files.values()), **{name: files.get(name) for name in given}, scene=chosen
    )


def _check(
    files: dict[str, Path],
    given: dict[str, FilePath | None],
    log: FilePath | None,
    seeds: int,
) -> None:
    """Raise `PalmbotsError` for options that do not go together, files known not to work, and a
    missing package."""
    if not files:
        names = ", ".join(f"--{name} {'DIR' if name in _FOLDERS else 'FILE'}" for name in given)
        raise PalmbotsError(f"export: has nothing to write; allowed: {names}")
    for name, path in files.items():
        (check_new_folder if name in _FOLDERS else check_file)(path)
    seen: dict[Path, str] = {}
    for name, path in files.items():
        if (other := seen.setdefault(path.resolve(), name)) != name:
            raise PalmbotsError(
                f"{name}: value is {given[name]}, the file of --{other}; allowed: another file"
            )
    if log is not None and (of_scene := [name for name in files if name not in _OF_CARRIES]):
        raise PalmbotsError(
            f"{of_scene[0]}: is made of a scene, not of --log; allowed: one of both"
        )
    if seeds > 1 and log is not None:
        raise PalmbotsError(f"seeds: value is {seeds}; allowed with --log: 1, its carry")
    if seeds > 1 and "rosbag" in files:
        raise PalmbotsError(
            f"seeds: value is {seeds}; allowed with --rosbag: 1, because a bag holds one carry"
        )
    if seeds > 1 and not files.keys() & _OF_CARRIES.keys():
        raise PalmbotsError(f"seeds: value is {seeds}; allowed with --{next(iter(files))}: 1")
    for name in files.keys() & _PACKAGES.keys():
        require(*_PACKAGES[name])


def _check_of_log(scene: Scene, controller: ControllerLike) -> None:
    """Raise `PalmbotsError` for a scene or a controller of one's own beside a log."""
    given = {
        "scene": scene.model_dump() != load_scene(_SCENE).model_dump(),
        "controller": resolve(controller).name != _CONTROLLER,
    }
    for name, is_given in given.items():
        if is_given:
            raise PalmbotsError(f"{name}: does not go with --log, which has its own")


def _carry_in(log: Path) -> Carry:
    """The carry of a log, or the last one of the robots' logs in a folder."""
    if (file := log_of_carry(log)) is not None:
        return read_log(file)
    logs = read_run([log])
    return carry_of(logs, align(logs))

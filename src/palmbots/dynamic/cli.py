"""The commands of the dynamic world: `palmbots export`, `validate` and `speed`."""

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palmbots.cli_options import (
    DONE,
    FAILED,
    JsonOption,
    SceneArgument,
    SetOption,
    app,
    path_given,
    progress,
    scene_of,
)
from palmbots.errors import PalmbotsError, SceneError

if TYPE_CHECKING:
    from palmbots.dynamic.sideways import Budget
    from palmbots.result import Carry
    from palmbots.scene import Scene

__all__ = [
    "FILM",
    "check_film",
    "export",
    "sideways_budget",
    "speed",
    "validate",
    "watching",
    "write_film",
    "write_plan",
]

FILM = ("carry-3d.png", "carry-3d.mp4")
"""The still and the film, in the folder of a carry."""


@contextmanager
def watching(wanted: bool) -> Iterator[Callable[[Any], None] | None]:
    """What shows a world in MuJoCo's viewer as it goes, if that is wanted."""
    if not wanted:
        yield None
        return
    from palmbots.dynamic.viewer import Viewer

    with Viewer() as viewer:
        yield viewer.show


def sideways_budget(scene: "Scene", controller: str, quiet: bool, anyway: bool) -> "Budget":
    """Tell how far the object will slip sideways on a curved path; warn near the end of the budget.

    Raises `SceneError` beyond it, unless `anyway`, and where lips would jam.
    """
    from palmbots.carry import CONTROLLERS
    from palmbots.dynamic.sideways import forecast
    from palmbots.errors import one_of
    from palmbots.report import console_for_people

    one_of("controller", controller, CONTROLLERS)
    with progress("predicting", quiet) as report:
        budget = forecast(scene, controller, progress=report)
    if budget.verdict == "beyond" and not anyway:
        raise SceneError(budget.refusal())
    if not quiet:
        console_for_people().print(budget.told(), style="dim", soft_wrap=True)
    if budget.verdict != "kept":
        print(
            "palmbots: warning: the path takes up much of the sideways budget: "
            f"{1e3 * budget.most_m:.0f} of {1e3 * budget.budget_m:.0f} mm for the worst seed",
            file=sys.stderr,
        )
    return budget


def write_plan(done: "Carry", out: Path) -> Path:
    """The carry seen from above; returns what was written."""
    from palmbots.dynamic.plan_view import save
    from palmbots.files import folder

    save(done, folder(out) / "plan.png")
    return folder(out) / "plan.png"


def check_film(out: Path) -> None:
    """Raise `PalmbotsError` where `write_film` could not make a film."""
    from palmbots.dynamic import film

    film.check_film(out / FILM[1])


def write_film(done: "Carry", out: Path, quiet: bool) -> list[Path]:
    """The film and a still of a carry in the dynamic world; returns what was written."""
    from palmbots.dynamic.film import save_film, save_still
    from palmbots.files import folder

    written = [folder(out) / name for name in FILM]
    with progress("film", quiet) as report:
        save_still(done, written[0])
        save_film(done, written[1], progress=report)
    return written


@app.command(epilog="Example: palmbots export paper --mjcf paper.xml --urdf left.urdf --robot left")
def export(
    scene: SceneArgument = "paper",
    mjcf: Annotated[
        Path | None,
        typer.Option(
            "--mjcf", parser=path_given, metavar="FILE", help="The whole scene for MuJoCo."
        ),
    ] = None,
    urdf: Annotated[
        Path | None,
        typer.Option("--urdf", parser=path_given, metavar="FILE", help="One robot as URDF."),
    ] = None,
    robot: Annotated[
        str, typer.Option("--robot", help="Which robot --urdf writes: left or right.")
    ] = "left",
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Write the scene as MJCF, or a robot as URDF."""
    from palmbots.dynamic.model import mjcf as as_mjcf
    from palmbots.dynamic.urdf import robot_urdf
    from palmbots.errors import one_of
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


@app.command(epilog="Example: palmbots validate --states 100 --seeds 3 --out out")
def validate(
    scene: SceneArgument = "paper",
    controller: Annotated[
        str, typer.Option("--controller", "-c", help="Of the paired carries.")
    ] = "distributed",
    states: Annotated[
        int | None, typer.Option("--states", help="How many of the grid's states [default: all].")
    ] = None,
    seeds: Annotated[int, typer.Option("--seeds", help="How many carries to pair.")] = 12,
    changes: SetOption = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", parser=path_given, metavar="DIR", help="Write validation.png there."),
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Put the dynamic world beside the quasistatic one. Exit status 1: they differ."""
    from palmbots.carry import CONTROLLERS
    from palmbots.dynamic.report import validation_report
    from palmbots.dynamic.validation import validate as run_validation
    from palmbots.errors import one_of
    from palmbots.files import check_folder

    one_of("--controller", controller, CONTROLLERS)
    chosen = scene_of(scene, changes)
    if out is not None:
        check_folder(out)
    with progress("validating", as_json) as report:
        done = run_validation(
            chosen, controller=controller, states=states, seeds=seeds, progress=report
        )
    written = []
    if out is not None:
        from palmbots.dynamic.validation_figure import save
        from palmbots.files import folder

        written = [folder(out) / "validation.png"]
        save(done, written[0])
    if as_json:
        print(json.dumps(done.summary(), allow_nan=False))
    else:
        validation_report(done, written)
    return DONE if done.holds else FAILED


@app.command(epilog="Example: palmbots speed --seeds 2 --out out")
def speed(
    scene: SceneArgument = "paper",
    seeds: Annotated[int, typer.Option("--seeds", help="How many carries at each speed.")] = 4,
    changes: SetOption = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", parser=path_given, metavar="DIR", help="Write speed.png there."),
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Find how hard and how fast the robots may go. Where quasistatic mechanics ends."""
    from palmbots.dynamic.report import speed_report
    from palmbots.dynamic.speed import speed_limits
    from palmbots.files import check_folder

    chosen = scene_of(scene, changes)
    if out is not None:
        check_folder(out)
    with progress("accelerating", as_json) as report:
        done = speed_limits(chosen, seeds=seeds, progress=report)
    written = []
    if out is not None:
        from palmbots.dynamic.speed_figure import save
        from palmbots.files import folder

        written = [folder(out) / "speed.png"]
        save(done, written[0])
    if as_json:
        print(json.dumps(done.summary(), allow_nan=False))
    else:
        speed_report(done, written)
    return DONE

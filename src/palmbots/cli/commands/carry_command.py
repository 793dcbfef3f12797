# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots carry`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palmbots._util.command import command
from palmbots.cli import mujoco_outputs
from palmbots.cli._progress import progress
from palmbots.cli._run import check_output, controller_of, load, print_result
from palmbots.cli._warnings import warn
from palmbots.cli.options import (
    DONE,
    FAILED,
    ControllerOption,
    JsonOption,
    PrecisionOption,
    SceneArgument,
    SeedOption,
    SetOption,
    UnprovedOption,
    WorldOption,
    output_option,
)
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.simulation.result import Carry


_ANIMATIONS = ("gif", "mp4")


@command(
    order=10,
    example="palmbots carry paper --controller centralized --seed 3 --out out",
    results=("palmbots.cli.carried:Carried",),
)
def carry(
    scene: SceneArgument = "paper",
    controller: ControllerOption = "distributed",
    unproved: UnprovedOption = False,
    world: WorldOption = "quasistatic",
    precision: PrecisionOption = "double",
    seed: SeedOption = 0,
    forks: Annotated[
        list[str] | None,
        typer.Option(
            "--fork",
            metavar="TIME:SEED",
            help="From this time [s] on, use the random numbers of another seed (repeatable).",
        ),
    ] = None,
    changes: SetOption = None,
    out: Annotated[
        Path | None, output_option("Write figures, animation and log to this folder.")
    ] = None,
    animation: Annotated[
        str | None,
        typer.Option("--animation", metavar="KIND", help="gif, mp4 or none [default: gif]."),
    ] = None,
    video: Annotated[
        bool, typer.Option("--video", help="Write a 3-D video and a still of the MuJoCo world.")
    ] = False,
    view: Annotated[
        bool, typer.Option("--view", help="Show the MuJoCo world in MuJoCo's viewer.")
    ] = False,
    accept_excess: Annotated[
        bool,
        typer.Option(
            "--allow-drift-beyond-budget",
            help="Carry even if the forecast lateral drift exceeds the budget.",
        ),
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Carry the object once and report the result.

    Exit status 1: the object was not delivered.

    To list what you can set, run palmbots scenes, keys, objects or controllers.
    """
    from palmbots._util.arguments import seed_of
    from palmbots._util.report import Line
    from palmbots.cli.carried import Carried
    from palmbots.control.dead_band import warnings_before
    from palmbots.simulation.prepare import check_precision, prepare
    from palmbots.simulation.single import carry as run_carry
    from palmbots.stability.scene_limits import self_check

    _check_options(animation, video, view, world, out)
    chosen = load(scene, changes)
    check_output(out)
    entry = controller_of(controller, unproved=unproved, quiet=as_json)
    prepared = prepare(chosen, entry, world)
    check_precision(prepared.world, precision)
    seed_of(seed)
    forked = [_fork(text) for text in forks or ()]
    video_file = mujoco_outputs.video_file(out) if video and out is not None else None
    early_warnings = warnings_before(chosen, prepared.controller)
    limits = () if prepared.controller.team == "none" else self_check(chosen)
    is_curved = chosen.task.path.is_curved
    budget = None
    if world == "mujoco" and is_curved:
        budget = mujoco_outputs.drift_budget(
            chosen, entry, quiet=as_json, accept_excess=accept_excess
        )
    for text in (*early_warnings, *limits):
        warn(text)
    expected_s = 0.5 * chosen.timeout_s if world == "mujoco" else 0.0
    with mujoco_outputs.viewer(view) as show, progress("carrying", as_json, expected_s) as report:
        result = run_carry(
            chosen,
            prepared.controller,
            world=world,
            precision=precision,
            seed=seed,
            forks=forked,
            record=out is not None,
            on_progress=report,
            on_tick=show,
        )
    written: list[Path] = []
    removed: list[Path] = []
    if out is not None:
        written = _write(result, out, animation or "gif", quiet=as_json)
        if world == "mujoco" and is_curved:
            written.append(mujoco_outputs.write_plan(result, out))
        if video_file is not None:
            written += mujoco_outputs.write_video(result, video_file, quiet=as_json)
        removed = _remove_outdated(out, written)
    from palmbots.stability.drop_diagnosis import analyze_hint, touch_start_hint

    explain = {"dropped": analyze_hint, "stalled": touch_start_hint}.get(result.outcome)
    hint = explain(chosen, entry.name, scene, changes) if explain and not as_json else None
    shown = Carried.of(result, [*early_warnings, *limits], budget, hint)
    after = [Line(f"removed {path} of an earlier carry", is_whole=True) for path in removed]
    print_result(shown, as_json=as_json, about=scene, written=written, after=after)
    return DONE if result.outcome == "delivered" else FAILED


def _fork(text: str) -> tuple[float, int]:
    """The time and the seed of a ``--fork``."""
    at_s, _, seed = text.partition(":")
    try:
        return float(at_s), int(seed)
    except ValueError:
        raise PalmbotsError(
            f"--fork: value is {text}; allowed: TIME:SEED, a time in s and a whole number"
        ) from None


def _check_options(
    animation: str | None, video: bool, view: bool, world: str, out: Path | None
) -> None:
    from palmbots._util.arguments import one_of

    if animation is not None:
        one_of("--animation", animation, (*_ANIMATIONS, "none"))
        if out is None and animation != "none":
            raise PalmbotsError(f"--animation {animation} needs --out DIR")
    for option, is_given in (("--video", video), ("--view", view)):
        if is_given and world != "mujoco":
            raise PalmbotsError(f"{option} needs --world mujoco")
    if video and out is None:
        raise PalmbotsError("--video needs --out DIR")


def _write(result: "Carry", out: Path, animation_kind: str, *, quiet: bool) -> list[Path]:
    """Write the figures, the log and the animation of a carry; returns the files."""
    from palmbots._util.atomic_files import folder
    from palmbots.logs.mcap_writer import write_log
    from palmbots.viz import animation, carry_figure, sequence_chart

    target = folder(out)
    written = [target / "carry.png", target / "carry.mcap"]
    with progress("figure, log, animation", quiet) as report:
        carry_figure.save(result, written[0])
        if result.message_log:
            written.append(target / "message_sequence.png")
            sequence_chart.save(result, written[-1])
        report(0.15)
        write_log(result, written[1])
        report(0.3)
        if animation_kind != "none":
            written.append(target / f"carry.{animation_kind}")
            animation.save_animation(
                result,
                written[-1],
                on_progress=lambda done, total: report(0.3 + 0.7 * done / total),
            )
    return written


def _remove_outdated(out: Path, written: list[Path]) -> list[Path]:
    """Remove files of an earlier carry that could be mistaken for those of this one."""
    from palmbots._util.atomic_files import remove

    names = [
        *(f"carry.{kind}" for kind in _ANIMATIONS),
        *(mujoco_outputs.PLAN, mujoco_outputs.STILL, *mujoco_outputs.VIDEOS),
        "message_sequence.png",
    ]
    outdated = [out / name for name in names if out / name not in written]
    return [path for path in outdated if remove(path)]

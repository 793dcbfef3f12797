# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots carry`."""

import shlex
import time
from pathlib import Path
from typing import Any, Literal

from palmbots._util.command import Option, command
from palmbots._util.exit_status import DONE, FAILED
from palmbots._util.text import duration
from palmbots.cli import mujoco_outputs
from palmbots.cli._progress import progress, staged_progress
from palmbots.cli._run import check_output, controller_of, load, print_result
from palmbots.cli._warnings import warn
from palmbots.errors import PalmbotsError


@command(
    order=10,
    example="palmbots carry paper --controller centralized --seed 3 --out out",
    results=("palmbots.cli.carried:Carried",),
    forks=Option("--fork", metavar="TIME:SEED"),
    seeds=Option(least=1, most=10**8),
    out=Option(metavar="DIR"),
    animation=Option(metavar="KIND"),
    accept_excess=Option("--allow-drift-beyond-budget"),
)
def carry(
    scene: str = "paper",
    controller: str = "distributed",
    *,
    unproved: bool = False,
    world: str = "quasistatic",
    precision: str = "double",
    seed: int = 0,
    forks: list[str] | None = None,
    seeds: int | None = None,
    overrides: list[str] | None = None,
    out: Path | None = None,
    animation: Literal["gif", "mp4", "none"] | None = None,
    video: bool = False,
    view: bool = False,
    accept_excess: bool = False,
    as_json: bool = False,
) -> int:
    """Carry the object once and report the result.

    The report ends with how often this scene fails with this controller, over many seeds, and which
    controllers do better.

    Exit status 1: the object was not delivered.

    To list what you can set, run palmbots scenes, keys, objects or controllers.

    Args:
        forks: from this time [s] on, use the random numbers of another seed (repeatable).
        seeds: count the outcomes of this many seeds, from 0; None: up to 1000, and none where
            carries take long.
        out: write figures, animation and log to this folder; or only the figure, to this .png, .svg
            or .pdf file.
        animation: ``gif``, mp4 or none; None: gif.
        video: write a 3-D video and a still of the MuJoCo world.
        view: show the MuJoCo world in MuJoCo's viewer.
        accept_excess: carry even if the forecast lateral drift exceeds the budget.
    """
    from palmbots._util.arguments import seed_of
    from palmbots._util.report import Line
    from palmbots.cli.carried import Carried
    from palmbots.simulation.outcome_counts import scene_statistics
    from palmbots.simulation.prepare import check_precision, prepare
    from palmbots.simulation.single import carry as run_carry
    from palmbots.stability.scene_limits import self_check

    is_picture = check_output(out, or_picture=True)
    folder = None if is_picture else out
    _check_options(animation, video, view, world, folder)
    chosen = load(scene, overrides)
    entry = controller_of(controller, unproved=unproved, quiet=as_json)
    prepared = prepare(chosen, entry, world)
    check_precision(prepared.world, precision)
    seed_of(seed)
    forked = [_fork(text) for text in forks or ()]
    if video and folder is not None:
        _check_video(folder)
    earlier = _earlier(folder)
    limits = () if prepared.controller.team == "none" else self_check(chosen)
    budget = None
    if world == "mujoco" and chosen.task.path.is_curved:
        budget = mujoco_outputs.drift_budget(
            chosen, entry, quiet=as_json, accept_excess=accept_excess
        )
    for text in (*prepared.warnings, *limits):
        warn(text)
    expected_s = 0.5 * chosen.timeout_s if world == "mujoco" else 0.0
    start = time.monotonic()
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
    one_s = time.monotonic() - start
    if result.outcome == "dropped":  # others may arrive
        one_s *= max(1.0, 0.5 * chosen.timeout_s / max(result.time_s, chosen.control.period_s))
    with progress("counting outcomes", as_json) as report:
        statistics = scene_statistics(
            prepared, seeds=seeds, precision=precision, on_progress=report
        )
    written: list[Path] = []
    removed: list[Path] = []
    if folder is not None:
        from palmbots.mujoco.carry_files import save_carry

        with staged_progress(as_json) as stage:
            written, removed = save_carry(
                result, folder, animation=animation or "gif", video=video, earlier=earlier,
                on_stage=stage,
            )  # fmt: skip
    from palmbots.stability.drop_hints import analyze_hint, touch_start_hint

    explain = {"dropped": analyze_hint, "stalled": touch_start_hint}.get(result.outcome)
    hint = explain(chosen, entry.name, scene, overrides) if explain and not as_json else None
    shown = Carried.of(
        result,
        [*prepared.warnings, *limits],
        drift_forecast=budget,
        hint=hint,
        scene_statistics=statistics,
        to_measure=_to_measure(one_s, scene, controller, world, unproved, accept_excess, overrides),
    )
    after = [Line(f"removed {path} of an earlier carry", is_whole=True) for path in removed]
    print_result(
        shown, as_json=as_json, about=scene, written=written, after=after,
        out=out if is_picture else None, file="carry",
    )  # fmt: skip
    return DONE if result.outcome == "delivered" else FAILED


def _earlier(out: Path | None) -> Any:
    """The files that an earlier carry left in a folder."""
    if out is None:
        return None
    from palmbots.mujoco.carry_files import earlier_files

    return earlier_files(out)


_SEEDS = 100  # none of 100 is less than 3 % with 95 %


def _to_measure(
    one_s: float,
    scene: str,
    controller: str,
    world: str,
    unproved: bool,
    accept_excess: bool,
    overrides: list[str] | None,
) -> tuple[str, str]:
    """The command that counts outcomes where carries take up to `one_s`, and how long it takes."""
    from palmbots.simulation.batch import available_cores

    words = ["palmbots", "carry", scene, "-c", controller, "--world", world]
    words += ["--seeds", str(_SEEDS)]
    words += ["--unproved"] * unproved + ["--allow-drift-beyond-budget"] * accept_excess
    for change in overrides or ():
        words += ["--set", change]
    return shlex.join(words), f"up to {duration(max(1.0, one_s * _SEEDS / available_cores()))}"


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
    if out is None and animation not in (None, "none"):
        raise PalmbotsError(f"--animation {animation} needs --out DIR")
    for option, is_given in (("--video", video), ("--view", view)):
        if is_given and world != "mujoco":
            raise PalmbotsError(f"{option} needs --world mujoco")
    if video and out is None:
        raise PalmbotsError("--video needs --out DIR")


def _check_video(out: Path) -> None:
    """Check that a video can be written; prints a line if it is no MP4."""
    from palmbots.mujoco.carry_files import check_video_file, video_name

    check_video_file(out)
    if not video_name().endswith(".mp4"):
        warn(f"ffmpeg is not installed, so the video is written as {video_name()}")

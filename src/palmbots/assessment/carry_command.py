# SPDX-License-Identifier: Apache-2.0
"""A carry with all that a user wants to know of it: forecast, outcome, statistics, files."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any, Literal, TypeAlias

from palmbots._types import FilePath, Overrides
from palmbots._util.arguments import seed_of
from palmbots._util.atomic_files import check_file, check_folder
from palmbots._util.command import Option, command
from palmbots._util.report import Line, quiet
from palmbots._util.text import duration
from palmbots._util.user_paths import user_path
from palmbots.assessment.carried import Carried
from palmbots.assessment.carried_route import CarriedRoute, carry_stages, refuse_on_route
from palmbots.control.registry import ControllerLike, resolve
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import SceneLike, load_scene
from palmbots.simulation.batch import available_cores
from palmbots.simulation.outcome_counts import scene_statistics
from palmbots.simulation.prepare import Prepared, check_precision, prepare
from palmbots.simulation.single import carry
from palmbots.stability.drop_hints import analyze_hint, touch_start_hint
from palmbots.stability.scene_limits import self_check

Film: TypeAlias = Literal["gif", "mp4", "none"] | None
Forks: TypeAlias = list[tuple[float, int]] | None
Hook: TypeAlias = Callable[..., None] | None
Place: TypeAlias = FilePath | None
Report: TypeAlias = Carried | CarriedRoute

_SEEDS = 100  # none of 100 is less than 3 % with 95 %
_HINTS = {"dropped": analyze_hint, "stalled": touch_start_hint}


@command(
    "carry",
    order=10,
    example="palmbots carry paper --controller centralized --seed 3 --out out",
    failure=("is_delivered", "the object was not delivered"),
    forks=Option("--fork", metavar="TIME:SEED"),
    seeds=Option(least=1, most=10**8),
    out=Option(metavar="DIR"),
    animation=Option(metavar="KIND"),
    video=Option(),
    view=Option(),
    force=Option("--allow-drift-beyond-budget"),
)
def carry_and_report(
    scene: SceneLike = "paper",
    controller: ControllerLike = "distributed",
    *,
    world: str = "quasistatic",
    precision: str = "double",
    seed: int = 0,
    forks: Forks = None,
    seeds: int | None = None,
    overrides: Overrides = None,
    out: Place = None,
    animation: Film = None,
    video: bool = False,
    view: bool = False,
    force: bool = False,
    on_warning: Hook = None,
    on_item: Hook = None,
    on_stage: Hook = None,
) -> Report:
    """Carry the object once and report the result.

    The report ends with how often this scene fails with this controller, over many seeds, and which
    controllers do better.

    To list what you can set, run palmbots scenes, keys, objects or controllers.

    Args:
        scene: as in `palmbots.carry`.
        controller: as in `palmbots.carry`.
        world: as in `palmbots.carry`.
        precision: as in `palmbots.carry`.
        seed: as in `palmbots.carry`.
        forks: from this time [s] on, use the random numbers of another seed (repeatable).
        seeds: count the outcomes of this many seeds, from 0; None: up to 1000, and none where
            carries take long.
        overrides: scene keys to set.
        out: write figures, animation and log to this folder; or only the figure, to this .png, .svg
            or .pdf file.
        animation: ``gif``, mp4 or none; None: gif.
        video: write a 3-D video and a still of the MuJoCo world.
        view: show the MuJoCo world in MuJoCo's viewer.
        force: carry even if the forecast lateral drift exceeds the budget.
        on_warning: called with each warning that is known before the carry; None: `lines` has them.
        on_item: called with the forecast, a line of the report that is known before the carry.
        on_stage: called with the name of the present stage, the completed fraction of it, and a
            note on it.

    Raises:
        SceneError: the scene cannot be read or is invalid; the world or the controller refuses it;
            or the drift exceeds the budget.
        PalmbotsError: another argument is not allowed, or a file cannot be written.
    """
    report = on_stage or (lambda stage, fraction, note="": None)
    warn = on_warning or (lambda text: None)
    place = None if out is None else user_path(out)
    folder = _folder(place)
    _check_options(animation, video, view, world, folder)
    given = load_scene(scene, overrides)
    if given.task.route.is_set:
        refuse_on_route(precision=precision != "double", fork=forks, view=view)
        return carry_stages(
            given, controller, world=world, seed=seed, seeds=seeds, place=place, folder=folder,
            animation=animation or "gif", video=video, on_warning=warn, on_stage=report,
        )  # fmt: skip
    prepared = prepare(given, resolve(controller), world)
    chosen, entry = prepared.scene, prepared.controller
    check_precision(prepared.world, precision)
    seed_of(seed)
    earlier = None
    if folder is not None:
        from palmbots.mujoco.carry_files import check_video_file, earlier_files

        if video:
            check_video_file(folder, warn)
        earlier = earlier_files(folder)
    limits = () if entry.team == "none" else self_check(chosen)
    budget = None
    if world == "mujoco" and chosen.task.path.is_curved:
        from palmbots.mujoco.drift_forecast import forecast_drift

        budget = forecast_drift(
            chosen, entry, on_progress=lambda part: report("forecasting the drift", part)
        )
        if budget.verdict == "beyond" and not force:
            raise SceneError(budget.refusal(chosen, entry.spelled))
        if on_item is not None:
            on_item(Line(quiet(budget.text())))
        if budget.verdict != "kept":
            warn(budget.warning())
    known = [*prepared.warnings, *limits]
    for text in known:
        warn(text)
    start = time.monotonic()

    def on_progress(part: float) -> None:
        pace = part * 0.5 * chosen.timeout_s / max(1e-3, time.monotonic() - start)
        report("carrying", part, f", {pace:.1f} × real time")

    with _window() if view else nullcontext() as window:
        result = carry(
            chosen, entry, world=world, precision=precision, seed=seed, forks=forks or (),
            record=out is not None, on_progress=on_progress,
            on_tick=None if window is None else window.show,
        )  # fmt: skip
    one_s = time.monotonic() - start
    if result.outcome == "dropped":  # others may arrive
        one_s *= max(1.0, 0.5 * chosen.timeout_s / max(result.time_s, chosen.control.period_s))
    statistics = scene_statistics(
        prepared, seeds=seeds, precision=precision,
        on_progress=lambda part: report("counting outcomes", part),
    )  # fmt: skip
    written: list[Path] = []
    removed: list[Path] = []
    if folder is not None:
        from palmbots.mujoco.carry_files import save_carry

        written, removed = save_carry(
            result, folder, animation=animation or "gif", video=video, earlier=earlier,
            on_stage=report,
        )  # fmt: skip
    elif place is not None:
        result.save_figure(place)
        written = [place]
    explain = _HINTS.get(result.outcome)
    return Carried.of(
        result,
        known,
        is_printed=on_warning is not None,
        drift_forecast=budget,
        hint=explain(chosen, entry.name) if explain else None,
        scene_statistics=statistics,
        to_measure=_to_measure(prepared, one_s, force, precision),
        written=tuple(written),
        removed=tuple(removed),
    )


def _to_measure(prepared: Prepared, one_s: float, force: bool, precision: str) -> tuple[str, str]:
    """The command that counts outcomes where carries take up to `one_s`, and how long it takes."""
    command = command_text(
        "carry", prepared.scene.spelled, controller=prepared.controller.spelled,
        world=prepared.world.name, precision=None if precision == "double" else precision,
        seeds=_SEEDS, allow_drift_beyond_budget=force,
    )  # fmt: skip
    return command, f"up to {duration(max(1.0, one_s * _SEEDS / available_cores()))}"


def _window() -> Any:
    """MuJoCo's viewer."""
    from palmbots.mujoco.viewer import Viewer

    return Viewer()


def _folder(out: Path | None) -> Path | None:
    """The folder for all files, if they can be written; None: none are, or only a picture is.

    Raises:
        PalmbotsError: nothing can be written there.
    """
    if out is None:
        return None
    from palmbots.viz.save_figure import is_picture

    if is_picture(out) and not out.is_dir():
        check_file(out)
        return None
    check_folder(out)
    return out


def _check_options(
    animation: str | None, video: bool, view: bool, world: str, folder: Path | None
) -> None:
    has_inertia = world == "mujoco"
    for option, is_given, needs, is_met in (
        (f"--animation {animation}", animation not in (None, "none"), "--out DIR", folder),
        ("--video", video, "--world mujoco", has_inertia),
        ("--view", view, "--world mujoco", has_inertia),
        ("--video", video, "--out DIR", folder),
    ):
        if is_given and not is_met:
            raise PalmbotsError(f"{option} needs {needs}")

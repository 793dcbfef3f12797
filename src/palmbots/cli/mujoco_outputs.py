# SPDX-License-Identifier: Apache-2.0
"""Files and checks of `palmbots carry --world mujoco`: video, still, plan view, drift forecast."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots.cli._progress import progress
from palmbots.cli._warnings import warn
from palmbots.errors import SceneError

if TYPE_CHECKING:
    from palmbots.control.registry import ControllerEntry
    from palmbots.mujoco.drift_budget import DriftBudget
    from palmbots.scene.scene import Scene
    from palmbots.simulation.result import Carry

STILL, PLAN = "carry-3d.png", "plan.png"
VIDEOS = ("carry-3d.mp4", "carry-3d.gif")
"""Possible names of the video; the second is written where ffmpeg is not installed."""


@contextmanager
def viewer(wanted: bool) -> Iterator[Callable[[Any], None] | None]:
    """Open MuJoCo's viewer if wanted; yields the function that shows a world in it, or None."""
    if not wanted:
        yield None
        return
    from palmbots.mujoco.viewer import Viewer

    with Viewer() as window:
        yield window.show


def drift_budget(
    scene: "Scene", controller: "ControllerEntry", *, quiet: bool, accept_excess: bool
) -> "DriftBudget":
    """Forecast the lateral drift on a curved path, print it, and warn near the limit.

    Raises:
        SceneError: lips would jam, or the drift exceeds the budget and that is not accepted.
    """
    from palmbots.cli.console import report_console
    from palmbots.mujoco.drift_forecast import forecast_drift

    with progress("forecasting the drift", quiet) as report:
        budget = forecast_drift(scene, controller, on_progress=report)
    if budget.verdict == "beyond" and not accept_excess:
        raise SceneError(budget.refusal())
    if not quiet:
        report_console().print(budget.text(), style="dim")
    if budget.verdict != "kept":
        warn(
            f"with the worst seed, the object drifts sideways by {1e3 * budget.most_m:.0f} of the "
            f"permitted {1e3 * budget.budget_m:.0f} mm"
        )
    return budget


def write_plan(carry: "Carry", out: Path) -> Path:
    """Write the view from above; returns the file."""
    from palmbots._util.atomic_files import folder
    from palmbots.mujoco.figures.plan_view import save

    path = folder(out) / PLAN
    save(carry, path)
    return path


def video_file(out: Path) -> Path:
    """The video that can be written here, MP4 or GIF; prints a line where it is no MP4.

    Raises:
        PalmbotsError: nothing can be rendered on this machine.
    """
    from palmbots.mujoco.film import check_film
    from palmbots.viz.video_files import video_formats

    suffix = video_formats()[0]
    video = next(out / name for name in VIDEOS if name.endswith(suffix))
    check_film(video)
    if suffix != ".mp4":
        warn(f"ffmpeg is not installed, so the video is written as {video.name}")
    return video


def write_video(carry: "Carry", video: Path, *, quiet: bool) -> list[Path]:
    """Write the video and a still of a carry in the MuJoCo world; returns the files."""
    from palmbots._util.atomic_files import folder
    from palmbots.mujoco.film import save_still, save_video

    still = folder(video.parent) / STILL
    with progress("video", quiet) as report:
        save_still(carry, still)
        save_video(carry, video, on_progress=report)
    return [still, video]

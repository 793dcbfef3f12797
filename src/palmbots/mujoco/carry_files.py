# SPDX-License-Identifier: Apache-2.0
"""The files of one carry: figures, animation, log, and a video of the MuJoCo world."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Literal

from palmbots._util.atomic_files import folder as writable_folder
from palmbots._util.atomic_files import remove
from palmbots._util.user_paths import user_path
from palmbots.logs.mcap_writer import write_log
from palmbots.mujoco.figures import plan_view
from palmbots.mujoco.film import check_film, save_still, save_video
from palmbots.simulation.result import Carry
from palmbots.viz import animation as animations
from palmbots.viz import carry_figure, sequence_chart
from palmbots.viz.lift_phases_figure import draw_lift_phases
from palmbots.viz.save_figure import write_figure
from palmbots.viz.video_files import video_formats

Animation = Literal["gif", "mp4", "none"]
_VIDEO, _STILL, _PLAN = "carry-3d", "carry-3d.png", "plan.png"
_PHASES = "phases.png"
_NAMES = (
    "message_sequence.png", _PHASES, _PLAN, _STILL,
    *(f"{name}{suffix}" for name in ("carry", _VIDEO) for suffix in (".gif", ".mp4")),
)  # fmt: skip
"""Files that not every carry has."""


def video_name() -> str:
    """The name of the video that can be written here: MP4, or GIF without ffmpeg."""
    return _VIDEO + video_formats()[0]


def check_video_file(folder: str | os.PathLike[str], warn: Callable[[str], None]) -> None:
    """Check, before a carry, that its video can be written; warns if it will be no MP4.

    Raises:
        PalmbotsError: nothing can be rendered on this machine.
    """
    check_film(user_path(folder) / video_name())
    if not video_name().endswith(".mp4"):
        warn(f"ffmpeg is not installed, so the video is written as {video_name()}")


Version = tuple[int, int, int]
"""Of a file: its number, size and time."""


def earlier_files(folder: str | os.PathLike[str]) -> dict[Path, Version]:
    """The files of an earlier carry in a folder that the next one may not have."""
    place, found = user_path(folder), {}
    for path in (place / name for name in _NAMES):
        if (version := _version(path)) is not None:
            found[path] = version
    return found


def _version(path: Path) -> Version | None:
    """Which file has this name; None: none."""
    try:
        state = path.stat()
    except OSError:
        return None
    return state.st_ino, state.st_size, state.st_mtime_ns


def save_carry(
    carry: Carry,
    folder: str | os.PathLike[str],
    *,
    animation: Animation = "gif",
    video: bool = False,
    earlier: Mapping[Path, Version] | None = None,
    on_stage: Callable[[str, float], None] | None = None,
) -> tuple[list[Path], list[Path]]:
    """Write the figures, the log and the animation of a carry.

    Args:
        carry: with its trace.
        folder: where.
        animation: its format.
        video: write a 3-D video and a still of the MuJoCo world, too.
        earlier: files to remove if this carry does not have them, and if they are still the same:
            another carry may write to the folder meanwhile. None: those that are there now.
        on_stage: called with the name of the present stage and the completed fraction of it.

    Returns:
        The files that were written, and those that were removed.

    Raises:
        PalmbotsError: a file cannot be written, or the video cannot be rendered.
    """
    place, show = writable_folder(folder), on_stage or (lambda stage, fraction: None)
    earlier = earlier_files(place) if earlier is None else earlier

    def report(fraction: float) -> None:
        show("figure, log, animation", fraction)

    written = [place / "carry.png", place / "carry.mcap"]
    carry_figure.save(carry, written[0])
    if carry.message_log:
        written.append(place / "message_sequence.png")
        sequence_chart.save(carry, written[-1])
    if carry.floor_job is not None:
        written.append(place / _PHASES)
        write_figure(written[-1], draw_lift_phases(carry))
    report(0.15)
    write_log(carry, written[1])
    report(0.3)
    if animation != "none":
        written.append(place / f"carry.{animation}")
        animations.save_animation(
            carry,
            written[-1],
            on_progress=lambda done, total: report(0.3 + 0.7 * done / total),
        )
    if carry.world == "mujoco" and carry.scene.task.path.is_curved:
        written.append(place / _PLAN)
        plan_view.save(carry, written[-1])
    if video:
        written += [place / _STILL, place / video_name()]
        save_still(carry, written[-2])
        save_video(carry, written[-1], on_progress=lambda fraction: show("video", fraction))
    outdated = [path for path in earlier if path not in written]
    return written, [p for p in outdated if _version(p) == earlier[p] and remove(p)]

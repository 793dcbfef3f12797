# SPDX-License-Identifier: Apache-2.0
"""The command ``fit``: keys of a scene from recordings."""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Sequence
from pathlib import Path

from palmbots._util.atomic_files import folder, write_whole
from palmbots._util.command import Option, command, writes
from palmbots._util.report import Item, Line
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.fitting.log_fit import LogFit, fit_logs
from palmbots.fitting.motion_fit import MotionFit, fit_motion
from palmbots.fitting.radio_fit import RadioFit, fit_radio
from palmbots.fitting.recorded_logs import are_logs
from palmbots.fitting.replay_files import write_replay
from palmbots.scene.command_text import command_text


@command(
    order=127,
    example="palmbots fit --motion commands.csv positions.csv --out robot",
    progress="fitting",
    files=Option(is_argument=True, metavar="FILES"),
    motion=Option("--motion"),
    radio=Option("--radio"),
)
def fit(
    files: Sequence[str | os.PathLike[str]],
    *,
    motion: bool = False,
    radio: bool = False,
    on_progress: Callable[[float], None] | None = None,
) -> MotionFit | RadioFit | LogFit:
    """Fit keys of a scene to recordings, with 95 % intervals.

    Logs give the errors of the robots' speeds, the losses and delays of the radio, and the object
    and the palms; `motion` or `radio` selects one of the first two. Other files need one of them.
    With `motion` they are pairs of files with the commands and the positions of a robot, one pair
    for each run. With `radio` they are files with the packets that arrived, one file for each run.

    Args:
        files: the recordings: logs of carries (palmbots carry --out), folders with the logs of
            robots, or tables.
        motion: fit the motion of a robot: files with commands (time_s, speed_m_s, turn_rad_s) and
            with positions (time_s, x_m, y_m, heading_rad), listed in pairs.
        radio: fit the radio: files with the packets that arrived (index, time_s, sent_s,
            round_trip_s).
        on_progress: called with the completed fraction.

    Raises:
        PalmbotsError: a file cannot be read, or nothing is identified.
    """
    if motion and radio:
        raise PalmbotsError("fit: both --motion and --radio are given; allowed: one of them")
    if are_logs(files):
        return fit_logs(files, motion=not radio, radio=not motion, on_progress=on_progress)
    if motion:
        return fit_motion(files, on_progress)
    if radio:
        return fit_radio(files, on_progress)
    for file in files:
        if not user_path(file).exists():
            raise PalmbotsError(f"{file}: no such file or folder; allowed: recordings")
    raise PalmbotsError(
        "fit: no kind of recording is given; allowed: --motion or --radio, or only logs (*.mcap)"
    )


@writes("fit", path=Option("--out -o", metavar="DIR"))
def write_fit(
    result: MotionFit | RadioFit | LogFit, path: str | os.PathLike[str]
) -> list[Path | Item]:
    """Write a part of a scene with the fitted keys, a figure, and the recording for carries that
    replay it, of robots and radio.

    Args:
        result: the fit.
        path: write parts of a scene, robot.toml, radio.toml and object.toml, and their figures to
            this folder.

    Raises:
        PalmbotsError: a file cannot be written.
    """
    files: list[Path] = []
    options = replays = ""
    for part in result.parts.values() if isinstance(result, LogFit) else [result]:
        place = folder(Path(path))
        files.append(place / f"{part.name}.toml")
        write_whole(files[-1], part.fragment())
        options += f" --with {shlex.quote(str(files[-1]))}"
        files.append(place / f"{part.name}.png")
        part.save_figure(files[-1])
        if part.replay and not part.replay.reason:
            files.append(write_replay(part.replay, part.sources, path))
            replays += f" --set {part.replay.key}={shlex.quote(str(files[-1]))}"
    notes = [Line(f"carry with it: {command_text('carry', f'SCENE{options}')}", is_whole=True)]
    if replays:
        command = command_text("carry", f"SCENE{options}{replays}")
        notes.append(Line(f"replay it: {command}", is_whole=True))
    return [*files, *notes]

# SPDX-License-Identifier: Apache-2.0
"""Animates a carry from the side, as GIF or MP4.

The frames show the recorded trace; nothing is simulated again. A carry of up to a minute is shown
in real time. A longer one is shown a whole number of times faster, which the title states.
`side_view` describes what a frame shows.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from palmbots.control.registry import describe
from palmbots.errors import PalmbotsError
from palmbots.scene.placement import placements
from palmbots.scene.spec import to_spec
from palmbots.simulation.floor_job import MEANINGS, contacts_on_palms, phase_at
from palmbots.viz.side_view import COLOURS, Moment, Stage
from palmbots.viz.side_view_scene import Message
from palmbots.viz.style import controller_title
from palmbots.viz.timeline import correction_bars, message_news, stage_bars
from palmbots.viz.video_files import check_video, write_video

if TYPE_CHECKING:
    from palmbots.simulation.floor_job import FloorJob
    from palmbots.simulation.result import Carry

_MESSAGE_SHOWN_S = 0.4
_LONGEST_S = 60.0  # a longer carry is shown faster

Progress = Callable[[int, int], None]


def save_animation(
    carry: Carry,
    path: str | os.PathLike[str],
    *,
    fps: float = 10.0,
    on_progress: Progress | None = None,
) -> None:
    """Write the animation to `path` (.gif or .mp4). The file appears only when it is complete.

    Args:
        carry: was run with ``record=True``.
        path: the file; `palmbots.viz.video_formats` lists the suffixes that are available.
        fps: frames per second. GIF counts in hundredths of a second, so 10, 20, 25 and 50 are
            exact.
        on_progress: is called with the number of finished frames and of all frames.

    Raises:
        PalmbotsError: the suffix, `fps` or the path is not allowed, the carry has no trace, or MP4
            is requested and ffmpeg is missing.
    """
    check_video(path)
    if not 1 <= fps <= 50:
        raise PalmbotsError(f"animation: fps is {fps}; allowed: 1 to 50")
    if carry.trace is None:
        raise PalmbotsError("animation: this carry has no trace; run it with record=True")

    rows, speedup = _rows(carry, fps)
    stage, moments = stage_at(carry, rows, speedup)
    write_video(
        path,
        _frames(stage, moments, on_progress),
        size=stage.size,
        fps=fps,
        colours=COLOURS,
        samples=[stage.frame(moment) for moment in _samples(moments)],
    )


def _rows(carry: Carry, fps: float) -> tuple[np.ndarray, int]:
    """The row of the trace at or before each frame and the last row; and the speedup."""
    assert carry.trace is not None
    times = carry.trace["time"].to_numpy()
    duration = float(times[-1] - times[0])
    speedup = max(1, math.ceil(duration / _LONGEST_S))
    wanted = times[0] + np.arange(int(duration * fps / speedup) + 1) * speedup / fps
    rows = np.searchsorted(times, wanted + 1e-9, side="right") - 1
    return np.unique(np.append(rows, len(times) - 1)), speedup


def stage_at(carry: Carry, rows: np.ndarray, speedup: int = 1) -> tuple[Stage, list[Moment]]:
    """The stage of a carry, and its moments at some rows of the trace."""
    trace = carry.trace
    assert trace is not None
    spec = to_spec(carry.scene, unrolled=True)
    times = trace["time"].to_numpy()
    placement = placements(spec, trace, rows)

    chosen = trace.isel(time=rows).transpose("time", "side", missing_dims="ignore")
    case, sign = chosen["case"].to_numpy(), chosen["sign"].to_numpy()
    motion, contact = chosen["motion"].to_numpy(), chosen["contact"].to_numpy()
    job = carry.floor_job
    moved: list[float] | list[None] = [None] * len(times[rows])
    if job is not None:
        contact = contacts_on_palms(carry.scene, chosen)
        start = placements(spec, trace, np.array([0])).com[0, 0]
        moved = (spec.direction * (placement.com[:, 0] - start)).tolist()
    messages = _messages_shown(carry, times[rows])
    ending = carry.outcome if carry.reason is None else f"{carry.outcome}: {carry.reason}"
    moments = [
        Moment(
            row=k,
            time=time,
            case=(str(case[k, 0]).strip(), str(case[k, 1]).strip()),
            sign=(int(sign[k, 0]), int(sign[k, 1])),
            motion=(int(motion[k, 0]), int(motion[k, 1])),
            contact=(float(contact[k, 0]), float(contact[k, 1])),
            message=messages[k],
            ending=ending if row == len(times) - 1 else None,
            good=carry.outcome == "delivered",
            does=None if job is None else (_doing(job, "left", time), _doing(job, "right", time)),
            moved=moved[k],
        )
        for k, (row, time) in enumerate(zip(rows, times[rows].tolist(), strict=True))
    ]
    name = controller_title(carry.controller)
    title = f"{name}, seed {carry.seed}" + (f", {speedup} × real time" if speedup > 1 else "")
    cases = (carry.controller_entry or describe(carry.controller)).cases
    bars = correction_bars(carry) if job is None else stage_bars(job)
    stage = Stage(spec, placement, bars, float(times[-1]), title, cases)
    return stage, moments


def _doing(job: FloorJob, robot: str, time: float) -> str:
    """What a robot does in a job on the floor, without until when and why."""
    return re.split(r"[;,]| until ", MEANINGS.get(phase_at(job, robot, time), "stands aside"))[0]


def _messages_shown(carry: Carry, times: np.ndarray) -> list[Message | None]:
    """The message to show at each time: the newest one, if it is recent. In a job on the floor, two
    radios send beacons all the time; only those with new content are shown."""
    shown: list[Message | None] = [None] * len(times)
    is_job = carry.floor_job is not None
    for message in (m for m, is_news in message_news(carry) if is_news or not is_job):
        first, last = np.searchsorted(times, [message.sent_s, message.sent_s + _MESSAGE_SHOWN_S])
        text = message.kind if message.received_s is not None else f"{message.kind} (lost)"
        for k in range(int(first), int(last)):
            shown[k] = Message(message.sender, message.receiver, text)
    return shown


def _frames(
    stage: Stage, moments: list[Moment], on_progress: Progress | None
) -> Iterator[Image.Image]:
    for number, moment in enumerate(moments, start=1):
        yield stage.frame(moment)
        if on_progress is not None:
            on_progress(number, len(moments))


def _samples(moments: list[Moment]) -> list[Moment]:
    """Moments from which the palette of a GIF is taken: some spread evenly, some with a case."""
    spread = [moments[k * (len(moments) - 1) // 5] for k in range(6)]
    busy = [moment for moment in moments if any(moment.case)][:6]
    return [*spread, *busy]

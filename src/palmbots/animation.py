"""The carry as a moving picture from the side: an animated GIF, or an MP4 where ffmpeg is found.

The trace is drawn as it is; no physics runs here. A carry of up to a minute runs in real time, a
longer one a whole number of times faster, which its title says. See `sideview` for what is drawn.
"""

import math
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from PIL import Image

from palmbots.errors import PalmbotsError
from palmbots.figure8_story import correction_bars
from palmbots.files import whole_file
from palmbots.geometry import place_rows
from palmbots.gif import GifWriter, palette
from palmbots.lowering import lower
from palmbots.mp4 import encoder_for, write_mp4
from palmbots.sideview import COLOURS, Moment, Stage
from palmbots.sideview_world import Message

if TYPE_CHECKING:
    from palmbots.result import Carry

__all__ = ["save"]

_MESSAGE_SHOWN_S = 0.4
_LAST_FRAME_S = 2.0  # the ending stays readable before the loop starts again
_LONGEST_FILM_S = 60.0  # a longer carry is shown faster

Progress = Callable[[int, int], None]


def save(
    carry: "Carry",
    path: str | os.PathLike[str],
    *,
    fps: float = 10.0,
    progress: Progress | None = None,
) -> None:
    """Write the animation to `path` (.gif or .mp4); the file appears whole or not at all.

    `fps` is frames per second (a GIF counts in hundredths of a second, so 10, 20, 25 and 50 are
    kept exactly). `progress(done, total)` is called after each frame. Raises `PalmbotsError` for
    another suffix, a carry without trace, an unwritable path, or an MP4 without ffmpeg.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".gif", ".mp4"):
        raise PalmbotsError(f"{path}: suffix is {suffix or 'missing'}; allowed: .gif, .mp4")
    if not 1 <= fps <= 50:
        raise PalmbotsError(f"animation: fps is {fps}; allowed: 1 to 50")
    if carry.trace is None:
        raise PalmbotsError("animation: this carry has no trace; run it with record=True")
    encoder = encoder_for(path) if suffix == ".mp4" else ""

    stage, moments = _plan(carry, fps)
    images = _frames(stage, moments, progress)
    with whole_file(path) as stream:
        if suffix == ".gif":
            _write_gif(stage, moments, images, stream, fps)
        else:
            write_mp4(encoder, stage.size, images, stream, fps, path, _LAST_FRAME_S)


def _plan(carry: "Carry", fps: float) -> tuple[Stage, list[Moment]]:
    """The stage and the moments to show: the last row at or before each frame, then the end."""
    trace = carry.trace
    assert trace is not None
    spec = lower(carry.scene, unrolled=True)
    times = trace["time"].to_numpy()
    lasts = float(times[-1] - times[0])
    faster = max(1, math.ceil(lasts / _LONGEST_FILM_S))
    wanted = times[0] + np.arange(int(lasts * fps / faster) + 1) * faster / fps
    rows = np.searchsorted(times, wanted + 1e-9, side="right") - 1
    rows = np.unique(np.append(rows, len(times) - 1))
    placement = place_rows(spec, trace, rows)

    chosen = trace.isel(time=rows).transpose("time", "side", missing_dims="ignore")
    case, sign = chosen["case"].to_numpy(), chosen["sign"].to_numpy()
    motion, contact = chosen["motion"].to_numpy(), chosen["contact"].to_numpy()
    said = _messages_shown(carry, times[rows])
    ending = carry.outcome if carry.reason is None else f"{carry.outcome}: {carry.reason}"
    moments = [
        Moment(
            row=k,
            time=float(times[row]),
            case=(str(case[k, 0]).strip(), str(case[k, 1]).strip()),
            sign=(int(sign[k, 0]), int(sign[k, 1])),
            motion=(int(motion[k, 0]), int(motion[k, 1])),
            contact=(float(contact[k, 0]), float(contact[k, 1])),
            message=said[k],
            ending=ending if k == len(rows) - 1 else None,
            good=carry.outcome == "delivered",
        )
        for k, row in enumerate(rows)
    ]
    name = "no controller" if carry.controller == "none" else f"{carry.controller} algorithm"
    title = f"{name}, seed {carry.seed}" + (f", {faster} × real time" if faster > 1 else "")
    return Stage(spec, placement, correction_bars(carry), float(times[-1]), title), moments


def _messages_shown(carry: "Carry", times: np.ndarray) -> list[Message | None]:
    """For each time the newest message, for as long as it is shown."""
    shown: list[Message | None] = [None] * len(times)
    for letter in carry.letters:
        first, last = np.searchsorted(times, [letter.sent_s, letter.sent_s + _MESSAGE_SHOWN_S])
        text = letter.letter if letter.received_s is not None else f"{letter.letter} (lost)"
        for k in range(int(first), int(last)):
            shown[k] = Message(letter.sender, letter.receiver, text)
    return shown


def _frames(
    stage: Stage, moments: list[Moment], progress: Progress | None
) -> Iterator[Image.Image]:
    for done, moment in enumerate(moments, start=1):
        yield stage.frame(moment)
        if progress is not None:
            progress(done, len(moments))


def _write_gif(
    stage: Stage,
    moments: list[Moment],
    images: Iterator[Image.Image],
    stream: BinaryIO,
    fps: float,
) -> None:
    """One palette for all frames, learnt from a few of them, so that colours never flicker."""
    spread = [moments[k * (len(moments) - 1) // 5] for k in range(6)]
    busy = [m for m in moments if any(m.case)][:6]

    writer = GifWriter(stream, palette(COLOURS, [stage.frame(m) for m in (*spread, *busy)]))
    for k, image in enumerate(images, start=1):
        last = k == len(moments)
        writer.add(image, round(1000 * (_LAST_FRAME_S if last else 1 / fps)))
    writer.close()

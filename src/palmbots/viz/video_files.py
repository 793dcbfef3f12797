# SPDX-License-Identifier: Apache-2.0
"""Writes frames as a video file: MP4 where ffmpeg is found, otherwise an animated GIF."""

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from PIL import Image

from palmbots._util.atomic_files import whole_file
from palmbots.errors import PalmbotsError
from palmbots.viz.gif import GifWriter, palette
from palmbots.viz.mp4 import encoder_for, find_encoder, write_mp4

LAST_FRAME_S = 2.0
"""How long the last frame stays, so that it can be read before the video starts again."""

_FORMATS = (".mp4", ".gif")


def video_formats() -> tuple[str, ...]:
    """The suffixes of videos that can be written on this machine, the preferred one first.

    ``.gif`` is always among them; ``.mp4`` needs ffmpeg, or the package imageio-ffmpeg.
    """
    return _FORMATS if find_encoder() is not None else (".gif",)


def check_video(path: str | os.PathLike[str]) -> None:
    """Check that a video can be written to `path`, before there are frames.

    Raises:
        PalmbotsError: the suffix is not allowed, or MP4 is requested and ffmpeg is missing.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in _FORMATS:
        raise PalmbotsError(
            f"{path}: suffix is {suffix or 'missing'}; allowed: {', '.join(sorted(_FORMATS))}"
        )
    if suffix == ".mp4":
        encoder_for(path)


def write_video(
    path: str | os.PathLike[str],
    frames: Iterable[Image.Image],
    *,
    size: tuple[int, int],
    fps: float,
    colours: Sequence[str],
    samples: Sequence[Image.Image],
) -> None:
    """Write RGB frames of one size to `path`. The file appears only when it is complete.

    Args:
        path: the file, .mp4 or .gif.
        frames: are taken one by one, so that they need not fit into memory together.
        size: width and height in pixels.
        fps: frames per second.
        colours: ("#RRGGBB") that a GIF shows exactly.
        samples: frames from which a GIF takes its other colours.

    Raises:
        PalmbotsError: as `check_video`, the path cannot be written, or ffmpeg fails.
    """
    check_video(path)
    with whole_file(path) as stream:
        if Path(path).suffix.lower() == ".mp4":
            write_mp4(encoder_for(path), size, frames, stream, fps, path, LAST_FRAME_S)
            return
        writer = GifWriter(stream, palette(colours, samples))
        previous: Image.Image | None = None
        for frame in frames:
            if previous is not None:
                writer.add(previous, round(1000 / fps))
            previous = frame
        assert previous is not None
        writer.add(previous, round(1000 * LAST_FRAME_S))
        writer.close()

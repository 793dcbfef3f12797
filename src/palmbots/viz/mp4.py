# SPDX-License-Identifier: Apache-2.0
"""Writes frames as MP4 with the program ffmpeg.

Libraries that encode MP4 contain a copy of ffmpeg: the wheel of PyAV has 36 MB, that of
imageio-ffmpeg 68 MB. Feeding the program through a pipe takes fewer lines than either of their
interfaces, so they are no dependencies. The program of imageio-ffmpeg is used where it is installed
and the system has no ffmpeg.
"""

import contextlib
import importlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from typing import BinaryIO

from PIL import Image

from palmbots.errors import PalmbotsError


def find_encoder() -> str | None:
    """The path of ffmpeg, from the system or from the package imageio-ffmpeg; None: not found."""
    program = shutil.which("ffmpeg")
    if program is not None:
        return program
    try:
        return str(importlib.import_module("imageio_ffmpeg").get_ffmpeg_exe())
    except (ImportError, RuntimeError):  # RuntimeError: the package has no program for this system
        return None


def encoder_for(path: str | os.PathLike[str]) -> str:
    """The path of ffmpeg.

    Raises:
        PalmbotsError: ffmpeg is not found; the message names the video and the alternatives.
    """
    program = find_encoder()
    if program is None:
        raise PalmbotsError(
            f"{path}: MP4 needs the program ffmpeg, which is not found; install it (apt install "
            "ffmpeg, or pip install imageio-ffmpeg), or write .gif"
        )
    return program


def write_mp4(
    encoder: str,
    size: tuple[int, int],
    images: Iterable[Image.Image],
    stream: BinaryIO,
    fps: float,
    path: str | os.PathLike[str],
    last_s: float,
) -> None:
    """Pipe raw frames into ffmpeg, which writes to the temporary file of `stream` by its name.

    The last frame stays for `last_s` seconds.

    Raises:
        PalmbotsError: ffmpeg failed; the message contains its last line.
    """
    wide, high = size
    command = [
        encoder, "-loglevel", "error", "-y",
        "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{wide}x{high}", "-r", f"{fps:g}", "-i", "-",
        "-vf", f"tpad=stop_mode=clone:stop_duration={last_s:g}",
        "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart",
        "-f", "mp4", stream.name,
    ]  # fmt: skip
    with (
        tempfile.TemporaryFile() as errors,
        subprocess.Popen(command, stdin=subprocess.PIPE, stderr=errors) as process,
    ):
        assert process.stdin is not None
        try:
            for image in images:
                process.stdin.write(image.tobytes())
            process.stdin.close()
        except BrokenPipeError:  # ffmpeg has ended; its error message is read below
            with contextlib.suppress(BrokenPipeError):
                process.stdin.close()
        except BaseException:
            process.kill()
            raise
        code = process.wait()
        errors.seek(0)
        lines = errors.read().decode(errors="replace").split("\n")
    if code != 0:
        reason = next((line for line in reversed(lines) if line.strip()), f"exit code {code}")
        raise PalmbotsError(f"{path}: ffmpeg could not write the video: {reason}")

"""Pictures to an MP4 film, by the program ffmpeg."""

import contextlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from typing import BinaryIO

from PIL import Image

from palmbots.errors import PalmbotsError

__all__ = ["encoder_for", "write_mp4"]


def encoder_for(path: str | os.PathLike[str], instead: str = "use .gif") -> str:
    """Where ffmpeg is. Raises `PalmbotsError`, naming the film and what to do, where it is not."""
    found = shutil.which("ffmpeg")
    if found is None:
        raise PalmbotsError(f"{path}: MP4 needs the program ffmpeg, which is not found; {instead}")
    return found


def write_mp4(
    encoder: str,
    size: tuple[int, int],
    images: Iterable[Image.Image],
    stream: BinaryIO,
    fps: float,
    path: str | os.PathLike[str],
    last_s: float,
) -> None:
    """Feed ffmpeg raw frames; it writes into the temporary file, for which it needs the name.

    The last frame stays for `last_s` seconds. Raises `PalmbotsError` where ffmpeg gives up.
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
        tempfile.TemporaryFile() as complaints,
        subprocess.Popen(command, stdin=subprocess.PIPE, stderr=complaints) as process,
    ):
        assert process.stdin is not None
        try:
            for image in images:
                process.stdin.write(image.tobytes())
            process.stdin.close()
        except BrokenPipeError:  # ffmpeg gave up; what it says follows
            with contextlib.suppress(BrokenPipeError):
                process.stdin.close()
        except BaseException:
            process.kill()
            raise
        code = process.wait()
        complaints.seek(0)
        said = complaints.read().decode(errors="replace").split("\n")
    if code != 0:
        reason = next((line for line in reversed(said) if line.strip()), f"exit code {code}")
        raise PalmbotsError(f"{path}: ffmpeg could not write the film: {reason}")

# SPDX-License-Identifier: Apache-2.0
"""`palmbots carry --video` without ffmpeg: a GIF instead, announced before the work."""

import os
from pathlib import Path

import pytest
from PIL import Image

from commands import Run, unwrapped

COMMAND = (
    "carry", "--seeds", "1", "--world", "mujoco", "--video", "--animation", "none",
    "--set", "task.distance_m=0.01",
)  # fmt: skip


@pytest.fixture
def without_ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A search path on which no program can be found."""
    monkeypatch.setenv("PATH", str(tmp_path / "no-programs"))


@pytest.mark.slow
@pytest.mark.usefixtures("without_ffmpeg")
def test_video_without_ffmpeg_is_a_gif(here: Run, tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = here(*COMMAND, "--out", str(out))
    assert result.returncode == 0
    (line,) = [line for line in unwrapped(result.stderr).splitlines() if "ffmpeg" in line]
    assert "carry-3d.gif" in line and line.startswith("palmbots: warning: ")
    names = {path.name for path in out.iterdir()}
    assert {"carry-3d.png", "carry-3d.gif"} <= names and "carry-3d.mp4" not in names
    with Image.open(out / "carry-3d.gif") as video, Image.open(out / "carry-3d.png") as still:
        assert video.size == still.size
        assert getattr(video, "n_frames", 1) > 2
        shown = video.convert("RGB").getpixel((3, 3))
        wanted = still.convert("RGB").getpixel((3, 3))
    assert isinstance(shown, tuple) and isinstance(wanted, tuple)
    assert max(abs(a - b) for a, b in zip(shown, wanted, strict=True)) < 40


@pytest.mark.usefixtures("without_ffmpeg")
def test_missing_ffmpeg_is_announced_before_the_carry(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("palmbots.assessment.carry_command.carry", stop)
    result = here(*COMMAND, "--out", str(tmp_path / "out"))
    assert result.returncode == 130
    assert "carry-3d.gif" in unwrapped(result.stderr).splitlines()[0]


@pytest.mark.usefixtures("without_ffmpeg")
def test_main_job_needs_no_ffmpeg(here: Run, tmp_path: Path) -> None:
    """The files of ``make carry``."""
    makefile = (Path(__file__).parent.parent.parent / "Makefile").read_text()
    (line,) = [line for line in makefile.splitlines() if "palmbots carry --out" in line]
    assert "--video" not in line and "mp4" not in line
    result = here("carry", "--set", "task.distance_m=0.03", "--out", str(tmp_path / "out"))
    assert (result.returncode, result.stderr) == (0, "")
    assert os.path.getsize(tmp_path / "out" / "carry.gif") > 1000

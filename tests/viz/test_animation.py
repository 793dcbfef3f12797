# SPDX-License-Identifier: Apache-2.0
"""The film of a carry: its frames, times and sizes, read back from the file."""

import itertools
import json
import shutil
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image, ImageSequence

import palmbots as pb
from palmbots import viz
from palmbots.errors import PalmbotsError
from palmbots.simulation.floor_job import MEANINGS
from palmbots.viz.animation import save_animation, stage_at
from palmbots.viz.gif import GifWriter, palette
from palmbots.viz.timeline import message_news, stage_bars


@pytest.fixture(scope="module")
def short():
    return pb.carry("paper", "distributed", seed=0, overrides={"task.distance_m": 0.1})


def frames_of(path):
    with Image.open(path) as film:
        return [
            (frame.convert("RGB"), frame.info["duration"]) for frame in ImageSequence.Iterator(film)
        ]


@pytest.mark.parametrize(
    "controller",
    ["distributed", *(pytest.param(c, marks=pytest.mark.soak) for c in ("none", "centralized"))],
)
def test_gif_runs_in_real_time(tmp_path, controller):
    done = pb.carry("paper", controller, seed=0, overrides={"task.distance_m": 0.2})
    assert done.trace is not None
    reports: list[tuple[int, int]] = []
    save_animation(done, tmp_path / "c.gif", on_progress=lambda *report: reports.append(report))
    frames = frames_of(tmp_path / "c.gif")
    last = float(done.trace["time"][-1])
    assert len(frames) == int(last * 10) + 2  # one every 0.1 s, and the end
    assert {duration for _, duration in frames[:-1]} == {100}
    assert frames[-1][1] == 2000
    assert reports == [(k + 1, len(frames)) for k in range(len(frames))]
    assert frames[0][0].width == 900
    assert frames[0][0].tobytes() != frames[-1][0].tobytes()


@pytest.mark.soak
def test_animation_of_the_paper_carry_is_small(tmp_path):
    save_animation(pb.carry("paper", seed=1), tmp_path / "c.gif")
    assert (tmp_path / "c.gif").stat().st_size < 4e6


def test_the_same_carry_gives_the_same_file(tmp_path, short):
    for name in ("a.gif", "b.gif"):
        save_animation(short, tmp_path / name)
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()


@pytest.mark.parametrize(
    "overrides",
    [
        {"task.direction": "backward", "task.slope_deg": 2.0},
        {"palm.pivot_offset_m": 0.01, "control.period_s": 0.2, "control.watchdog_s": 1.0},
        {"tactile.zones": [], "palm.left.length_m": 0.3},
        {"task.slope_deg": 20.0},  # dropped before the first tick
        {"start.left_m": 0.075},  # dropped in it
        {
            "object.vertices_m": [[0, 0], [3, 0], [1, 4]],
            "object.com_m": [1.5, 1],
            "object.mass_kg": 0.25,
        },
    ],
)
def test_unusual_scenes(tmp_path, overrides):
    done = pb.carry("paper", "none", overrides={"task.distance_m": 0.1, **overrides})
    save_animation(done, tmp_path / "c.gif", fps=5)
    assert frames_of(tmp_path / "c.gif")


def test_long_carry_is_shown_faster(tmp_path):
    slow = {"task.distance_m": 1.5, "robot.speed_m_s": 0.01}  # 150 s, shown in 50
    done = pb.carry("paper", "distributed", overrides=slow)
    save_animation(done, tmp_path / "c.gif", fps=1)
    assert len(frames_of(tmp_path / "c.gif")) == pytest.approx(done.time_s / 3, abs=3)


def test_frames_survive_the_gif(tmp_path):
    """Only what changed is written, and yet every frame reads back as it was."""
    colours = ["#000000", "#FF0000", "#00FF00", "#0000FF", "#FFFFFF"]
    table = np.array([tuple(bytes.fromhex(c[1:])) for c in colours], np.uint8)
    random = np.random.default_rng(0)
    images, now = [], random.integers(0, 5, (40, 60))
    for k in range(8):
        x, y = random.integers(0, 30, 2)
        now = now.copy()
        if k != 3:  # one frame stays as it was
            now[y : y + 9, x : x + 20] = random.integers(0, 5, (9, 20))
        images.append(Image.fromarray(table[now]))
    with open(tmp_path / "c.gif", "wb") as stream:
        writer = GifWriter(stream, palette(colours, images[:1]))
        for image in images:
            writer.add(image, 40)
        writer.close()
    read = frames_of(tmp_path / "c.gif")
    assert [frame.tobytes() for frame, _ in read] == [image.tobytes() for image in images]
    assert {duration for _, duration in read} == {40}


def test_too_large_palette_is_refused(tmp_path):
    full = Image.new("P", (1, 1))
    full.putpalette(list(itertools.repeat(0, 768)))
    with open(tmp_path / "c.gif", "wb") as stream, pytest.raises(ValueError, match="at most 255"):
        GifWriter(stream, full)


def test_mp4_has_every_frame(tmp_path, short):
    save_animation(short, tmp_path / "c.mp4")
    command = ["ffprobe", "-v", "error", "-count_frames", "-show_streams", "-of", "json"]
    probe = subprocess.run([*command, tmp_path / "c.mp4"], capture_output=True, check=True)
    stream = json.loads(probe.stdout)["streams"][0]
    shown = int(float(short.trace["time"][-1]) * 10) + 2
    assert int(stream["nb_read_frames"]) == pytest.approx(shown + 20, abs=1)
    assert (stream["width"], stream["pix_fmt"]) == (900, "yuv420p")


def test_formats_without_ffmpeg(tmp_path, short, monkeypatch):
    assert viz.video_formats() == (".mp4", ".gif")
    monkeypatch.setattr(shutil, "which", lambda _: None)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    assert viz.video_formats() == (".gif",)
    save_animation(short, tmp_path / f"c{viz.video_formats()[0]}")
    shown = int(float(short.trace["time"][-1]) * 10) + 2  # the last frame is held, not repeated
    assert len(frames_of(tmp_path / "c.gif")) == pytest.approx(shown, abs=1)


def test_ffmpeg_of_the_package_imageio_ffmpeg_is_used(tmp_path, short, monkeypatch):
    program = shutil.which("ffmpeg")
    monkeypatch.setattr(shutil, "which", lambda _: None)
    package = SimpleNamespace(get_ffmpeg_exe=lambda: program)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", package)
    assert viz.video_formats() == (".mp4", ".gif")
    save_animation(short, tmp_path / "c.mp4")
    assert (tmp_path / "c.mp4").read_bytes()[4:8] == b"ftyp"


def test_error_of_ffmpeg_is_reported(tmp_path, short, monkeypatch):
    broken = tmp_path / "ffmpeg"
    broken.write_text("#!/bin/sh\necho no such encoder >&2\nexit 3\n")
    broken.chmod(0o755)
    monkeypatch.setattr(shutil, "which", lambda _: str(broken))
    with pytest.raises(PalmbotsError, match="could not write the video: no such encoder"):
        save_animation(short, tmp_path / "c.mp4")
    assert list(tmp_path.iterdir()) == [broken]


def test_interrupted_animation_leaves_no_file(tmp_path, short):
    def interrupt(done, total):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        save_animation(short, tmp_path / "c.gif", on_progress=interrupt)
    assert list(tmp_path.iterdir()) == []


def test_a_job_on_the_floor_is_shown_by_its_phases():
    """Each frame has the phase of each robot, no contact where nothing is on a palm, and only
    messages with new content; the time axis has the stages."""
    done = pb.carry("lift", "shared-sign")
    job, trace = done.floor_job, done.trace
    assert job is not None and trace is not None
    times = trace["time"].to_numpy()
    _, (first, last) = stage_at(done, np.array([0, len(times) - 1]))
    assert (first.moved, last.moved) == (0, pytest.approx(job.moved_m, abs=1e-3))
    _, moments = stage_at(done, np.arange(0, len(times), 200))
    for moment in moments:
        for k, side in enumerate(("left", "right")):
            phase = next(
                p for p in job.phases if p.robot == side and p.start_s <= moment.time < p.end_s
            )
            assert moment.does is not None
            assert MEANINGS[phase.phase].startswith(moment.does[k])
            stands_off = phase.phase in ("empty", "retreat") or moment.time == 0
            assert not stands_off or np.isnan(moment.contact[k])
            assert phase.phase != "carry" or abs(moment.contact[k]) < 0.02
    said: dict[str, list[str]] = {"left": [], "right": []}
    for message, is_news in message_news(done):
        if is_news and message.kind in ("Docking", "Under", "Centring", "Ready", "Raising"):
            said[message.sender].append(message.kind)
    assert said["left"] == ["Docking", "Under", "Centring", "Ready", "Raising"]
    names = ["dock", "centre", "raise", "carry", "lower", "leave"]
    assert [bar.text for bar in stage_bars(job)] == names + names

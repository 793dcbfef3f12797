# SPDX-License-Identifier: Apache-2.0
"""Films and stills of the dynamic world: looked at, not only found."""

import json
import os
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

import at_call
import palmbots as pb
from commands import Run, assert_refused
from palmbots.cli import INTERRUPTION_LINE
from palmbots.mujoco import film
from palmbots.mujoco.film import (
    VideoRenderer,
    check_film,
    most_informative_row,
    save_still,
    save_video,
)
from palmbots.mujoco.overlay import METRES_PER_NEWTON, Overlay
from palmbots.simulation.result import Carry
from sampled import in_soak

pytestmark = pytest.mark.slow

SMALL, TINY = (480, 270), (240, 136)


@pytest.fixture(autouse=True)
def few_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half as many: films last as long, and no test is about their number."""
    monkeypatch.setitem(film._FPS, ".mp4", 10.0)


@pytest.fixture(scope="module")
def done() -> Carry:
    return pb.carry("paper", world="mujoco", overrides={"task.distance_m": 0.08})


def count(image: Image.Image, near: tuple[int, int, int], within: int = 40) -> int:
    """Pixels of about this colour."""
    apart = np.abs(np.asarray(image, dtype=int) - np.array(near)).max(axis=2)
    return int((apart <= within).sum())


def place(image: Image.Image, near: tuple[int, int, int], within: int = 40) -> np.ndarray:
    """The middle of the pixels of about this colour, in shares of width and height."""
    apart = np.abs(np.asarray(image, dtype=int) - np.array(near)).max(axis=2)
    rows, columns = np.nonzero(apart <= within)
    return np.array([columns.mean() / image.width, rows.mean() / image.height])


BOX, LEFT_PALM, RIGHT_PALM, WHEEL = (212, 180, 100), (0, 95, 150), (186, 82, 5), (26, 26, 26)


def test_picture_shows_box_palms_and_wheels_in_place(done: Carry) -> None:
    with VideoRenderer(done, SMALL) as studio:
        image = studio.picture(50)
    assert image.size == SMALL
    whole = SMALL[0] * SMALL[1]
    assert 0.04 * whole < count(image, BOX) < 0.2 * whole
    box, left, right = (place(image, colour) for colour in (BOX, LEFT_PALM, RIGHT_PALM))
    assert box[0] == pytest.approx(0.5, abs=0.05)
    assert left[0] < box[0] < right[0]
    assert box[1] < left[1] == pytest.approx(right[1], abs=0.03)  # palms below the box
    assert place(image, WHEEL, 12)[1] > left[1]


def test_cones_and_forces_are_drawn_in(done: Carry, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without them the picture lacks their colours; a contact that slides has another one."""
    green, purple = (0, 158, 115), (204, 121, 167)
    assert done.trace is not None
    motion = done.trace["motion"].transpose("time", "side").to_numpy()
    sticks = int(np.nonzero((motion == 0).all(axis=1))[0][5])
    slides = int(np.nonzero((motion != 0).any(axis=1))[0][20])
    with VideoRenderer(done, (854, 480)) as studio:
        still, sliding = studio.picture(sticks), studio.picture(slides)
        monkeypatch.setattr(Overlay, "contacts", lambda *_: None)
        bare = studio.picture(sticks)
    assert count(still, green, 60) > count(bare, green, 60) + 100
    assert count(sliding, purple, 60) > count(bare, purple, 60) + 30


def test_walls_of_a_route_stand_behind_the_pair(done: Carry) -> None:
    assert done.mujoco_record is not None
    walls = ((-0.4, 0.5, 0.4, 0.5),)
    walled = replace(done, mujoco_record=replace(done.mujoco_record, walls_m=walls))
    with VideoRenderer(done, SMALL) as studio, VideoRenderer(walled, SMALL) as other:
        bare, shown = (np.asarray(one.picture(1), dtype=int) for one in (studio, other))
    rows, columns = np.nonzero(np.abs(shown - bare).max(axis=2) > 10)
    assert len(rows) > 0.02 * bare.shape[0] * bare.shape[1]
    assert columns.mean() / bare.shape[1] == pytest.approx(0.5, abs=0.1)


def test_title_states_the_slope() -> None:
    keys = {"task.distance_m": 0.001, "task.slope_deg": -3.0}
    with VideoRenderer(pb.carry("paper", world="mujoco", overrides=keys), SMALL) as studio:
        assert studio.name.endswith("MuJoCo, 3° downhill")


def test_forces_drawn_are_the_weight(done: Carry, monkeypatch: pytest.MonkeyPatch) -> None:
    bars = []
    monkeypatch.setattr(Overlay, "bar", lambda *a: bars.append(a[2:]))
    with VideoRenderer(done, SMALL) as studio:
        studio.picture(1)
    shafts = [end - start for width, start, end, _ in bars if width == 0.0025][::3]
    assert len(shafts) == 2
    up = sum(shaft[2] for shaft in shafts) / METRES_PER_NEWTON
    assert up == pytest.approx(0.5 * 9.80665, rel=0.05)


def test_video_lasts_as_long_as_the_carry(done: Carry, tmp_path: Path) -> None:
    seen: list[float] = []
    save_video(done, tmp_path / "c.mp4", size=TINY, on_progress=seen.append)
    asked = "stream=width,height:format=duration"
    probe = subprocess.run(
        ["ffprobe", "-v", "error", "-show_entries", asked, "-of", "json", tmp_path / "c.mp4"],
        capture_output=True, check=True,
    )  # fmt: skip
    facts = json.loads(probe.stdout)
    assert (facts["streams"][0]["width"], facts["streams"][0]["height"]) == TINY
    assert float(facts["format"]["duration"]) == pytest.approx(done.time_s + 2.0, abs=0.2)
    assert seen == sorted(seen) and seen[-1] == 1.0
    # The pair drives over the floor: frames differ, and the last one has the ending.
    frame = tmp_path / "last.png"
    subprocess.run(
        ["ffmpeg", "-v", "error", "-sseof", "-0.5", "-i", tmp_path / "c.mp4",
         "-frames:v", "1", "-update", "1", frame], check=True,
    )  # fmt: skip
    with VideoRenderer(done, TINY) as studio:
        first, last = studio.picture(0), studio.picture(len(studio._times) - 1)
    with Image.open(frame) as image:
        shown = np.asarray(image.convert("RGB"), dtype=int)
    assert np.abs(shown - np.asarray(last)).mean() < 4 < np.abs(shown - np.asarray(first)).mean()


def test_still_shows_the_first_correction(done: Carry, tmp_path: Path) -> None:
    first = done.corrections[0]
    assert first.start_s <= most_informative_row(done) * 0.01 <= first.end_s
    save_still(done, tmp_path / "c.png", size=SMALL)
    with Image.open(tmp_path / "c.png") as image:
        assert image.size == SMALL
    quiet = pb.carry("paper", "none", world="mujoco", overrides={"task.distance_m": 0.02})
    assert 0 < most_informative_row(quiet) < 100


def test_gif_is_written_without_ffmpeg(
    done: Carry, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    check_film(tmp_path / "c.gif")
    with pytest.raises(pb.PalmbotsError, match="MP4 needs the program ffmpeg"):
        check_film(tmp_path / "c.mp4")
    save_video(done, tmp_path / "c.gif", size=TINY)
    with Image.open(tmp_path / "c.gif") as image:
        assert image.size == TINY
        durations = [frame.info["duration"] for frame in ImageSequence.Iterator(image)]
        image.seek(0)
        first = np.asarray(image.convert("RGB"), dtype=int)
    assert sum(durations) == pytest.approx(1000 * (done.time_s + 2.0), abs=200)
    with VideoRenderer(done, TINY) as renderer:
        rendered = np.asarray(renderer.picture(0), dtype=int)
    assert np.abs(first - rendered).mean() < 4


@pytest.mark.parametrize(
    ("option", "environment", "message"),
    [
        ("--video", {"MUJOCO_GL": "disable"}, "video: cannot render: "),
        in_soak("--video", {"MUJOCO_GL": "glfw", "DISPLAY": ""}, "video: cannot render: "),
        ("--video", {"MUJOCO_GL": "magic"}, "MUJOCO_GL: magic; allowed: egl, osmesa or unset"),
        in_soak("--view", {"DISPLAY": "", "WAYLAND_DISPLAY": ""}, "--view: there is no screen"),
    ],
)
def test_missing_screen_or_renderer_is_refused_in_one_line(
    option: str, environment: dict[str, str], message: str, tmp_path: Path
) -> None:
    """Before it carries, and with nothing written, not even MuJoCo's own log."""
    ran = subprocess.run(
        [sys.executable, "-m", "palmbots", "carry", "--world", "mujoco", option, "--out", "."],
        env=os.environ | environment, capture_output=True, text=True, check=False, cwd=tmp_path,
    )  # fmt: skip
    assert (ran.returncode, ran.stdout) == (2, "")
    assert ran.stderr.count("\n") == 1 and message in ran.stderr
    assert list(tmp_path.iterdir()) == []


def test_screen_that_does_not_answer_is_refused_in_one_line(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DISPLAY", ":9999")
    ran = here("carry", "--world", "mujoco", "--view", "--out", ".")
    assert_refused(ran, "--view: the screen :9999 does not answer")
    assert list(tmp_path.iterdir()) == []


def test_interrupted_video_leaves_no_partial_file(tmp_path: Path) -> None:
    """Ctrl-C, which a terminal sends to ffmpeg too, after the still and five frames."""
    process = subprocess.Popen(
        at_call.command(
            "SIGSTOP", "after", VideoRenderer.picture, 6, "carry", "--world", "mujoco", "--video",
            "--animation", "none", "--out", tmp_path, "--set", "task.distance_m=0.02",
        ),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    at_call.wait_until_stopped(process)
    assert list(tmp_path.glob("*.part"))
    os.killpg(process.pid, signal.SIGINT)
    process.send_signal(signal.SIGCONT)
    output = process.communicate(timeout=60)
    assert (process.returncode, *output) == (130, "", f"{INTERRUPTION_LINE}\n")
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"carry.png", "carry.mcap", "carry-3d.png"}


def test_the_command_prints_one_object_and_writes_everything(here: Run, tmp_path: Path) -> None:
    """On a curved path, so that there is a plan, too."""
    command = ["carry", "--out", str(tmp_path), "--animation", "none", "--set=task.distance_m=0.02"]
    curved = ["--set=task.path.kind=arc", "--set=task.path.radius_m=0.5"]
    ran = here(*command, "--world", "mujoco", *curved, "--video", "--json")
    assert ran.returncode == 0, ran.stderr
    result = json.loads(ran.stdout)
    assert (result["world"], result["outcome"]) == ("mujoco", "delivered")
    assert result["scene"]["mujoco"]["body_kg"] == 3.0
    of_mujoco = {"carry-3d.mp4", "carry-3d.png", "plan.png"}
    assert of_mujoco | {"carry.png", "carry.mcap"} <= {p.name for p in tmp_path.iterdir()}
    # Of the next carry it would be the wrong film, and the wrong plan.
    ran = here(*command)
    assert ran.returncode == 0, ran.stderr
    assert not of_mujoco & {p.name for p in tmp_path.iterdir()}
    words = " ".join(ran.stdout.split())
    for name in of_mujoco:
        assert f"{name} of an earlier carry" in words

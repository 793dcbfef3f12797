# SPDX-License-Identifier: Apache-2.0
"""MuJoCo's viewer on a real (virtual) screen, EGL and OSMesa, the progress bar of a terminal."""

import json
import os
import pty
import re
import struct
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import at_call
import palmbots as pb
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.film import save_still
from palmbots.mujoco.viewer import Viewer
from waiting import wait_until

pytestmark = pytest.mark.slow

CARRY = [sys.executable, "-m", "palmbots", "carry", "--world", "mujoco"]
BOX = (212, 180, 100)
GREEN, PURPLE = np.array((0, 158, 115)), np.array((204, 121, 167))


def count(pixels: np.ndarray) -> int:
    """Pixels that look like the box."""
    return int((np.abs(pixels.astype(int) - np.array(BOX)).max(axis=2) <= 40).sum())


def cones(pixels: np.ndarray) -> int:
    """Pixels that look like a friction cone, sticking or sliding."""
    near = [np.abs(pixels.astype(int) - c).max(axis=2) <= 40 for c in (GREEN, PURPLE)]
    return int((near[0] | near[1]).sum())


def seen(screen: Path) -> np.ndarray:
    """What Xvfb shows now: its framebuffer is a file in the format XWD."""
    raw = screen.read_bytes()
    head = struct.unpack(">25I", raw[:100])
    start, wide, high, bits, row, colours = (head[k] for k in (0, 4, 5, 11, 12, 19))
    assert bits == 32
    place = start + 12 * colours
    rows = np.frombuffer(raw, np.uint8, high * row, place).reshape(high, row // 4, 4)
    return rows[:, :wide, 2::-1]


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[tuple[str, Path]]:
    """A screen of its own: the value of DISPLAY, and the file that holds what it shows."""
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "500x350x24", "-fbdir", str(tmp_path)],
        pass_fds=[write], stderr=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(write)
    with os.fdopen(read) as pipe:
        number = pipe.readline().strip()
    try:
        yield f":{number}", tmp_path / "Xvfb_screen0"
    finally:
        server.terminate()
        server.wait()


def test_the_viewer_shows_the_carry_and_closes_in_peace(
    screen: tuple[str, Path], tmp_path: Path
) -> None:
    display, shown = screen
    assert count(seen(shown)) == 0
    # The carry waits in its middle, and the window is drawn by a thread of its own.
    go_on = tmp_path / "go-on"
    words = ("carry", "--world", "mujoco", "--view", "--json", "--set", "task.distance_m=0.04")
    run = subprocess.Popen(
        at_call.command(go_on, "after", Viewer.show, 30, *words),
        env=os.environ | {"DISPLAY": display}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip

    def is_drawn() -> bool:
        pixels = seen(shown)[::2, ::2]  # looked at again and again, while the program starts
        return 300 < count(pixels) < 12_500 and cones(pixels) > 6  # of 43,750

    wait_until(is_drawn)
    go_on.touch()
    out, err = run.communicate()
    assert (run.returncode, err) == (0, "")
    assert json.loads(out)["outcome"] == "delivered"
    assert count(seen(shown)) == 0  # the window is gone


def test_egl_and_osmesa_draw_the_same(tmp_path: Path) -> None:
    """The library that draws is the one asked for, and it makes no difference to see."""
    mujoco()
    own = os.environ["MUJOCO_GL"]  # of this process: what draws without a wish
    other = {"egl": "osmesa", "osmesa": "egl"}[own]
    program = (
        "import sys, palmbots as pb\n"
        "from palmbots.mujoco.film import save_still\n"
        "done = pb.carry(world='mujoco', overrides={'task.distance_m': 0.02})\n"
        "save_still(done, sys.argv[1], size=(480, 270))\n"
        "print(*(k for k in ('egl', 'osmesa') if f'mujoco.{k}' in sys.modules))\n"
    )
    # MuJoCo writes its choice of library there, too; a test before may have made it draw.
    clean = {k: v for k, v in os.environ.items() if k != "PYOPENGL_PLATFORM"}
    process = subprocess.Popen(
        [sys.executable, "-c", program, tmp_path / f"{other}.png"],
        env=clean | {"MUJOCO_GL": other}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    done = pb.carry(world="mujoco", overrides={"task.distance_m": 0.02})
    save_still(done, tmp_path / f"{own}.png", size=(480, 270))
    assert [k for k in ("egl", "osmesa") if f"mujoco.{k}" in sys.modules] == [own]
    out, err = process.communicate()
    assert (process.returncode, out.split()) == (0, [other]), err
    pictures = []
    for kind in (own, other):
        with Image.open(tmp_path / f"{kind}.png") as image:
            pictures.append(np.asarray(image.convert("RGB")).astype(int))
    assert count(pictures[0]) > 3_200  # a fortieth of them
    assert np.abs(pictures[0] - pictures[1]).mean() < 2


def test_terminal_shows_the_speed_relative_to_real_time() -> None:
    ours, theirs = pty.openpty()
    run = subprocess.Popen(
        [*CARRY, "--set", "task.distance_m=0.5"], stdout=subprocess.DEVNULL, stderr=theirs,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "100"},
    )  # fmt: skip
    os.close(theirs)
    output = b""
    try:
        while piece := os.read(ours, 4096):
            output += piece
    except OSError:  # Linux reports the closed other end in this way
        pass
    os.close(ours)
    assert run.wait() == 0
    factors = [float(x) for x in re.findall(r"carrying, ([\d.]+) × real time", output.decode())]
    assert factors and 0.1 < factors[-1] < 1000

# SPDX-License-Identifier: Apache-2.0
"""The images, compiled once for all tests here, and a pair whose robots are boards."""

import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from cxx import ROOT
from emulator.__main__ import robot_image
from emulator.board import Image
from palmbots.boards.pair_settings import BoardPair, board_pair
from palmbots.pair.pair_file import init_pair, load_pair
from waiting import locked

IMAGES = ROOT / "build" / "firmware"


def compiled(folder: Path, *options: str) -> Path:
    """The folder of the programs, compiled again if a source is newer."""
    sources = [*(ROOT / "firmware").rglob("*.[ch]pp"), *(ROOT / "include").rglob("*.hpp")]
    newest = max(file.stat().st_mtime for file in [*sources, ROOT / "firmware" / "build.py"])
    made = folder / "robot.hex"
    folder.mkdir(parents=True, exist_ok=True)
    with locked(folder / "lock"):  # another process of the tests may want them too
        if not made.exists() or made.stat().st_mtime < newest:
            command = [sys.executable, str(ROOT / "firmware" / "build.py"), "--out", str(folder)]
            subprocess.run([*command, *options], check=True)
    return folder


@pytest.fixture(scope="session")
def image() -> Image:
    return robot_image(compiled(IMAGES))


@pytest.fixture(scope="session")
def clang_image(image: Image) -> Image:
    return robot_image(compiled(IMAGES / "clang", "--compiler", "clang"))


@pytest.fixture(scope="session")
def second_program() -> Path:
    """The program of a robot for the second board."""
    return compiled(IMAGES / "mps2", "--target", "mps2") / "robot.hex"


def make_boards(
    folder: Path,
    controller: str = "resilient",
    overrides: dict[str, Any] | None = None,
    values: dict[str, Any] | None = None,
    scene: str = "paper",
) -> BoardPair:
    """A pair that two boards can run without a station."""
    own = pb.load_scene(scene, {"task.distance_m": 0.3} | (overrides or {}))
    (folder / "scene.toml").write_text(own.to_toml())
    chosen = {
        "limits.station_lost": "carry-on",
        "limits.after_reboot": "rejoin",
        "limits.partner_lost": "controller",
        "hardware.acceleration_m_s2": 1000.0,
    } | (values or {})
    file = init_pair(
        folder / "pair.toml", scene="scene.toml", controller=controller, values=chosen
    )[0]
    return board_pair(load_pair(file))


@pytest.fixture
def boards(tmp_path: Path) -> Callable[..., BoardPair]:
    """Makes a pair in a folder of the test."""
    return partial(make_boards, tmp_path)


@pytest.fixture(scope="session")
def boards_in() -> Callable[..., BoardPair]:
    """Makes a pair in a given folder."""
    return make_boards

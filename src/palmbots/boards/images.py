# SPDX-License-Identifier: Apache-2.0
"""Images for the boards of a pair: ready-made programs with the pair's settings put in."""

import io
import os
from collections.abc import Callable
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

from palmbots._util.atomic_files import folder, write_whole
from palmbots._util.command import Option, command
from palmbots._util.optional_imports import require
from palmbots.boards.pair_settings import BOOTS_PER_IMAGE, BoardPair, board_pair
from palmbots.boards.settings_page import PAGE_ADDRESS, PAGE_SIZE
from palmbots.drivers.hardware import Hardware
from palmbots.errors import PalmbotsError
from palmbots.pair.pair_file import load_pair
from palmbots.pair.stored_state import held, read_state, write_state
from palmbots.wire import MAX_EPOCH

PROGRAMS = ("robot", "dongle")
"""The ready-made programs; a robot's serves both sides."""


def program(name: str) -> Any:
    """A ready-made program of the package, as an ``IntelHex`` object."""
    intelhex = require("intelhex", "firmware")
    text = (resources.files("palmbots.boards") / "data" / f"{name}.hex").read_text("ascii")
    return intelhex.IntelHex(io.StringIO(text))


def image_with(name: str, page: bytes) -> str:
    """A ready-made program with a page of settings, as text in Intel's hexadecimal format."""
    assert len(page) == PAGE_SIZE
    image = program(name)
    del image[PAGE_ADDRESS : PAGE_ADDRESS + PAGE_SIZE]
    content = page.rstrip(b"\xff")
    image.puts(PAGE_ADDRESS, content.ljust(-(-len(content) // 4) * 4, b"\xff"))
    image.start_addr = None
    text = io.StringIO()
    image.write_hex_file(text)
    return text.getvalue()


@command(
    "firmware",
    order=214,
    example="palmbots firmware pair.toml --out images",
    pair_file=Option(is_argument=True, metavar="PAIR"),
    out=Option(metavar="DIR"),
)
def write_images(
    pair_file: str | os.PathLike[str],
    out: str | os.PathLike[str] = "firmware",
    *,
    on_warning: Callable[[str], None] | None = None,
) -> list[Path]:
    """Make images for boards that are the robots of a pair.

    left.hex and right.hex are the robots, dongle.hex is the radio of the station. A robot that
    stands aside has no image. No compiler is needed. Each image counts boots of its own: flash it
    into one board, once.

    Args:
        pair_file: the pair.toml of both robots.
        out: folder for the images. Those of an earlier call are replaced.
        on_warning: called with a sentence if the file says nothing about the robots.

    Note:
        The images hold the key, so only their owner can read them.

    Returns:
        The files.

    Raises:
        PalmbotsError: the pair cannot run on boards, or a file cannot be read or written.
    """
    pair = load_pair(pair_file)
    boards = board_pair(pair)
    program("robot")  # a missing package is reported before anything is written
    is_unedited = pair.settings.hardware.model_dump() == Hardware().model_dump()
    if on_warning is not None and is_unedited:
        on_warning(
            f"{pair.file}: all keys of [hardware] have their defaults; measure your robots and "
            "write their values before you flash (wheels, palm, full_speed_m_s)"
        )
    out = folder(out)
    written = []
    for side in boards.scene.working_sides:
        file = pair.state_file(side)
        with held(file):
            state = read_state(file)
            first_epoch = state.epoch + 1
            last_epoch = state.epoch + BOOTS_PER_IMAGE
            if last_epoch > MAX_EPOCH:
                raise PalmbotsError(
                    f"{file}: no boots are left for another image; the pair needs a new key"
                )
            text = image_with("robot", boards.page(side, first_epoch))
            # Counted before the image exists, so that no epoch can be used twice.
            write_state(file, replace(state, epoch=last_epoch))
        written.append(_write_secret(out / f"{side}.hex", text))
    written.append(_write_secret(out / "dongle.hex", dongle_image(boards)))
    return written


def dongle_image(boards: BoardPair) -> str:
    """The image of the station's radio."""
    return image_with("dongle", boards.dongle_page())


def _write_secret(path: Path, text: str) -> Path:
    previous = os.umask(0o077)
    try:
        write_whole(path, text)
    finally:
        os.umask(previous)
    return path

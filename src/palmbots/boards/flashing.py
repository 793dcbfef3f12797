# SPDX-License-Identifier: Apache-2.0
"""Flashing: an image is copied to the drive as which a board shows itself.

The interface chip of the board writes the image into the flash memory and restarts the board. It
reports a failure in a file FAIL.TXT on the drive.
"""

import contextlib
import hashlib
import io
import os
from pathlib import Path

from palmbots._types import SIDES
from palmbots._util.atomic_files import folder, write_whole
from palmbots._util.command import Option, command
from palmbots._util.optional_imports import require
from palmbots._util.user_paths import state_folder
from palmbots.boards.images import image_with
from palmbots.boards.settings_page import PAGE_ADDRESS, PAGE_SIZE, role_in
from palmbots.errors import PalmbotsError
from palmbots.scene.file_kinds import IMAGE, refuse_other_kind

_MARK = "MICROBIT.HTM"
"""A file that every micro:bit has on its drive."""
_PLACES = ("/media", "/run/media", "/Volumes", "/mnt")


def find_drives(places: tuple[str, ...] = _PLACES) -> list[Path]:
    """The drives of all boards that are connected."""
    found = []
    for place in map(Path, places):
        for pattern in ("*", "*/*"):
            found += [file.parent for file in place.glob(f"{pattern}/{_MARK}")]
    return sorted(found)


@command(
    order=216,
    example="palmbots flash images/left.hex",
    image=Option(is_argument=True),
    drive=Option(metavar="DIR"),
    again=Option(),
)
def flash(image: Path, drive: Path | None = None, *, again: bool = False) -> Path:
    """Copy an image to a board that is connected by USB.

    An image that this user has flashed already, itself or a copy of it, is refused: a flashed
    board forgets how often it has booted, and would accept old packets as new.

    Args:
        image: a .hex of palmbots firmware.
        drive: the board's drive, if more than one is connected.
        again: flash an image again that no board has run. A copy may have failed.

    Returns:
        The file on the drive.

    Raises:
        PalmbotsError: the image is none, there is no board, or the copy failed.
    """
    text, counts_boots = _image_text(image)
    target = _only(find_drives()) if drive is None else drive
    if not (target / _MARK).exists():
        raise PalmbotsError(f"{target}: is no drive of a board; it has no file {_MARK}")
    if counts_boots:
        _mark(image, hashlib.sha256(text.encode()).hexdigest(), again=again)
    copy = target / image.name
    try:
        with copy.open("w", encoding="ascii", newline="\n") as stream:
            stream.write(text)
            stream.flush()
            os.fsync(stream.fileno())
    except OSError as error:
        with contextlib.suppress(OSError):
            copy.unlink()
        # How much of it the board has taken is unknown, so the mark stays.
        raise PalmbotsError(
            f"{copy}: cannot be written: {error.strerror or error}; connect the board anew, and "
            "flash the image with --again"
        ) from None
    failure = target / "FAIL.TXT"
    if failure.exists():
        reason = " ".join(failure.read_text("utf-8", "replace").split())
        raise PalmbotsError(f"{target}: the board reports: {reason}")
    return copy


def _mark(image: Path, check: str, *, again: bool) -> None:
    """Mark an image as flashed: beside it, and in the user's folder, where copies of it are found.

    Raises:
        PalmbotsError: it is marked already, and `again` is not set; or no mark can be written.
    """
    beside = image.with_name(f"{image.name}.flashed")
    known = state_folder() / "flashed" / check
    is_marked = beside.exists() and beside.read_text("ascii", "replace").strip() == check
    if not again and (is_marked or known.exists()):
        raise PalmbotsError(
            f"{image}: has been flashed already, itself or a copy of it; run: palmbots firmware, "
            "or flash it --again if no board has run it"
        )
    write_whole(beside, check + "\n")
    with contextlib.suppress(OSError, PalmbotsError):  # a user without a home has the other mark
        folder(known.parent)
        known.touch()


def _image_text(image: Path) -> tuple[str, bool]:
    """What the image contains, and whether it is that of a robot, which counts boots."""
    intelhex = require("intelhex", "firmware")
    refuse_other_kind(image, IMAGE)
    try:
        text = image.read_text("ascii")
        content = intelhex.IntelHex(io.StringIO(text))
    except OSError as error:
        raise PalmbotsError(f"{image}: cannot be read: {error.strerror or error}") from None
    except (UnicodeDecodeError, intelhex.IntelHexError):
        raise PalmbotsError(f"{image}: is no image; allowed: a .hex of palmbots firmware") from None
    page = content.tobinstr(start=PAGE_ADDRESS, size=PAGE_SIZE)
    role = role_in(page)
    if role is None:
        raise PalmbotsError(
            f"{image}: has no settings that a board accepts; allowed: a .hex of palmbots firmware"
        )
    is_robot = role < len(SIDES)
    # Every line is known but for the page: none is missing, changed or at another place.
    if text != image_with("robot" if is_robot else "dongle", page):
        raise PalmbotsError(
            f"{image}: is damaged, or of another version of palmbots; run: palmbots firmware"
        )
    return text, is_robot


def _only(drives: list[Path]) -> Path:
    if len(drives) == 1:
        return drives[0]
    if not drives:
        raise PalmbotsError(
            "no board is connected; connect one by USB, or give its drive with --drive"
        )
    names = ", ".join(str(drive) for drive in drives)
    raise PalmbotsError(f"{len(drives)} boards are connected; allowed: --drive, one of {names}")

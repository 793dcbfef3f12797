# SPDX-License-Identifier: Apache-2.0
"""Atomic writing of files: each one appears complete or not at all.

A file is first written under a temporary name in the target folder, flushed to the disk, and then
renamed to its final name. A reader, a crash or a full disk therefore never leaves a partial file.
The temporary name starts with a dot and ends in ``.part``. After a failure the temporary file is
removed, and an older file under the final name is unchanged.

Every function raises `PalmbotsError` with one line that names the path and the reason.
"""

import contextlib
import errno
import itertools
import os
import secrets
import stat
import tempfile
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import BinaryIO

from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError

_OF_FILES = (".png", ".svg", ".pdf", ".html", ".gif", ".mp4", ".json", ".csv", ".mcap", ".toml")


def open_regular(path: Path) -> BinaryIO:
    """Open a file for reading. A pipe, which may keep a reader waiting for ever, is refused.

    Raises:
        OSError: it cannot be opened, or is no regular file.
    """
    number = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise OSError(errno.EINVAL, "it is not a regular file")
    return open(number, "rb")


def read_regular(path: Path) -> bytes:
    """The content of a file (`open_regular`)."""
    with open_regular(path) as stream:
        return stream.read()


def check_suffix(path: str | os.PathLike[str], allowed: Collection[str]) -> str:
    """The suffix of a path in small letters.

    Raises:
        PalmbotsError: it is none of those that are allowed.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in allowed:
        raise PalmbotsError(
            f"{path}: suffix is {suffix or 'missing'}; allowed: {', '.join(allowed)}"
        )
    return suffix


def _refusal(path: Path, error: OSError) -> PalmbotsError:
    return PalmbotsError(f"{path}: cannot be written: {error.strerror or error}")


def _taken(path: Path) -> PalmbotsError:
    return PalmbotsError(f"{path}: exists already and is never overwritten")


def _final_path(path: Path) -> Path:
    """The file that a write to `path` replaces: links are followed.

    Devices and pipes are refused, because the renaming would replace the device itself.
    """
    mode = None
    try:
        final = path.resolve()
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            mode = final.stat().st_mode
    except OSError as error:
        raise _refusal(path, error) from None
    except RuntimeError:  # a link that points to itself
        raise PalmbotsError(f"{path}: cannot be written: it is a circular link") from None
    if mode is None and not final.parent.is_dir():
        fault = "is not a folder" if os.path.lexists(final.parent) else "does not exist"
        raise PalmbotsError(f"{path}: cannot be written: {path.parent} {fault}")
    if mode is not None and stat.S_ISDIR(mode):
        raise PalmbotsError(f"{path}: cannot be written: it is a folder")
    if mode is not None and not stat.S_ISREG(mode):
        raise PalmbotsError(f"{path}: cannot be written: it is not a regular file")
    if not os.access(final.parent, os.W_OK | os.X_OK):
        raise PalmbotsError(f"{path}: cannot be written: permission denied")
    return final


def _sync_folder(path: Path) -> None:
    """Flush the folder's entry of a renamed file to the disk, if the system supports it."""
    with contextlib.suppress(OSError):
        handle = os.open(path, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def check_file(path: str | os.PathLike[str]) -> None:
    """Raise the errors of writing to the file `path` that are known without creating anything.

    Long computations call it before they start.
    """
    _final_path(user_path(path))


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str], *, new: bool = False) -> Iterator[BinaryIO]:
    """Open a binary file (readable, writable, seekable) that gets the name `path` on success.

    An exception in the block removes the temporary file and leaves `path` unchanged. With `new`, a
    file that exists is refused.
    """
    shown = user_path(path)
    if new and os.path.lexists(shown):
        raise _taken(shown)
    final = _final_path(shown)
    temporary = final.with_name(f".palmbots-{secrets.token_hex(6)}.part")
    try:
        # "x" never follows a planted link, and leaves the permissions to the user's umask.
        stream = open(temporary, "x+b")  # noqa: SIM115 (the file outlives this block)
    except OSError as error:
        raise _refusal(shown, error) from None
    try:
        with stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        # Unlike a renaming, a link fails if the file has appeared meanwhile.
        (os.link if new else os.replace)(temporary, final)
        _sync_folder(final.parent)
    except FileExistsError:
        raise _taken(shown) from None
    except OSError as error:
        raise _refusal(shown, error) from None
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def write_whole(path: str | os.PathLike[str], data: bytes | str, *, new: bool = False) -> None:
    """Write `data` (text as UTF-8) to `path`, completely or not at all; see `whole_file`."""
    with whole_file(path, new=new) as stream:
        stream.write(data.encode() if isinstance(data, str) else data)


def remove(path: Path) -> bool:
    """Remove the file `path`; returns whether it existed."""
    try:
        path.unlink()
    except FileNotFoundError:
        return False
    except OSError as error:
        raise PalmbotsError(f"{path}: cannot be removed: {error.strerror or error}") from None
    return True


def set_aside(path: Path) -> Path | None:
    """Rename an older file `path`, so that it is not mistaken for a file of this run.

    Returns the new name, the first free one of ``NAME.old``, ``NAME.old2``, …, or None if there is
    no such file. Devices and folders keep their names.
    """
    if not path.is_file():
        return None
    names = (f"{path.name}.old{number if number > 1 else ''}" for number in itertools.count(1))
    free = next(place for name in names if not os.path.lexists(place := path.with_name(name)))
    try:
        path.rename(free)
    except OSError as error:
        raise PalmbotsError(f"{path}: cannot be renamed: {error.strerror or error}") from None
    return free


def _folder_named(path: str | os.PathLike[str]) -> Path:
    """The path; refuses an empty name, which `Path` would take for the working directory, and a
    new folder with the name of a picture or a page, because a file was meant."""
    if not os.fspath(path):
        raise PalmbotsError('folder: value is ""; allowed: a name (. is the working directory)')
    place = user_path(path)
    if place.suffix.lower() in _OF_FILES and not os.path.lexists(place):
        raise PalmbotsError(
            f"{place}: is the name of a file, but several files are written; allowed: a folder"
        )
    return place


def check_folder(path: str | os.PathLike[str]) -> None:
    """Raise the errors of `folder` that are known without creating anything.

    Long computations call it before they start.
    """
    place = _folder_named(path)
    try:
        if place.exists() and not place.is_dir():
            raise PalmbotsError(f"{place}: cannot be used as a folder: a file has this name")
        above = place.absolute()
        while not os.path.lexists(above):
            above = above.parent
    except OSError as error:  # such as a name that is too long, or no working directory
        raise _refusal(place, error) from None
    if not above.is_dir():
        raise PalmbotsError(f"{place}: cannot be written: {above} is not a folder")
    if not os.access(above, os.W_OK | os.X_OK):
        raise PalmbotsError(f"{place}: cannot be written: permission denied")


def folder(path: str | os.PathLike[str]) -> Path:
    """Create the folder `path` with its parents if necessary, and check that it is writable."""
    place = _folder_named(path)
    try:
        place.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise PalmbotsError(f"{place}: cannot be used as a folder: a file has this name") from None
    except OSError as error:
        raise _refusal(place, error) from None
    if not os.access(place, os.W_OK | os.X_OK):
        raise PalmbotsError(f"{place}: cannot be written: permission denied")
    return place


def check_new_folder(path: str | os.PathLike[str]) -> None:
    """Raise the errors of `new_folder` that are known without creating anything."""
    place = _folder_named(path)
    if os.path.lexists(place):
        raise _taken(place)
    check_folder(place)


@contextlib.contextmanager
def new_folder(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A folder of the same name to fill, which becomes `path` on success.

    An exception in the block removes it. A folder or file that exists is refused.
    """
    place = _folder_named(path)
    if os.path.lexists(place):
        raise _taken(place)
    parent = folder(place.absolute().parent)
    with tempfile.TemporaryDirectory(prefix=".palmbots-", suffix=".part", dir=parent) as part:
        filled = Path(part, place.name)
        try:
            filled.mkdir()
            yield filled
            filled.rename(place)
        except OSError as error:
            raise _refusal(place, error) from None

# SPDX-License-Identifier: Apache-2.0
"""The kinds of files that users give to commands, and how each is recognized.

A reader that is given a file of another kind says so in one line, which names the kind that the
file is of and the kind that is meant. The kind of a TOML file stands beside its reader.
"""

import difflib
import os
import re
import tomllib
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from palmbots._util.atomic_files import open_regular
from palmbots._util.named_registry import Registry
from palmbots._util.text import many
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError

_HEAD = 4096  # bytes in which the mark of a file stands
_MOST = 1 << 20  # bytes that are read to find the kind of a file; a device may be endless


@dataclass(frozen=True)
class FileKind:
    """A kind of file."""

    called: str
    use: str
    """What takes such a file."""
    origin: str
    """Where users get one."""
    keys: Collection[str] = ()
    """The keys at the top, if it is a TOML file."""
    mark: str = ""
    """A regular expression that matches the beginning of such files alone."""
    suffixes: Collection[str] = ()
    """Suffixes by which files are recognized whose content is of no use for it."""
    names: Callable[[], Sequence[str]] = tuple
    """The names of those that come with the package."""

    @property
    def noun(self) -> str:
        """What it is called, without the article and the word file: scene."""
        return self.called.split(" ", 1)[1].removesuffix(" file")

    @property
    def in_words(self) -> str:
        """What it is called, and where users get one."""
        return f"{self.called} ({self.origin})"


CERTIFICATE = FileKind(
    "a certificate",
    "palmbots check",
    "palmbots certify -o FILE writes one",
    mark=r'(?s).*"palmbots certificate \d',
)
LOG = FileKind(
    "a log",
    "palmbots replay, view, fit and export --log",
    "palmbots carry --out, up and robot write them",
    mark=r"\x89MCAP0",
)
IMAGE = FileKind(
    "an image for a board",
    "palmbots flash",
    "palmbots firmware writes them",
    mark=r":[0-9A-Fa-f]{10,}\r?\n",
)
KEY = FileKind(
    "the key of a pair",
    "pair.key_file of a pair file",
    "palmbots init pair FILE writes one",
    mark=r"[0-9a-f]{32}\s*\Z",
)
COUNTER = FileKind(
    "a boot counter",
    "pair.state_folder of a pair file",
    "palmbots init pair FILE writes it",
    mark=r'\{"pair": \d+, "end": "',
)
RECORDING = FileKind(
    "a recording",
    "palmbots fit",
    "columns of numbers with time_s",
    mark=r"[\w,; \t]*\btime_s\b",
)
PROGRAM = FileKind(
    "a program in Python",
    "--controller FILE.py:Class",
    "with a class that has a method step",
    suffixes=(".py",),
)
KINDS: Registry[FileKind] = Registry(
    "file kind",
    {
        "scene": "palmbots.scene.scene:SCENE_FILE",
        "object": "palmbots.scene.object_library:OBJECT_FILE",
        "drawing": "palmbots.scene.object_library:DRAWING",
        "certificate": CERTIFICATE,
        "log": LOG,
        "image": IMAGE,
        "key": KEY,
        "counter": COUNTER,
        "recording": RECORDING,
        "program": PROGRAM,
    },
)


def all_kinds() -> list[FileKind]:
    """All kinds. Rooms above this one offer some of them, and are imported now."""
    return [KINDS.get(name) for name in KINDS.names()]


def other_kind(name: str, content: bytes | Mapping[str, Any], wanted: FileKind) -> str:
    """What is wrong with a file or table that is of another kind than `wanted`.

    Args:
        name: of the file; empty: it has none.
        content: of the file, or the table in it.
        wanted: the kind that it should be of.

    Returns:
        The kind that it is of and the kind that is meant; empty if it is `wanted` or not known.
    """
    found = _kind_of(content, wanted) or _by_suffix(name)
    if found in (None, wanted):
        return ""
    return _refusal(found.called if name else found.called.removesuffix(" file"), found, wanted)


def refuse_other_kind(path: str | os.PathLike[str], wanted: FileKind) -> None:
    """Refuse a file that is missing or of another kind than `wanted`.

    A file that cannot be read, or of which no kind is known, is left to its reader.

    Raises:
        PalmbotsError: the file is missing or of another kind.
    """
    name = os.fspath(path)
    try:
        with open_regular(user_path(name)) as stream:
            problem = other_kind(name, stream.read(_MOST), wanted)
    except FileNotFoundError:
        problem = missing(name, wanted)
    except (OSError, ValueError):  # ValueError: a null character in the name
        return
    if problem:
        raise PalmbotsError(f"{name}: {problem}")


def missing(name: str, wanted: FileKind, built_in: Sequence[str] = ()) -> str:
    """What is wrong with the name of a file that does not exist: it may be a built-in name.

    Args:
        name: of the file.
        wanted: the kind that it should be of.
        built_in: names that may be given in place of a file.
    """
    for kind in all_kinds():
        if kind != wanted and name in kind.names():
            return _refusal(f"a built-in {kind.noun}", kind, wanted)
    if not built_in:
        return f"no such file; allowed: {wanted.in_words}"
    near = difflib.get_close_matches(name, built_in, n=1)
    hint = f"did you mean {near[0]}? " if near else ""
    known = f"built-in {many(wanted.noun)}: {', '.join(built_in)}"
    return f"no such {wanted.noun} or file; {hint}{known}"


def _refusal(called: str, found: FileKind, wanted: FileKind) -> str:
    return f"is {called}, for {found.use}; allowed: {wanted.in_words}"


def _kind_of(content: bytes | Mapping[str, Any], wanted: FileKind) -> FileKind | None:
    if not isinstance(content, Mapping):
        head = content[:_HEAD].decode("latin-1")
        if _is_marked(head, wanted):  # before the others, which take time to import
            return wanted
        for kind in all_kinds():
            if _is_marked(head, kind):
                return kind
        try:
            content = tomllib.loads(content.decode("utf-8-sig"))
        except (ValueError, RecursionError):
            return None
    most = _known(content, wanted)
    if most == len(content):
        return wanted
    best = wanted if most else None
    for kind in all_kinds():
        if (count := _known(content, kind)) > most:
            best, most = kind, count
    return best


def _is_marked(head: str, kind: FileKind) -> bool:
    return bool(kind.mark) and re.match(kind.mark, head) is not None


def _known(table: Mapping[str, Any], kind: FileKind) -> int:
    """How many keys of a table a kind has; 0 if it is not in TOML."""
    return sum(key in kind.keys for key in table)


def _by_suffix(name: str) -> FileKind | None:
    suffix = os.path.splitext(name)[1].lower()
    return next((kind for kind in all_kinds() if suffix in kind.suffixes), None)

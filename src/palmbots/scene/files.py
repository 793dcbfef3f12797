# SPDX-License-Identifier: Apache-2.0
"""Built-in scenes and TOML files. Every fault raises `SceneError` with one line."""

import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from importlib import resources
from typing import Any

from palmbots._util.user_paths import user_path
from palmbots.errors import SceneError
from palmbots.scene.file_kinds import KINDS, FileKind, missing, other_kind

_LARGEST = 1 << 20  # bytes; a device may be endless
# Control characters that no text contains, in any encoding of one byte a character.
_NEVER_IN_TEXT = frozenset(range(32)) - frozenset(b"\t\n\v\f\r\x1a\x1b")


def built_in_scenes() -> list[str]:
    """The names of the scenes of the package, sorted."""
    folder = resources.files("palmbots.scene") / "data" / "scenes"
    return sorted(
        f.name.removesuffix(".toml") for f in folder.iterdir() if f.name.endswith(".toml")
    )


def read_scene(source: str | os.PathLike[str]) -> tuple[str, dict[str, Any]]:
    """The name of a scene in messages, and its table.

    A built-in scene takes precedence over a file of the same name; "./paper" is always a file. A
    file that sets no key is refused: it says nothing about the user's object.
    """
    name = os.fspath(source)
    names = built_in_scenes()
    if not name:
        raise SceneError(f'scene: value is ""; allowed: {", ".join(names)}, or a TOML file')
    if name in names:
        file = resources.files("palmbots.scene") / "data" / "scenes" / f"{name}.toml"
        return name, tomllib.loads(file.read_text("utf-8"))
    table = read_table(name, KINDS.get("scene"), names)
    if not _sets_a_key(table):
        raise SceneError(
            f"{name}: sets no key; allowed: a scene file that sets at least one (palmbots init "
            "scene FILE writes all), or paper, the scene with all defaults"
        )
    return name, table


def _sets_a_key(table: Mapping[str, Any]) -> bool:
    return any(not isinstance(one, Mapping) or _sets_a_key(one) for one in table.values())


def read_table(name: str, kind: FileKind, built_in: Sequence[str] = ()) -> dict[str, Any]:
    """The table in the TOML file `name`, which is meant to be of this kind.

    Raises `SceneError`. If the file is missing, its message lists the built-in names.
    """
    what = kind.called
    data = _bytes(name, kind, built_in)
    try:
        table = _table(name, _text(name, data, what))
    except SceneError as error:
        problem = other_kind(name, data, kind)
        raise SceneError(f"{name}: {problem}") if problem else error from None
    if problem := other_kind(name, table, kind):
        raise SceneError(f"{name}: {problem}")
    return table


def _bytes(name: str, kind: FileKind, built_in: Sequence[str]) -> bytes:
    what = kind.called
    try:
        with open(user_path(name), "rb") as stream:
            data = stream.read(_LARGEST + 1)
    except FileNotFoundError:
        raise SceneError(f"{name}: {missing(name, kind, built_in)}") from None
    except IsADirectoryError:
        raise SceneError(f"{name}: is a folder; allowed: {what} in TOML") from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        reason = (isinstance(error, OSError) and error.strerror) or error
        raise SceneError(f"{name}: cannot be read: {reason}") from None
    if len(data) > _LARGEST:
        raise SceneError(f"{name}: is larger than 1 MiB; allowed: {what} in TOML")
    return data


def _text(name: str, data: bytes, what: str) -> str:
    if any(byte in _NEVER_IN_TEXT for byte in data):
        raise SceneError(f"{name}: is not a text file; allowed: {what} in TOML")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise SceneError(
            f"{name}: line {line} is not UTF-8 (byte 0x{data[error.start]:02x}); "
            f"allowed: {what} in TOML, saved as UTF-8"
        ) from None


def _table(name: str, text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        what, _, place = str(error).rpartition(" (at ")
        at = re.match(r"line \d+, column \d+", place)
        where = at[0] if at else f"line {text.count(chr(10)) + 1}, end of the file"
        raise SceneError(f"{name}: {where}: not valid TOML: {what or error}") from None
    except (ValueError, RecursionError) as error:  # ValueError: an integer too long for Python
        reason = "lists nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise SceneError(f"{name}: not valid TOML: {reason}") from None

# SPDX-License-Identifier: Apache-2.0
"""Changes of a ``pair.toml`` that keep its comments, its order and all other values."""

import itertools
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from palmbots._types import Side
from palmbots._util.atomic_files import write_whole
from palmbots._util.optional_imports import require
from palmbots.errors import PalmbotsError
from palmbots.pair.pair_keys import PairFile
from palmbots.scene.error_messages import validation_message


def write_hardware(file: Path, side: Side, values: Mapping[str, Any]) -> Path:
    """Set keys of ``[hardware.SIDE]``; the file as it was is kept beside it.

    The file is replaced as a whole, or not at all.

    Args:
        file: the ``pair.toml``.
        side: of the robot.
        values: by key.

    Returns:
        The file with the former content, the first free one of ``NAME.before``, ``NAME.before2``, …

    Raises:
        PalmbotsError: a file cannot be read or written, or the values do not fit those in the file.
    """
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise PalmbotsError(f"{file}: cannot be read: {why}") from None
    changed = _changed(file, text, side, values)
    names = (f"{file.name}.before{n if n > 1 else ''}" for n in itertools.count(1))
    backup = next(place for name in names if not os.path.lexists(place := file.with_name(name)))
    write_whole(backup, text, new=True)
    write_whole(file, changed)
    return backup


def _changed(file: Path, text: str, side: Side, values: Mapping[str, Any]) -> str:
    """The text with the new values; checked as a whole."""
    tomlkit = require("tomlkit", "calibrate")
    try:
        document = tomlkit.parse(text)
        hardware: Any = document.setdefault("hardware", tomlkit.table())
        own: Any = hardware.setdefault(side, tomlkit.table())
        for key, value in values.items():
            own[key] = _item(tomlkit, value)
        changed = tomlkit.dumps(document)
        PairFile.model_validate(tomlkit.parse(changed).unwrap())
    except (tomlkit.exceptions.TOMLKitError, RecursionError) as error:
        raise PalmbotsError(f"{file}: not valid TOML: {error}") from None
    except ValidationError as error:
        raise PalmbotsError(f"{file}: {validation_message(error, PairFile)}") from None
    return changed


def _item(tomlkit: Any, value: Any) -> Any:
    """A value of TOML; a list of tables has one table a line."""
    if not isinstance(value, list):
        return value
    array = tomlkit.array().multiline(True)
    for entry in value:
        table = tomlkit.inline_table()
        table.update(entry)
        array.append(table)
    return array

# SPDX-License-Identifier: Apache-2.0
"""Results of bounds that were computed before, one file for each scene and set of arguments.

They lie in the folder ``PALMBOTS_CACHE``, else in ``palmbots`` of the user's cache folder
(``XDG_CACHE_HOME``, else ``~/.cache``).
The name of a file is a hash of everything on which its numbers depend. A cache that cannot be read
or written is not used, without a message: it only saves time.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palmbots._util.atomic_files import folder, write_whole
from palmbots._version import __version__
from palmbots.errors import PalmbotsError

_METHOD = 2
"""Raised whenever the method or the grids change the numbers."""


def key_of(arguments: Mapping[str, Any]) -> str:
    """The hash of a call: its arguments, the version and the method."""
    text = json.dumps([__version__, _METHOD, arguments], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def _file(key: str) -> Path:
    own, home = os.environ.get("PALMBOTS_CACHE"), os.environ.get("XDG_CACHE_HOME")
    base = Path(own) if own else (Path(home) if home else Path.home() / ".cache") / "palmbots"
    return base / "bound" / f"{key}.json"


def cached(key: str) -> dict[str, Any] | None:
    """The numbers that were kept under this key; None: there are none."""
    try:
        table = json.loads(_file(key).read_text(encoding="utf-8"))
    except (OSError, ValueError, RuntimeError):  # RuntimeError: the user has no home
        return None
    return table if isinstance(table, dict) else None


def keep(key: str, table: Mapping[str, Any]) -> None:
    """Keep the numbers under this key, for later runs."""
    try:
        path = _file(key)
        folder(path.parent)
        write_whole(path, json.dumps(table))
    except (PalmbotsError, OSError, RuntimeError):
        return

# SPDX-License-Identifier: Apache-2.0
"""Paths as users write them, in options, keys and arguments."""

import os
import re
from pathlib import Path

from palmbots.errors import PalmbotsError


def user_path(path: str | os.PathLike[str], folder: str | os.PathLike[str] = "") -> Path:
    """The file or folder that a user names.

    Args:
        path: its name; ``~`` is the user's home folder.
        folder: where a relative name is looked up.

    Raises:
        PalmbotsError: it is empty, as an unset variable of the shell makes it, or an address such
            as ``s3://bucket``.
    """
    name = os.fspath(path)
    if not name:
        raise PalmbotsError(
            'name of a file: value is ""; allowed: a name (. is the working directory)'
        )
    if re.match(r"[A-Za-z][\w+.-]+:/", name):
        raise PalmbotsError(f"{name}: is an address; allowed: a file or folder of this machine")
    return Path(folder, os.path.expanduser(name))


def state_folder() -> Path:
    """Where the user's programs keep what has no folder of its own, as others do; it may not
    exist."""
    home = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(home).absolute() / "palmbots"

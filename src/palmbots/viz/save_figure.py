# SPDX-License-Identifier: Apache-2.0
"""Writes figures as PNG, SVG or PDF.

The files contain no date, so the same figure gives the same file.
"""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots._util.atomic_files import check_suffix, whole_file
from palmbots.viz.style import styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Stronger compression would take longer than drawing.
_SAVING: dict[str, dict[str, Any]] = {
    ".png": {"metadata": {"Software": None}, "pil_kwargs": {"compress_level": 3}},
    ".svg": {"metadata": {"Date": None}},
    ".pdf": {"metadata": {"CreationDate": None}},
}


def is_picture(path: str | os.PathLike[str]) -> bool:
    """Whether the name says that the file is a figure."""
    return Path(path).suffix.lower() in _SAVING


def write_figure(path: str | os.PathLike[str], figure: "Figure") -> None:
    """Write a figure to `path`; its suffix selects the format.

    The file appears only when it is complete.

    Raises:
        PalmbotsError: the suffix is not allowed, or the path cannot be written.
    """
    suffix = check_suffix(path, _SAVING)
    with styled(), whole_file(path) as stream:
        figure.savefig(stream, format=suffix[1:], **_SAVING[suffix])

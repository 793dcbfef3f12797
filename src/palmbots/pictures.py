"""Figures become files: PNG, SVG or PDF by suffix, each whole or not at all.

No date goes inside: the same figure is the same file.
"""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots.errors import PalmbotsError
from palmbots.files import whole_file
from palmbots.style import styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["save_figure"]

# Strong compression takes longer than drawing.
_SAVING: dict[str, dict[str, Any]] = {
    ".png": {"metadata": {"Software": None}, "pil_kwargs": {"compress_level": 3}},
    ".svg": {"metadata": {"Date": None}},
    ".pdf": {"metadata": {"CreationDate": None}},
}


def save_figure(path: str | os.PathLike[str], figure: "Figure") -> None:
    """Write a figure to `path`.

    Raises `PalmbotsError` for another suffix, and for a path that cannot be written.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in _SAVING:
        raise PalmbotsError(
            f"{path}: suffix is {suffix or 'missing'}; allowed: {', '.join(_SAVING)}"
        )
    with styled(), whole_file(path) as stream:
        figure.savefig(stream, format=suffix[1:], **_SAVING[suffix])

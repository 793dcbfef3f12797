"""One look for every picture: colours that colour-blind readers tell apart, sizes that print well.

The hues are those of Okabe and Ito (2008). Nothing is told by hue alone: the two robots also differ
by line style and hatch, and every correction carries its letter.
"""

import contextlib
from collections.abc import Iterator
from typing import Any

__all__ = [
    "BOTH",
    "DROP",
    "HATCH",
    "HUE",
    "INK",
    "LINE",
    "OBJECT",
    "PALE",
    "QUIET",
    "SLIDES",
    "ZERO",
    "styled",
]

INK = "#222222"
QUIET = "#8A8A8A"
ZERO = "#009E73"  # the zero zone of the sensor, and sticking contacts
OBJECT = "#E9C46A"
DROP = "#B00020"
SLIDES = "#F0E442"  # a contact that slides
BOTH = "#CC79A7"

HUE = {"left": "#0072B2", "right": "#D55E00", "both": BOTH}
PALE = {"left": "#CCE3F0", "right": "#F7DFCC", "zero": "#B2E2D3"}
LINE = {"left": "-", "right": (0, (4, 1.2))}
HATCH = {"left": "////", "right": "\\\\\\\\", "both": "...."}

_SETTINGS: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 9,
    "axes.edgecolor": "#555555",
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.5,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "hatch.linewidth": 0.4,
    "text.color": INK,
    "axes.labelcolor": INK,
    "savefig.dpi": 200,
    "svg.hashsalt": "palmbots",  # so that the same carry gives the same file
}


@contextlib.contextmanager
def styled() -> Iterator[None]:
    """Draw and save inside this block; the caller's own matplotlib settings come back after it."""
    import matplotlib  # here: the log and the three-dimensional scene want the colours only

    with matplotlib.rc_context(_SETTINGS):
        yield

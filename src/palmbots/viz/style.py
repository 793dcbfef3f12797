# SPDX-License-Identifier: Apache-2.0
"""The style of all figures: colours that colour-blind readers can distinguish, sizes for print.

The colours are those of Okabe and Ito (2008). Colour is never the only distinction: the two robots
also differ by line style and hatch, controllers by marker and line style, and every correction has
its label.
"""

import contextlib
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from palmbots.control.registry import controller_names, describe

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
    "Look",
    "controller_looks",
    "controller_title",
    "styled",
]

INK = "#222222"
QUIET = "#8A8A8A"
ZERO = "#009E73"  # the zero zone of the sensor; sticking contacts
OBJECT = "#E9C46A"
DROP = "#B00020"
SLIDES = "#F0E442"  # a sliding contact
BOTH = "#CC79A7"

HUE = {"left": "#0072B2", "right": "#D55E00", "both": BOTH}
PALE = {"left": "#CCE3F0", "right": "#F7DFCC", "zero": "#B2E2D3"}
LINE = {"left": "-", "right": (0, (4, 1.2))}
HATCH = {"left": "////", "right": "\\\\\\\\", "both": "...."}


class Look(NamedTuple):
    """How the curve of one controller is drawn."""

    colour: str
    marker: str
    line: Any


# In the order of the controller registry; they repeat after the last one.
_LOOKS = (
    Look(QUIET, "^", ":"),
    Look("#D55E00", "s", "--"),
    Look("#0072B2", "o", "-"),
    Look("#009E73", "v", (0, (5, 1, 1, 1))),
    Look("#CC79A7", "D", "-."),
    Look("#E69F00", "P", (0, (3, 1))),
    Look("#56B4E9", "X", (0, (1, 1))),
    Look("#000000", "*", (0, (7, 2))),
)


def controller_looks(names: Iterable[str]) -> dict[str, Look]:
    """The look of each controller in a figure.

    Registered controllers have their looks in the order of the registry, so a controller looks the
    same in every figure. Other names take the looks that follow.
    """
    names = list(dict.fromkeys(names))
    registered = controller_names()
    order = [*registered, *(name for name in names if name not in registered)]
    return {name: _LOOKS[order.index(name) % len(_LOOKS)] for name in names}


def controller_title(name: str) -> str:
    """How titles name a controller."""
    return "no controller" if describe(name).team == "none" else f"{name} algorithm"


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
    "svg.hashsalt": "palmbots",  # the same carry gives the same file
}


@contextlib.contextmanager
def styled() -> Iterator[None]:
    """Apply the style inside this block, and restore the matplotlib settings of the caller."""
    import matplotlib  # here, because carry logs need only the colours

    with matplotlib.rc_context(_SETTINGS):
        yield

# SPDX-License-Identifier: Apache-2.0
"""The style of all figures: colours that colour-blind readers can distinguish, sizes for print.

All colours of figures are defined here and named by their meaning. Most are those of Okabe and Ito
(2008), pale versions of them, and greys. Colour is never the only distinction: the two robots
also differ by line style and hatch, controllers by marker and line style, and every correction has
its label.

The label of an axis ends with the unit in square brackets, as in "contact p [mm]" (`axis_label`).
"""

import contextlib
import io
import sys
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from palmbots.control.registry import controller_names, describe
from palmbots.scene.key_units import name_of, unit_of

_BLACK, _WHITE = "#000000", "#FFFFFF"
_BLUE, _SKY, _GREEN, _YELLOW = "#0072B2", "#56B4E9", "#009E73", "#F0E442"
_ORANGE, _VERMILLION, _PURPLE = "#E69F00", "#D55E00", "#CC79A7"

INK = "#222222"  # text, outlines, messages
QUIET = "#8A8A8A"  # what is less important
LEADER = "#BBBBBB"  # from a label to what it names
RULE = "#DDDDDD"  # lines and areas behind everything else
PAPER = "#FFFFFF"  # inside of hollow marks
BACKGROUND = _WHITE

OBJECT = "#E9C46A"
FLOOR = "#EFEFEF"
TILES = ("#E6E6E6", "#D6D6D6")  # of the floor in three dimensions
SKY = "#DBE8F2"  # behind the floor in three dimensions
PATH = "#595959"  # on the floor
ZERO = _GREEN  # the zero zone of the sensor; sticking contacts
SLIDES = _YELLOW  # a sliding contact
DROP = "#B00020"  # failures and limits

BOTH = _PURPLE
HUE = {"left": _BLUE, "right": _VERMILLION, "both": BOTH}
PALE = {"left": "#CCE3F0", "right": "#F7DFCC", "both": "#EFD9E6", "zero": "#B2E2D3"}
LINE = {"left": "-", "right": (0, (4, 1.2))}
HATCH = {"left": "////", "right": "\\\\\\\\", "both": "...."}
SWITCH = {-1: RULE, 0: PALE["zero"], 1: "#F5F0B8"}  # by the sign that it reads

COLOUR_MAP = "cividis"  # equal steps look equal, with every kind of colour vision
ON_MAP = {"dark": _WHITE, "light": _BLACK}  # lines and texts on dark and on light parts of a map
EXCLUDED = FLOOR  # pairs on a map that the limits rule out
PAPER_PAIR = _VERMILLION  # the paper's palm angles on a map


class Look(NamedTuple):
    """How a curve is drawn."""

    colour: str
    marker: str
    line: Any


SERIES = (
    Look(_BLUE, "o", "-"),
    Look(_VERMILLION, "^", LINE["right"]),
    Look(_GREEN, "s", (0, (1, 1))),
    Look(_PURPLE, "v", (0, (4, 1, 1, 1))),
)
"""Curves that belong to no robot and to no controller: worlds, engines, kinds of motion."""

# In the order of the controller registry; they repeat after the last one.
_LOOKS = (
    Look(QUIET, "^", ":"),
    Look(_VERMILLION, "s", "--"),
    Look(_BLUE, "o", "-"),
    Look(_GREEN, "v", (0, (5, 1, 1, 1))),
    Look(_PURPLE, "D", "-."),
    Look(_ORANGE, "P", (0, (3, 1))),
    Look(_SKY, "X", (0, (1, 1))),
    Look(_BLACK, "*", (0, (7, 2))),
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


def axis_label(quantity: str, unit: str | None) -> str:
    """The label of an axis: the quantity and its unit, as in "contact p [mm]".

    The unit is in the next line if the quantity ends with a line break.
    """
    gap = "" if quantity.endswith("\n") else " "
    return f"{quantity}{gap}[{unit}]" if unit else quantity


def key_label(key: str) -> str:
    """The label of the axis of a scene key: `radio.latency_s` → "radio latency [s]"."""
    return axis_label(name_of(key), unit_of(key))


def plain_numbers(axis: Any, *, minor: bool = True) -> None:
    """Label the ticks of a logarithmic `axis` (``axes.xaxis``) 0.5, 2, 10 rather than as powers;
    without `minor`, the ticks between powers of ten have no label."""
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter("{x:g}" if minor else "")


def from_zero(axis: Any, most: float) -> None:
    """Let an axis reach from 0 to `most`, with room for a whole marker at 0."""
    axis.axes.set(**{f"{axis.axis_name}lim": (-0.04 * most, most)})


def footnote(figure: Any, text: str) -> None:
    """Write what a reader needs to know below the axes of a figure."""
    figure.supxlabel(text, fontsize=7, color=QUIET)


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
    """Apply the style inside this block, and restore the matplotlib settings of the caller.

    The style starts from matplotlib's defaults, not from the user's matplotlibrc.
    """
    import matplotlib  # here, because carry logs need only the colours

    _show_in_notebooks()
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_SETTINGS)
        yield


def _show_in_notebooks() -> None:
    """Show a figure at the end of a cell as a picture, also without ``%matplotlib inline``."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if shell is None:
        return
    from matplotlib.figure import Figure

    pictures = shell.display_formatter.formatters["image/png"]
    try:
        pictures.lookup_by_type(Figure)  # of the user, or of ``%matplotlib inline``
    except KeyError:
        pictures.for_type(Figure, _as_png)


def _as_png(figure: Any) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=100)
    return stream.getvalue()

# SPDX-License-Identifier: Apache-2.0
"""States given as numbers or arrays, converted to the columns that the core takes.

Units are SI and radians. Impossible numbers are refused: an angle beyond a quarter turn (probably
degrees), a width that is not positive, negative friction, and numbers that are not finite.
"""

import math
from collections.abc import Sequence
from itertools import chain
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from palmbots._types import SIDES
from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError

FloatArray: TypeAlias = float | np.floating[Any] | Sequence[Any] | NDArray[np.floating[Any]]
"""A number, or an array or nested sequence of numbers, which broadcasts as in NumPy."""

_HALF_PI = math.pi / 2
_PAIRS = ("offset", "friction", "theta", "p")
_NAMES = ("width", "com_x", "com_y", "slope", *(f"{k}_{s}" for k in _PAIRS for s in SIDES))
_WORDS = {
    "width": "numbers in m, more than 0",
    "friction": "numbers, 0 or more",
    "theta": "radians between -pi/2 and pi/2 (numpy.radians makes them of degrees)",
}


def _all_possible(what: str, v: NDArray[np.float64]) -> bool:
    """Sufficient test that all numbers are possible, in one or two passes."""
    if v.size == 0:
        return True
    if v.size == 1:
        low = high = total = v.item()
    else:
        with np.errstate(all="ignore"):
            bounded = what in ("width", "friction", "theta")
            low = float(v.min()) if bounded else 0.0
            high = float(v.max()) if what == "theta" else 0.0
            total = 0.0 if what == "theta" else float(v.sum())
    if what == "theta":
        return low > -_HALF_PI and high < _HALF_PI  # both are NaN if a number is
    if not math.isfinite(total):  # NaN, an infinity, or a sum that overflows
        return False
    return low > 0 if what == "width" else what != "friction" or low >= 0


def _refuse_impossible(name: str, v: NDArray[np.float64]) -> None:
    """Raise `PalmbotsError`, with the first impossible number, if there is one."""
    what = name.split("_")[0]
    if _all_possible(what, v):
        return
    fine = np.abs(v) < (_HALF_PI if what == "theta" else math.inf)
    if what == "width":
        fine &= v > 0
    elif what == "friction":
        fine &= v >= 0
    if not np.all(fine):
        allowed = _WORDS.get(what, "finite numbers")
        raise PalmbotsError(f"{name}: value is {show(float(v[~fine][0]))}; allowed: {allowed}")


def columns_of(
    width: FloatArray,
    com_x: FloatArray,
    com_y: FloatArray,
    slope: FloatArray,
    pairs: Sequence[tuple[FloatArray, FloatArray]],
) -> tuple[tuple[int, ...], int, list[NDArray[np.float64]]]:
    """Broadcast the arguments of `palmbots.contact_modes_batch` against each other.

    Args:
        width: as in `palmbots.contact_modes_batch`.
        com_x: the same.
        com_y: the same.
        slope: the same.
        pairs: offset, friction, theta and p, each (left, right).

    Returns:
        The shape the arguments broadcast to, the number of states, and the 13 columns of the core:
        width, COM from the left contact, from the right one, height, slope, and the pairs.

    Raises:
        ValueError: the arguments do not broadcast.
        PalmbotsError: a number is impossible.
    """
    values = [np.asarray(v, float) for v in (width, com_x, com_y, slope, *chain(*pairs))]
    for name, value in zip(_NAMES, values, strict=True):
        _refuse_impossible(name, value)
    w, x, *others = values
    given = [w, x, w - x, *others]
    shape = np.broadcast_shapes(*(v.shape for v in given))
    n = math.prod(shape)
    # A number that is the same for all states stays one number, to save memory and time.
    columns = [
        v.reshape(1) if v.size == 1 else np.ascontiguousarray(np.broadcast_to(v, shape)).reshape(n)
        for v in given
    ]
    return shape, n, columns

"""States given as numbers or arrays, as the columns of numbers that the core takes."""

import math
from collections.abc import Sequence
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["columns_of"]


def columns_of(
    width: ArrayLike,
    com_x: ArrayLike,
    com_y: ArrayLike,
    slope: ArrayLike,
    pairs: Sequence[tuple[ArrayLike, ArrayLike]],
) -> tuple[tuple[int, ...], int, list[NDArray[np.float64]]]:
    """Broadcast the arguments of `palmbots.states` against each other.

    Args:
        width: as in `palmbots.states`.
        com_x: the same.
        com_y: the same.
        slope: the same.
        pairs: offset, friction, theta and p, each (left, right).

    Returns:
        The shape the arguments broadcast to, the number of states, and the 13 columns of the core:
        width, COM from the left contact, from the right one, height, slope, and the pairs.

    Raises:
        ValueError: the arguments do not broadcast.
    """
    w, x = np.asarray(width, float), np.asarray(com_x, float)
    given = [w, x, w - x, *(np.asarray(v, float) for v in (com_y, slope, *chain(*pairs)))]
    shape = np.broadcast_shapes(*(v.shape for v in given))
    n = math.prod(shape)
    # One number for all states stays one number: nothing is blown up that need not be.
    columns = [
        v.reshape(1) if v.size == 1 else np.ascontiguousarray(np.broadcast_to(v, shape)).reshape(n)
        for v in given
    ]
    return shape, n, columns

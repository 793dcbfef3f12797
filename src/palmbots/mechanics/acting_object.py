# SPDX-License-Identifier: Apache-2.0
"""The object as it acts in a state: with its contacts at the points that touch the palms.

A sharp contact vertex is that point itself. A rounded one touches at a point of its arc that
depends on the state. In each state it acts like a sharp vertex at that point
(docs/theory/stability.md).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

import palmbots._core as _core

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ActingObject:
    """Lengths in metres, one number for each state; nan: the object cannot span the contacts."""

    dx: Array
    """From the left touching point to the right one, level."""
    dy: Array
    """The same, upward."""
    width: Array
    """Between the touching points."""
    com_left: Array
    """The COM from the left touching point, along the line to the right one."""
    com_right: Array
    com_height: Array
    """The COM above that line."""


def acting_object(spec: _core.Spec, theta: ArrayLike, p: ArrayLike) -> ActingObject:
    """The object in n states with these palm angles [rad] and contact coordinates [m].

    Args:
        spec: the scene.
        theta: (2, n), left and right.
        p: likewise.
    """
    angles, places = (np.ascontiguousarray(given, float) for given in (theta, p))
    return ActingObject(*_core.acting_objects(spec, tuple(angles), tuple(places)))

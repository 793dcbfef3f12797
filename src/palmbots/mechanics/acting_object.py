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
from palmbots.scene.spec import contact_radii

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ActingObject:
    """Lengths in metres, one number for each state."""

    reaches: NDArray[np.bool_]
    """Whether the object can span the contacts; where not, the other numbers mean nothing."""
    dx: Array
    """From the left touching point to the right one, level."""
    dy: Array
    """The same, upward."""
    width: Array
    """Between the touching points."""
    com_left: Array
    """The COM from the left touching point, along the line to the right one."""
    com_height: Array
    """The COM above that line."""


def acting_object(spec: _core.Spec, theta: ArrayLike, p: ArrayLike) -> ActingObject:
    """The object in states with these palm angles [rad] and contact coordinates [m].

    Args:
        spec: the scene.
        theta: (2, n) or (2,), left and right.
        p: likewise.
    """
    theta, p = np.asarray(theta, float), np.asarray(p, float)
    column = (2, *(1,) * (theta.ndim - 1))
    radius = np.reshape(contact_radii(spec), column)
    offset = np.reshape([palm.offset for palm in spec.palms], column)
    height = p * np.sin(theta) + offset * np.cos(theta)
    # From the touching points to the centres of the arcs.
    back, up = radius * np.sin(theta), radius * np.cos(theta)
    rise = (height + up)[1] - (height + up)[0]  # between the centres
    reaches = np.abs(rise) < spec.width
    run = np.sqrt(np.where(reaches, (spec.width - rise) * (spec.width + rise), 1.0))
    dx, dy = run + back.sum(axis=0), height[1] - height[0]
    x = (spec.com_left * run - spec.com_height * rise) / spec.width + back[0]
    z = (spec.com_left * rise + spec.com_height * run) / spec.width + up[0]
    width = np.hypot(dx, dy)
    return ActingObject(
        reaches, dx, dy, width,
        (x * dx + z * dy) / width, (z * dx - x * dy) / width,
    )  # fmt: skip

# SPDX-License-Identifier: Apache-2.0
"""Objects with parts that hang below the line of a palm, and whether a palm touches them.

`touches` is the oracle for clearance: it turns the outline into the frame of the palm and asks
where the outline crosses the palm's line, which neither the analysis nor the certificates do.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
WIDTH = 0.25


def lips(drop_m: float, out_m: float = 0.1, thick_m: float = 0.01) -> dict[str, Any]:
    """A plate on two feet whose lips hang down beyond the back ends of the palms."""
    far, high = WIDTH + out_m, 0.05
    right = [(WIDTH, high), (far - thick_m, high), (far - thick_m, drop_m), (far, drop_m)]
    left = [(WIDTH - x, y) for x, y in reversed(right)]
    vertices = [(0, 0), (0.1, 0.02), (0.15, 0.02), (WIDTH, 0), *right]
    vertices += [(far, 0.07), (-out_m, 0.07), *left]
    return _scene(vertices, 3)


def arch(height_m: float) -> dict[str, Any]:
    """A box on two pointed feet, with room for the palms' tips between them."""
    vertices = [
        (0, 0),
        (0.01, height_m),
        (WIDTH - 0.01, height_m),
        (WIDTH, 0),
        (WIDTH, 0.1),
        (0, 0.1),
    ]
    return _scene(vertices, 3)


def keel(height_m: float) -> dict[str, Any]:
    """The same with a keel in the middle: two tips of palms that reach far meet its sides."""
    vertices = [(0, 0), (0.01, 0.04), (0.11, 0.04), (0.12, height_m), (0.13, height_m)]
    vertices += [(0.14, 0.04), (WIDTH - 0.01, 0.04), (WIDTH, 0), (WIDTH, 0.1), (0, 0.1)]
    return _scene(vertices, 7)


def _scene(vertices: list[tuple[float, float]], right: int) -> dict[str, Any]:
    corners = [[float(x), float(y)] for x, y in vertices]
    thing = {"vertices_m": corners, "contacts": [0, right], "com_m": [WIDTH / 2, 0.05]}
    return {"object": thing}


def touches(outline: Array, alpha: Array, inward: Array, outward: Array) -> NDArray[np.bool_]:
    """Whether palms that reach so far touch an outline beside its contact vertex, the origin.

    Args:
        outline: vertices (x, y), in either sense of rotation, as seen from the contact.
        alpha: angle between palm and object, one or many.
        inward: how far the palm reaches to its tip.
        outward: how far to its back end.
    """
    own = int(np.flatnonzero((outline == 0).all(axis=1))[0])
    turned = outline[:, 0] + 1j * outline[:, 1]
    frame = np.roll(turned, -own) * np.exp(1j * np.atleast_1d(alpha))[:, None]
    x, y = frame.real, frame.imag
    found = np.zeros(len(x), dtype=bool)
    for k in range(1, len(outline) - 1):
        ax, ay, bx, by = x[:, k], y[:, k], x[:, k + 1], y[:, k + 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            place = ax + (bx - ax) * ay / (ay - by)
        found |= (ay * by <= 0) & (place >= -outward) & (place <= inward)
    # Next to the contact the palm is in the object unless both edges there rise from it.
    return found | (np.minimum(y[:, 1], y[:, -1]) <= 0)

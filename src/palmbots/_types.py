# SPDX-License-Identifier: Apache-2.0
"""Types and names that every room uses."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["SIDES", "FloatArray", "Interval", "Overrides", "Side"]

Side = Literal["left", "right"]

SIDES: tuple[Side, Side] = ("left", "right")

Interval: TypeAlias = tuple[float, float]
"""The lower and the upper end."""

FloatArray: TypeAlias = float | np.floating[Any] | Sequence[Any] | NDArray[np.floating[Any]]
"""A number, or an array or nested sequence of numbers, which broadcasts as in NumPy."""

Overrides: TypeAlias = Mapping[str, Any] | None
"""Scene keys to set on top of a scene, such as ``{"radio.loss": 0.1}``."""

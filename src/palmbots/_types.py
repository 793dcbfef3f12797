# SPDX-License-Identifier: Apache-2.0
"""Types and names that every room uses."""

from collections.abc import Mapping
from typing import Any, Literal, TypeAlias

Side = Literal["left", "right"]

SIDES: tuple[Side, Side] = ("left", "right")

Interval: TypeAlias = tuple[float, float]
"""The lower and the upper end."""

Overrides: TypeAlias = Mapping[str, Any] | None
"""Scene keys to set on top of a scene, such as ``{"radio.loss": 0.1}``."""

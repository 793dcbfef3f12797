# SPDX-License-Identifier: Apache-2.0
"""What no controller can beat, and controllers with full information that come near it.

`palmbots.bound` computes the bound; this room exports the types of its result.
"""

from palmbots._util.results import FIGURES
from palmbots.optimum.drop_bound import Bound as Bound
from palmbots.optimum.drop_bound import FrontPoint as FrontPoint

__all__ = ["Bound", "FrontPoint"]

FIGURES.register("bound", "palmbots.optimum.bound_figure:draw")


def __dir__() -> list[str]:
    return sorted(__all__)

# SPDX-License-Identifier: Apache-2.0
"""A bound for controllers whose robots keep driving, and references with full information.

`palmbots.bound` computes the bound; this room exports the types of its result.
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names
from palmbots._util.results import FIGURES

if TYPE_CHECKING:
    from palmbots.optimum.design_law import DesignLaw as DesignLaw
    from palmbots.optimum.design_law import LawPoint as LawPoint
    from palmbots.optimum.design_law import compare_with_law as compare_with_law
    from palmbots.optimum.drop_bound import Bound as Bound
    from palmbots.optimum.drop_bound import FrontPoint as FrontPoint
else:
    __getattr__, __dir__ = lazy_names(__name__)

FIGURES.register("bound", "palmbots.optimum.bound_figure:draw")
FIGURES.register("design-law", "palmbots.optimum.design_law_figure:draw")

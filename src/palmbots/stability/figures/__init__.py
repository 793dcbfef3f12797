# SPDX-License-Identifier: Apache-2.0
"""The figures of the stability analysis and of the palm-angle design.

They are loaded on first use, since matplotlib is slow to import.
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.stability.figures.analysis_figures import draw_all, save_all
    from palmbots.stability.figures.palm_angles_figure import palm_angles

__all__ = ["draw_all", "palm_angles", "save_all"]

_PLACES = {
    "draw_all": ".analysis_figures",
    "palm_angles": ".palm_angles_figure",
    "save_all": ".analysis_figures",
}

__getattr__, __dir__ = lazy_names(__name__, _PLACES)

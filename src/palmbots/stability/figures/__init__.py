# SPDX-License-Identifier: Apache-2.0
"""The figures of the stability analysis and of the palm-angle design.

They are loaded on first use, since matplotlib is slow to import.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from palmbots.stability.figures.analysis_figures import draw_all, save_all
    from palmbots.stability.figures.palm_angles_figure import palm_angles

__all__ = ["draw_all", "palm_angles", "save_all"]

_MODULES = {
    "draw_all": "palmbots.stability.figures.analysis_figures",
    "palm_angles": "palmbots.stability.figures.palm_angles_figure",
    "save_all": "palmbots.stability.figures.analysis_figures",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_MODULES[name]), name)


def __dir__() -> list[str]:
    return list(__all__)

# SPDX-License-Identifier: Apache-2.0
"""The MuJoCo world: simulation with inertia and compliant contacts, videos, validation."""

import importlib
from typing import TYPE_CHECKING, Any

from palmbots._util.results import FIGURES

if TYPE_CHECKING:
    from palmbots.mujoco.drift_forecast import Budget as DriftBudget
    from palmbots.mujoco.drift_forecast import forecast as forecast_drift
    from palmbots.mujoco.figures.plan_view import draw as draw_plan_view
    from palmbots.mujoco.film import save_film as save_video
    from palmbots.mujoco.film import save_still
    from palmbots.mujoco.validation.agreement_figure import draw as draw_validation
    from palmbots.mujoco.validation.speed_figure import draw as draw_speed_limits
    from palmbots.mujoco.validation.speed_limits import SpeedLimits
    from palmbots.mujoco.validation.speed_limits import speed_limits as find_speed_limits
    from palmbots.mujoco.validation.validation import Validation
    from palmbots.mujoco.viewer import Viewer

__all__ = [
    "DriftBudget",
    "SpeedLimits",
    "Validation",
    "Viewer",
    "draw_plan_view",
    "draw_speed_limits",
    "draw_validation",
    "find_speed_limits",
    "forecast_drift",
    "save_still",
    "save_video",
]

# Imported on first use, because most of them need optional packages.
_LAZY = {
    "DriftBudget": "drift_forecast:Budget",
    "SpeedLimits": "validation.speed_limits:SpeedLimits",
    "Validation": "validation.validation:Validation",
    "Viewer": "viewer:Viewer",
    "draw_plan_view": "figures.plan_view:draw",
    "draw_speed_limits": "validation.speed_figure:draw",
    "draw_validation": "validation.agreement_figure:draw",
    "find_speed_limits": "validation.speed_limits:speed_limits",
    "forecast_drift": "drift_forecast:forecast",
    "save_still": "film:save_still",
    "save_video": "film:save_film",
}

for _name, _function in _LAZY.items():
    if _name.startswith("draw_"):
        FIGURES.register(_name.removeprefix("draw_"), f"palmbots.mujoco.{_function}")


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'palmbots.mujoco' has no attribute {name!r}")
    module, _, attribute = _LAZY[name].partition(":")
    return getattr(importlib.import_module(f"palmbots.mujoco.{module}"), attribute)


def __dir__() -> list[str]:
    return sorted(__all__)

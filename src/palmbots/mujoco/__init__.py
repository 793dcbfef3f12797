# SPDX-License-Identifier: Apache-2.0
"""The MuJoCo world: simulation with inertia and compliant contacts, videos, validation."""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names
from palmbots._util.results import FIGURES

if TYPE_CHECKING:
    from palmbots.mujoco.drift_budget import Budget as DriftBudget
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
_PLACES = {
    "DriftBudget": ".drift_budget:Budget",
    "SpeedLimits": ".validation.speed_limits",
    "Validation": ".validation.validation",
    "Viewer": ".viewer",
    "draw_plan_view": ".figures.plan_view:draw",
    "draw_speed_limits": ".validation.speed_figure:draw",
    "draw_validation": ".validation.agreement_figure:draw",
    "find_speed_limits": ".validation.speed_limits:speed_limits",
    "forecast_drift": ".drift_forecast:forecast",
    "save_still": ".film",
    "save_video": ".film:save_film",
}

for _name, _place in _PLACES.items():
    if _name.startswith("draw_"):
        FIGURES.register(_name.removeprefix("draw_"), f"palmbots.mujoco{_place}")

__getattr__, __dir__ = lazy_names(__name__, _PLACES)

# SPDX-License-Identifier: Apache-2.0
"""The MuJoCo world: simulation with inertia and compliant contacts, videos, validation."""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names
from palmbots._util.results import FIGURES

if TYPE_CHECKING:
    from palmbots.mujoco.curve_comparison import CurveComparison as CurveComparison
    from palmbots.mujoco.curve_comparison import compare_on_curve as compare_on_curve
    from palmbots.mujoco.curve_trial import CurveTrial as CurveTrial
    from palmbots.mujoco.drift_budget import DriftBudget as DriftBudget
    from palmbots.mujoco.drift_forecast import forecast_drift as forecast_drift
    from palmbots.mujoco.figures.plan_view import draw_plan_view as draw_plan_view
    from palmbots.mujoco.figures.route_view import draw_route as draw_route
    from palmbots.mujoco.film import save_still as save_still
    from palmbots.mujoco.film import save_video as save_video
    from palmbots.mujoco.route_carry import RouteCarry as RouteCarry
    from palmbots.mujoco.route_carry import StageResult as StageResult
    from palmbots.mujoco.route_carry import carry_route as carry_route
    from palmbots.mujoco.route_carry import plan_route as plan_route
    from palmbots.mujoco.route_plan import RoutePlan as RoutePlan
    from palmbots.mujoco.route_plan import RouteStage as RouteStage
    from palmbots.mujoco.validation.agreement_figure import draw_validation as draw_validation
    from palmbots.mujoco.validation.speed_figure import draw_speed_limits as draw_speed_limits
    from palmbots.mujoco.validation.speed_limits import SpeedLimits as SpeedLimits
    from palmbots.mujoco.validation.speed_limits import find_speed_limits as find_speed_limits
    from palmbots.mujoco.validation.validation import Validation as Validation
    from palmbots.mujoco.viewer import Viewer as Viewer
else:
    __getattr__, __dir__ = lazy_names(__name__)
    for _name in __dir__():
        if _name.startswith("draw_"):
            FIGURES.register(_name.removeprefix("draw_"), f"{__name__}:{_name}")

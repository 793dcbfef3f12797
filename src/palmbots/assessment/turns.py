# SPDX-License-Identifier: Apache-2.0
"""A curve, tried by a forecast of the sideways drift and by carries in the MuJoCo world."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from palmbots.errors import PalmbotsError
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.mujoco.drift_forecast import forecast_drift
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.outcome_counts import OutcomeCounts, count_outcomes

FORECASTS = 8
CARRIES = 10


@dataclass(frozen=True)
class TurnTrial:
    """What a curve does to a scene."""

    radius_m: float | None
    """Of a turn by 90°; None: the path is that of the scene."""
    forecast: DriftBudget | None
    counts: OutcomeCounts | None
    """In the MuJoCo world; None: the forecast exceeds the budget, so no carry was tried."""
    refusal: str
    """Why the pair cannot drive along the curve; empty: it can."""


def on_turn(scene: Scene, radius_m: float) -> Scene:
    """A straight scene on a turn by 90°; others as they are."""
    if scene.task.path.kind != "straight":
        return scene
    keys = {"kind": "arc", "radius_m": radius_m, "angle_deg": 90.0}
    return load_scene(scene, {f"task.path.{key}": value for key, value in keys.items()})


def try_turn(
    scene: Scene, controller: str, radius_m: float, report: Callable[[float], None]
) -> TurnTrial:
    """Forecast the drift on the curve, and carry along it unless the object would tip."""
    radius = radius_m if scene.task.path.kind == "straight" else None
    forecast = counts = None
    try:
        curved = on_turn(scene, radius_m)
        forecast = forecast_drift(
            curved, controller, seeds=FORECASTS, on_progress=lambda done: report(0.2 * done)
        )
        if forecast.verdict != "beyond":
            counts = count_outcomes(
                curved,
                controller,
                seeds=CARRIES,
                world="mujoco",
                on_progress=lambda done: report(0.2 + 0.8 * done),
            )
    except PalmbotsError as error:
        return TurnTrial(radius, forecast, None, str(error))
    return TurnTrial(radius, forecast, counts, "")

# SPDX-License-Identifier: Apache-2.0
"""A curve, tried by a forecast of the sideways drift and by carries in the MuJoCo world."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from palmbots.control.registry import ControllerLike, resolve
from palmbots.errors import PalmbotsError
from palmbots.mujoco.curved_world import line_of
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.mujoco.drift_forecast import forecast_drift
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.outcome_counts import OutcomeCounts, count_outcomes

FORECASTS = 8
Keys = Mapping[str, float | str]


@dataclass(frozen=True)
class CurveTrial:
    """What a curve does to a scene with some keys changed."""

    controller: str
    changes: Keys
    """Scene keys that were set; the path of a straight scene is among them."""
    forecast: DriftBudget | None
    counts: OutcomeCounts | None
    """In the MuJoCo world; None: the forecast exceeds the budget, so no carry was tried."""
    refusal: str
    """Why the pair cannot drive along the curve; empty: it can."""

    @property
    def can_be_carried(self) -> bool:
        """Whether the pair can drive along the curve, and the object is not expected to tip."""
        return self.forecast is not None and self.forecast.verdict != "beyond"


def refuse_tight(scene: Scene, radius_m: float) -> None:
    """Raise `PalmbotsError` for a turn that robots so far apart cannot drive."""
    least = scene.object.width_m
    if radius_m < least:
        raise PalmbotsError(
            f"turn_radius_m: value is {radius_m:g}; allowed: from {least:g}, the distance "
            "between the palms, to 100"
        )


def tried_turn(scene: Scene, radius_m: float, angle_deg: float) -> Keys:
    """The keys of the turn that is tried; empty: the scene has its own curve, or no turn is.

    Raises:
        PalmbotsError: the turn is too tight for robots so far apart.
    """
    if scene.task.path.kind != "straight" or radius_m == 0:
        return {}
    refuse_tight(scene, radius_m)
    return turn_keys(scene, radius_m, angle_deg)


def turn_keys(scene: Scene, radius_m: float, angle_deg: float = 90.0) -> Keys:
    """The keys with which a scene drives a turn of this radius to its end. The floor is level,
    because the MuJoCo world has no curves on slopes."""
    found: dict[str, float | str] = {"task.path.kind": "arc"}
    found |= {"task.path.radius_m": float(radius_m), "task.path.angle_deg": float(angle_deg)}
    if scene.task.slope_deg:
        found["task.slope_deg"] = 0.0
    try:
        return found | dict(whole_turn_keys(load_scene(scene, found)))
    except PalmbotsError:  # the trial says why
        return found


def whole_turn_keys(scene: Scene) -> Keys:
    """The distance after which both robots have passed an arc of fixed angle, in whole cm; empty:
    the path has no end of its own."""
    path = scene.task.path
    if path.kind not in ("arc", "s") or (path.kind == "arc" and path.angle_deg is None):
        return {}
    line = line_of(scene)
    length = line.curve.step * (len(line.curve.heading) - 1)
    return {"task.distance_m": math.ceil(100 * (length + line.spread / 2 - line.start)) / 100}


def try_curve(
    scene: Scene,
    controller: ControllerLike,
    changes: Keys,
    report: Callable[[float], None],
    *,
    carries: int,
) -> CurveTrial:
    """Forecast the drift on the curve, and carry along it unless the object would tip."""
    trial = forecast_curve(scene, controller, changes, lambda done: report(0.2 * done))
    return carry_curve(
        scene, controller, trial, lambda done: report(0.2 + 0.8 * done), carries=carries
    )


def forecast_curve(
    scene: Scene,
    controller: ControllerLike,
    changes: Keys,
    report: Callable[[float], None] = lambda fraction: None,
) -> CurveTrial:
    """Forecast the drift on the curve."""
    entry = resolve(controller)
    try:
        forecast = forecast_drift(
            load_scene(scene, dict(changes)), entry, seeds=FORECASTS, on_progress=report
        )
    except PalmbotsError as error:
        return CurveTrial(entry.name, changes, None, None, str(error))
    return CurveTrial(entry.name, changes, forecast, None, "")


def carry_curve(
    scene: Scene,
    controller: ControllerLike,
    trial: CurveTrial,
    report: Callable[[float], None],
    *,
    carries: int,
) -> CurveTrial:
    """The trial of a forecast with carries along the curve, unless the object would tip."""
    if not trial.can_be_carried:
        return trial
    try:
        counts = count_outcomes(
            load_scene(scene, dict(trial.changes)), controller, seeds=carries, world="mujoco",
            on_progress=report,
        )  # fmt: skip
    except PalmbotsError as error:
        return replace(trial, refusal=str(error))
    return replace(trial, counts=counts)

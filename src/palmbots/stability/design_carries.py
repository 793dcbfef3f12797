# SPDX-License-Identifier: Apache-2.0
"""Carries of a design: measurements of σ*, counts of outcomes, and how long they take."""

import time
from collections.abc import Callable

from palmbots.control.registry import ControllerEntry
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene
from palmbots.simulation.noise_limit import NoiseLimit, expected_carries, noise_limit
from palmbots.simulation.outcome_counts import OutcomeCounts, carry_seeds, count_outcomes
from palmbots.simulation.prepare import prepare
from palmbots.stability.angle_grid import NOISE, Objective

_PRECISE, _COARSE = 0.015, 0.03
"""Relative half-width of the interval of σ*, where it is the objective and where it is a
by-product."""
_RATE = 0.01
"""Share of drops that defines σ*."""
_SAMPLE = 200
"""Carries by which the time of the design is estimated first."""
_USUAL_CARRY_S = 3e-4


def measured(
    scene: Scene,
    entry: ControllerEntry | None,
    seed: int,
    objective: Objective,
    report: Callable[[float], None],
) -> NoiseLimit | None:
    """σ* of a scene; None where there is no controller, it refuses the scene, or there is no σ*."""
    if entry is None:
        return None
    try:
        return noise_limit(
            scene,
            entry,
            relative_half_width=_half_width(objective),
            seed=seed,
            on_progress=report,
        )
    except SceneError:
        return None
    except PalmbotsError as error:
        if not str(error).startswith("noise-limit"):
            raise
        return None


def _half_width(objective: Objective) -> float:
    return _PRECISE if objective == NOISE else _COARSE


def carries_of_measurement(objective: Objective) -> int:
    """How many carries `measured` takes, about."""
    return expected_carries(_RATE, _half_width(objective))


def carry_s_of(scene: Scene, entry: ControllerEntry) -> float:
    """How long one of many carries takes on this machine."""
    begin = time.monotonic()
    try:
        carry_seeds(prepare(scene, entry), 0, _SAMPLE)
    except SceneError:  # the controller refuses the scene's own angles
        return _USUAL_CARRY_S
    return (time.monotonic() - begin) / _SAMPLE


def counted(scene: Scene, entry: ControllerEntry | None) -> OutcomeCounts | None:
    """How carries of a scene end; None where there is no controller, or it refuses the scene."""
    try:
        return None if entry is None else count_outcomes(scene, entry)
    except SceneError:
        return None

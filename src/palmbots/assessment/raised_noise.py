# SPDX-License-Identifier: Apache-2.0
"""The noise at which carries of a scene can be compared: a scene that never fails shows no
difference between two of its values."""

from __future__ import annotations

import numpy as np

from palmbots._types import SIDES
from palmbots._util.confidence_intervals import rate_interval
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import multiplied
from palmbots.simulation.batch import DELIVERED
from palmbots.simulation.noise_limit import NOISE_KEY
from palmbots.simulation.outcome_counts import SMALL, carry_seeds
from palmbots.simulation.prepare import Prepared, prepare

NOISE_FACTORS = (1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 8.0, 12.0)
"""Factors by which the noise is raised if the scene rarely fails."""
FRESH = 1_000_000
"""First seed of a comparison. It uses other seeds than those that chose a value, on which that
value may be best by luck."""
_ENOUGH = 0.05  # share of failures with more noise at which carries can be compared


def revealing_noise(scene: Scene, controller: str, count: int) -> float | None:
    """The factor of the noise at which carries can be compared: 1 if the scene fails often enough
    already, else the least one at which it does; None: there is none."""
    own = count_failures(prepare(scene, controller), 0, count)
    if rate_interval(own, count)[0] > SMALL or (own > 0 and not makes_noise(scene)):
        return 1.0
    for factor in NOISE_FACTORS if makes_noise(scene) else ():
        try:
            if count_failures(noisy(scene, controller, factor), 0, count) > _ENOUGH * count:
                return factor
        except PalmbotsError:
            break
    return None


def makes_noise(scene: Scene) -> bool:
    """Whether there is noise to raise."""
    return any(scene.robot_of(side).noise_m_s > 0 for side in SIDES)


def noisy(scene: Scene, controller: str, factor: float) -> Prepared:
    """The scene with the noise of both robots multiplied."""
    return prepare(load_scene(scene, multiplied(scene, NOISE_KEY, factor)), controller)


def noise_words(scene: Scene, factor: float) -> str:
    """The noise at which carries were compared, as words before the result; empty: the scene's."""
    if factor == 1:
        return ""
    keys = [f"{key}={value:.3g}" for key, value in multiplied(scene, NOISE_KEY, factor).items()]
    return f"at {factor:g} times the noise ({' '.join(keys)}), "


def count_failures(prepared: Prepared, first: int, count: int) -> int:
    """How many of the carries with the seeds `first` … `first + count - 1` do not deliver."""
    return int(np.count_nonzero(carry_seeds(prepared, first, count)["outcome"] != DELIVERED))


def differ(count: int, one: int, other: int) -> bool:
    """Whether the intervals of two numbers of failures, each of `count` carries, are disjoint."""
    low, high = sorted((one, other))
    return rate_interval(low, count)[1] < rate_interval(high, count)[0]

# SPDX-License-Identifier: Apache-2.0
"""How carries of a scene end with each controller, and how long all other trials take."""

from __future__ import annotations

from collections.abc import Sequence

from palmbots._util.time_left import TimeLeft
from palmbots.assessment.angles import PAIRS
from palmbots.assessment.changes import FACTORS
from palmbots.assessment.load import LOAD_CARRIES
from palmbots.assessment.radio import LOSSES
from palmbots.errors import SceneError
from palmbots.mujoco.curve_trial import FORECASTS
from palmbots.scene.scene import Scene
from palmbots.simulation.batch import available_cores
from palmbots.simulation.outcome_counts import OutcomeCounts, count_outcomes, default_carries
from palmbots.simulation.prepare import prepare

FEWEST = 400
"""Fewest carries of each controller; if none of 400 fails, the interval ends below 1 %."""
CURVE_CARRIES = 10
"""Carries of a curve in the MuJoCo world."""
MUJOCO_PACE = 15.0
"""How many times faster than the robots the MuJoCo world is taken to run, before it has run."""


def count_each(scene: Scene, names: Sequence[str], left: TimeLeft) -> tuple[OutcomeCounts, ...]:
    """Each of these controllers that accepts the scene; then it is known how long the rest
    takes."""
    report = left.begin("counts")
    found: list[OutcomeCounts] = []
    for k, name in enumerate(names, 1):
        try:
            usual = default_carries(prepare(scene, name)) or 0
            found.append(count_outcomes(scene, name, seeds=max(usual, FEWEST)))
        except SceneError:  # of this controller only: `analyze` has accepted the scene
            continue
        carry_s = left.spent_s() / sum(one.carries for one in found)
        mujoco_s = 0.5 * scene.timeout_s / MUJOCO_PACE
        left.expect(
            load=LOAD_CARRIES * mujoco_s,
            angles=len(PAIRS) * (usual or FEWEST) * carry_s,
            radio=(len(LOSSES) + 1) * len(names) * found[0].carries * carry_s,
            change=2 * len(FACTORS) * (usual or FEWEST) * carry_s,
            curve=carries_of_curve() * mujoco_s,
        )
        report(k / len(names))
    return tuple(found)


def carries_of_curve() -> float:
    """What a curve costs, in carries in the MuJoCo world one after the other."""
    return FORECASTS + CURVE_CARRIES / available_cores()

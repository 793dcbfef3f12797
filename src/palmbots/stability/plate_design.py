# SPDX-License-Identifier: Apache-2.0
"""Design of the plate of the palms and of their angles for a job on the floor.

`plate_search` finds the plate whose tightest margin is largest. Jobs with the same seeds then try
it and the scene's own plate, because the closed forms contain neither noise nor the controller.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from palmbots._types import Interval, Overrides
from palmbots.control.registry import ControllerEntry
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import multiplied, on_every_side
from palmbots.simulation.outcome_counts import OutcomeCounts, count_outcomes
from palmbots.stability.analysis import Analysis
from palmbots.stability.angle_grid import LIFT
from palmbots.stability.clearance import outline_clearance
from palmbots.stability.design_result import (
    NOISE_FACTOR,
    Design,
    OwnAngles,
    Plate,
    PlateDesign,
    ReactionTimes,
)
from palmbots.stability.interval_sets import around
from palmbots.stability.plate_search import (
    KEYS,
    PlateLimits,
    PlateSearch,
    is_on_floor,
    own_values_of,
)
from palmbots.stability.problem import stability_problem
from palmbots.stability.reaction_region import reaction

JOBS = 1000
"""Simulated with each plate, and once more with `NOISE_FACTOR` times the noise."""
TRIALS = 20
"""Simulated with each plate to which the search goes; at most half of them may fail."""


def design_plate(
    scene: Scene,
    entry: ControllerEntry | None,
    limits: PlateLimits,
    own_deg: Interval | None,
    report: Callable[[float], None],
) -> Design:
    """Find the plate and the angles whose tightest margin is largest, and simulate jobs with them.

    Args:
        scene: its job begins or ends on the floor.
        entry: the controller of the simulated jobs; None: there are none.
        limits: the grid.
        own_deg: the scene's own angles; None: the two palms differ.
        report: called with the completed fraction.

    Raises:
        PalmbotsError: the job neither begins nor ends on the floor, or no plate qualifies.
    """
    if not is_on_floor(scene):
        raise PalmbotsError(
            "maximize: value is lift, but the job neither begins nor ends on the floor; allowed: a "
            'scene with task.from = "floor" or task.to = "floor"'
        )
    own_values = own_values_of(scene)

    def succeeds(tried: Scene) -> bool:
        counts = None if entry is None else _jobs(tried, entry, TRIALS)
        return counts is None or counts.failure_rate <= 0.5

    search = PlateSearch(scene, limits, succeeds, lambda done: report(0.8 * done))
    values = limits.values(search.best(own_values))
    if not search.improves(values, own_values):
        values = own_values  # which need not be on the grid
    analysis, refusal = search.analyses(values)
    if analysis is None or refusal:
        raise PalmbotsError(f"no plate qualifies; the nearest one does not, because: {refusal}")
    designed = load_scene(scene, on_every_side(scene, values))
    best = _plate(values, (analysis, ""), _counted(designed, entry))
    report(0.9)
    own = _plate(own_values, search.analyses(own_values), _counted(scene, entry))
    report(1.0)
    friction = around(analysis.friction, 0.5 * sum(analysis.problem.friction))
    times = reaction(designed, math.radians(best.shallow_deg), math.radians(best.steep_deg))
    own_clearance = outline_clearance(stability_problem(scene)).rotation_margin.margin
    return Design(
        scene=scene,
        maximize=LIFT,
        shallow_deg=best.shallow_deg,
        steep_deg=best.steep_deg,
        tolerance=best.least_margin or math.inf,
        clearance_deg=analysis.clearance_deg,
        friction=friction,
        friction_floor=friction[0] if friction else None,
        reaction_s=ReactionTimes(float(times.own_s), float(times.asked_s)),
        reach_m=float(times.reach_m),
        region_m=analysis.problem.contacts[0],
        noise_limit=None,
        counts=best.counts,
        own=OwnAngles(own_deg, own.least_margin, None, math.degrees(own_clearance), own.counts),
        paper_tolerance=None,
        certificate=None,
        map=search.dataset(),
        designed_scene=designed,
        plate=PlateDesign(best, own, analysis),
        words=entry.spelled if entry is not None else "",
    )


def _plate(
    values: Mapping[str, float],
    analysed: tuple[Analysis | None, str],
    counts: tuple[OutcomeCounts | None, OutcomeCounts | None],
) -> Plate:
    found, refusal = analysed
    margins = () if found is None or refusal else found.ranking
    sizes = [values[key] for key in KEYS]
    return Plate(*sizes, margins=margins, refusal=refusal, counts=counts[0], noisy=counts[1])


def _counted(
    scene: Scene, entry: ControllerEntry | None
) -> tuple[OutcomeCounts | None, OutcomeCounts | None]:
    """How jobs of a scene end, and with more noise; None where there is no controller, or something
    refuses them."""
    if entry is None:
        return None, None
    more = multiplied(scene, "robot.noise_m_s", NOISE_FACTOR)
    return _jobs(scene, entry, JOBS), _jobs(scene, entry, JOBS, more)


def _jobs(
    scene: Scene, entry: ControllerEntry, jobs: int, overrides: Overrides = None
) -> OutcomeCounts | None:
    """How jobs of a scene end; None: the scene or the controller refuses them."""
    try:
        return count_outcomes(scene, entry, seeds=jobs, overrides=overrides)
    except SceneError:
        return None

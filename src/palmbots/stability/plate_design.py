# SPDX-License-Identifier: Apache-2.0
"""Design of the plate of the palms and of their angles for a job on the floor: the result, beside
the scene's own plate.

`plate_search` finds the plate whose tightest margin is largest. Jobs with the same seeds then try
it and the scene's own plate, because the closed forms contain neither noise nor the controller.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from palmbots._types import Interval, Overrides
from palmbots._util.confidence_intervals import rate_text
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, bold, quiet, verdict
from palmbots.control.registry import ControllerEntry
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import multiplied, on_every_side
from palmbots.simulation.outcome_counts import OutcomeCounts, count_outcomes
from palmbots.stability.analysis import Analysis
from palmbots.stability.angle_grid import LIFT
from palmbots.stability.clearance import outline_clearance
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
from palmbots.stability.tightest_margins import RankedMargin

if TYPE_CHECKING:
    from palmbots.stability.design_result import Design

JOBS, NOISE_FACTOR = 1000, 3.0
"""Simulated with each plate, and once more with this multiple of the noise: with their own noise,
plates whose margins suffice do not differ measurably."""
TRIALS = 20
"""Simulated with each plate to which the search goes; at most half of them may fail."""


@dataclass(frozen=True)
class Plate:
    """A plate with two angles, its margins, and how jobs with it end."""

    nose_m: float
    bevel_m: float
    heel_m: float
    shallow_deg: float
    steep_deg: float
    margins: tuple[RankedMargin, ...]
    """The margins of `palmbots.analyze`, the tightest first; empty: the plate does not qualify."""
    refusal: str
    """Why it does not qualify; empty: it does."""
    counts: OutcomeCounts | None
    """How jobs end; None: there is no controller, or it or the scene refuses them."""
    noisy: OutcomeCounts | None
    """The same with `NOISE_FACTOR` times the noise."""

    @derived
    def least_margin(self) -> float | None:
        """The tightest margin, relative to what the scene uses up of it; None: the plate does not
        qualify."""
        return next((one.times for one in self.margins if one.times is not None), None)

    def sizes(self) -> dict[str, float]:
        """The scene keys of the plate and their values."""
        return {key: getattr(self, key.removeprefix("palm.")) for key in KEYS}

    def text(self) -> str:
        """Its sizes and angles."""
        lengths = {"nose": self.nose_m, "bevel": self.bevel_m, "heel": self.heel_m}
        parts = ", ".join(f"{name} {1e3 * value:g} mm" for name, value in lengths.items())
        return f"{parts}, {self.shallow_deg:g}° and {self.steep_deg:g}°"


@dataclass(frozen=True)
class PlateDesign:
    """The plate and angles whose tightest margin is largest, and the scene's own for comparison."""

    best: Plate
    own: Plate
    """The scene's own plate; that of the left palm, if the palms differ."""
    analysis: Analysis = field(metadata=NOT_IN_JSON)
    """Of the designed scene."""

    @derived
    def fails_more(self) -> bool:
        """Whether simulated jobs fail measurably more often than with the scene's own plate."""
        mine, own = self.best.counts, self.own.counts
        if mine is None or own is None:
            return False
        return mine.failure_interval[0] > own.failure_interval[1]

    def lines(self) -> Iterator[Item]:
        """The plate, its margins beside those of the scene's own, and simulated jobs."""
        mine, own = self.best, self.own
        yield Line(verdict(not self.fails_more, "DESIGNED", "FAILS"), bold(f"  {mine.text()}"))
        if self.fails_more:
            yield "simulated jobs fail more often than with the scene's own plate"
        least = f"tightest margin {_times(mine.least_margin)}"
        if own.refusal:
            yield f"{least}; the scene's own plate does not qualify: {own.refusal}"
        elif mine.sizes() == own.sizes():
            yield f"{least}: the scene's own plate; no other plate that was tried has a larger one"
        else:
            yield f"{least} instead of {_times(own.least_margin)} with {own.text()}"
        heads = ("designed", "the scene's own")
        yield Table(list(self._rows()), ("", *heads), right=heads)
        if mine.counts is not None:
            yield quiet(
                f"margins: relative to what the scene uses up; jobs: {mine.counts.carries:,} with "
                f"{mine.counts.controller}, seeds from 0; 95 %"
            )
        yield "tightest with the designed plate:"
        for number, margin in enumerate(mine.margins[:3], 1):
            yield Line(f"{number}. {margin.sentence()}", indent=2)

    def _rows(self) -> Iterator[tuple[str, str, str]]:
        # A quantity has several margins where several parts limit it: the least one is shown.
        tables = [
            {one.quantity: one.times for one in reversed(plate.margins) if one.times is not None}
            for plate in (self.best, self.own)
        ]
        for name in sorted(tables[0], key=lambda name: tables[0][name]):
            yield f"  {name}", _times(tables[0][name]), _times(tables[1].get(name))
        if self.best.counts is not None:
            best, own = self.best, self.own
            yield "  jobs that fail", failures_text(best.counts), failures_text(own.counts)
            name = f"  {NOISE_FACTOR:g} × noise"
            yield name, failures_text(best.noisy), failures_text(own.noisy)


def _times(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}"


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
    from palmbots.stability.design_result import Design, OwnAngles, ReactionTimes

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


def failures_text(counts: OutcomeCounts | None) -> str:
    """The share of carries that do not deliver; None: they are refused."""
    return (
        "refused" if counts is None else rate_text(counts.dropped + counts.stalled, counts.carries)
    )

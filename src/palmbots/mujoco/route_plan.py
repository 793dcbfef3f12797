# SPDX-License-Identifier: Apache-2.0
"""The plan of a route: the jobs in which a pair carries an object along it, and what the forecast
says of each (`route_planner`)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result
from palmbots._util.text import millimetres, plural
from palmbots.control.registry import ControllerEntry
from palmbots.scene.path_section import Point
from palmbots.scene.scene import Scene
from palmbots.simulation.outcome_counts import OutcomeCounts


@dataclass(frozen=True)
class RouteStage:
    """A job from floor to floor along a part of a route."""

    waypoints_m: tuple[Point, ...]
    """The middle of the pair drives from the first one to the last one."""
    length_m: float
    turn_deg: float
    """By how much the axis of the object turns, to the left."""
    drift_m: float
    """Mean drift of the middle of the object to the left of the pair's axis, when it is put down.
    The robots shift by it at the next approach."""
    drift_deg: float
    """Mean angle of the object to this axis, anticlockwise."""
    spread_m: float
    """Standard deviation of the offset with which the next approach begins."""
    spread_deg: float
    worst_m: float
    """The largest distance of a contact from the middle of its palm, over all members."""


@dataclass(frozen=True, repr=False)
class RoutePlan(Result):
    """The stages in which a pair carries an object along a route."""

    figure = "route"

    scene: Scene
    controller: str
    stages: tuple[RouteStage, ...]
    budget_m: float
    """Distance of a contact from the middle of its palm at which the object tips."""
    members: int
    """Simulated routes from which drift and spread follow."""
    failed: int
    """Members of which a job failed for a reason other than the drift."""
    entry: ControllerEntry = field(metadata=NOT_IN_JSON)
    counts: OutcomeCounts | None = None
    """How often the route fails in the quasistatic world; None: this was not counted."""

    @derived
    def length_m(self) -> float:
        """Length of all stages together."""
        return sum(stage.length_m for stage in self.stages)

    def lines(self) -> Iterator[Item]:
        """How many stages there are, and what the forecast says of each."""
        yield Line(bold(plural(len(self.stages), "stage")), f"  {self.length_m:.2f} m")
        yield stage_table(self)
        yield quiet(
            f"the object tips at {millimetres(self.budget_m)}; {self.controller}: "
            f"{self.members} simulated routes, {self.failed} failed for other reasons"
        )
        if self.counts is not None:
            yield from self.counts.lines()


def stage_table(plan: RoutePlan) -> Table:
    """The stages of a plan."""
    rows = [("  stage", "length", "turn", "drift", "at most", "left over, σ")]
    for k, one in enumerate(plan.stages, start=1):
        rows.append((
            f"  {k}", f"{one.length_m:.2f} m", with_minus(f"{one.turn_deg:.1f}°"),
            with_minus(f"{1e3 * one.drift_m:.1f} mm"), millimetres(one.worst_m),
            f"{1e3 * one.spread_m:.1f} mm, {one.spread_deg:.1f}°",
        ))  # fmt: skip
    return Table(rows)


def with_minus(text: str) -> str:
    """The text of a number with a minus sign in place of a hyphen."""
    return text.replace("-", "−")

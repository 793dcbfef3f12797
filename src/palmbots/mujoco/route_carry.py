# SPDX-License-Identifier: Apache-2.0
"""Carries an object along a route, stage by stage (`route_planner`), in one of the two worlds.

Each stage begins where the last one has left the object. In MuJoCo the pose of the object (x, y,
yaw) is handed on. The quasistatic world is planar: it hands on what the forecast of the drift says
of this very carry.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

from palmbots._types import Overrides
from palmbots._util.arguments import one_of, seed_of, whole_number
from palmbots._util.command import Option, command
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, bold, quiet, verdict, warning
from palmbots._util.results import Result
from palmbots._util.text import millimetres, plural
from palmbots.control.registry import ControllerLike
from palmbots.mujoco.carry_runner import WORLD
from palmbots.mujoco.carry_runner import run as run_in_mujoco
from palmbots.mujoco.curved_world import CurvedLiftWorld
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.route_plan import RoutePlan, stage_table, with_minus
from palmbots.mujoco.route_planner import MEMBERS, plan_stages
from palmbots.mujoco.route_stage import Offset, Pair, StageForecast, left_over, stage_seed
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.simulation.carry_ends import reason_text
from palmbots.simulation.outcome_counts import OutcomeCounts, reason_counts
from palmbots.simulation.prepare import prepare
from palmbots.simulation.result import Carry, make_carry
from palmbots.simulation.worlds import DEFAULT_WORLD

Outcome = Literal["delivered", "dropped", "stalled"]
_WORLDS = (DEFAULT_WORLD, WORLD.name)
_OVER_THE_SIDE = "off-palm"


@dataclass(frozen=True)
class StageResult:
    """How a stage of a route ended. Places are those of the middle of the object, seen from where
    the plan expects it and in the direction of travel."""

    outcome: Outcome
    reason: str | None
    """Why the object was dropped, from a fixed list; None if it was not dropped."""
    failure: str | None
    """What the job did not achieve; None: it succeeded."""
    time_s: float
    worst_m: float
    """The largest distance of a contact from the middle of its palm."""
    ahead_m: float
    aside_m: float
    """To the left; < 0: to the right. The next stage begins with this offset."""
    turned_deg: float
    """Anticlockwise. The next stage begins with this angle."""


@dataclass(frozen=True, repr=False)
class RouteCarry(Result):
    """A carry along a route, of one or more stages."""

    figure = "route"

    plan: RoutePlan
    world: str
    seed: int
    stages: tuple[StageResult, ...]
    """Those that were carried; the last one is the one that failed, if any did."""
    statistics: OutcomeCounts | None = None
    """How often routes fail in this world; None: they were not counted."""
    carries: tuple[Carry, ...] = field(default=(), metadata=NOT_IN_JSON)
    """The carry of each stage; in the quasistatic world on its unrolled path."""

    @derived
    def outcome(self) -> Outcome:
        """That of the last stage."""
        return self.stages[-1].outcome

    @derived
    def time_s(self) -> float:
        """The time of all stages together. What robots need between two stages does not count."""
        return sum(stage.time_s for stage in self.stages)

    @derived
    def warnings(self) -> tuple[str, ...]:
        """Those of all stages, each once."""
        return tuple(dict.fromkeys(text for one in self.carries for text in one.warnings))

    @property
    def is_delivered(self) -> bool:
        """Whether the object arrived at the end of the route."""
        return self.outcome == "delivered"

    def lines(self) -> Iterator[Item]:
        """The outcome, the plan and the stages."""
        count, of = len(self.stages), len(self.plan.stages)
        where = plural(of, "stage") if self.is_delivered else f"in stage {count} of {of}"
        yield Line(
            verdict(self.is_delivered, "DELIVERED", self.outcome.upper()),
            bold(f"  {where}, {self.plan.length_m:.2f} m in {self.time_s:.1f} s"),
            f"  ({self.plan.controller}, {self.world}, seed {self.seed})",
        )
        last = self.stages[-1]
        if last.failure is not None:
            yield Line(last.failure, indent=2)
        if last.reason is not None:
            yield Line(reason_text(last.reason, self.world), indent=2)
        yield quiet(f"forecast; the object tips at {millimetres(self.plan.budget_m)}:")
        yield stage_table(self.plan)
        yield quiet("the carry; where the object ended, seen from where it was expected:")
        rows = [("  stage", "time", "drift at most", "ahead", "aside", "turned")]
        for k, one in enumerate(self.stages, start=1):
            rows.append((
                f"  {k}", f"{one.time_s:.1f} s", millimetres(one.worst_m),
                *(with_minus(text) for text in (
                    f"{1e3 * one.ahead_m:.0f} mm", f"{1e3 * one.aside_m:.1f} mm",
                    f"{one.turned_deg:.1f}°",
                )),
            ))  # fmt: skip
        yield Table(rows)
        yield from map(warning, self.warnings)
        if self.statistics is not None:
            yield from self.statistics.lines()


@command(
    "route",
    order=67,
    example="palmbots route around-wall -c shared-sign --out out",
    progress="planning and simulating",
    figure="route.png",
    routes=Option(least=0, most=10**6),
)
def plan_route(
    scene: SceneLike = "around-wall",
    controller: ControllerLike = "distributed",
    *,
    routes: int = 50,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> RoutePlan:
    """Plan the stages of a route and forecast how often it fails.

    The pair puts the object down before it has drifted off the palms, and picks it up again on its
    axis. The forecast comes from jobs in the quasistatic world.

    Args:
        scene: a built-in name, a file, a table or a `Scene`, with `task.route`.
        controller: as in `palmbots.carry`.
        routes: count the outcomes of the routes with the seeds 0, 1, …, in the quasistatic world;
            0: of none. The plan does not depend on these seeds.
        overrides: scene keys to set.
        on_progress: called with the completed fraction.

    Raises:
        SceneError: the scene cannot be read or is not valid, or the pair cannot follow the route.
        PalmbotsError: another argument is not allowed, or MuJoCo is not installed.
    """
    mujoco()  # refuses at once if it is not installed
    report = on_progress or (lambda fraction: None)
    count = whole_number("routes", routes, 0, 10**6)
    share = MEMBERS / (MEMBERS + count)
    plan = plan_stages(
        load_scene(scene, overrides), controller, on_progress=lambda part: report(share * part)
    )
    counts = _counted(plan, DEFAULT_WORLD, count, lambda part: report(share + (1 - share) * part))
    return replace(plan, counts=counts)


def carry_route(
    scene: SceneLike = "around-wall",
    controller: ControllerLike = "distributed",
    *,
    world: str = "quasistatic",
    seed: int = 0,
    seeds: int = 0,
    record: bool = True,
    plan: RoutePlan | None = None,
    overrides: Overrides = None,
    on_stage: Callable[[str, float], None] | None = None,
) -> RouteCarry:
    """Carry the object along the route of a scene.

    Args:
        scene: a built-in name, a file, a table or a `Scene`, with `task.route`.
        controller: as in `palmbots.carry`.
        world: ``quasistatic``, where the forecast states the drift, or ``mujoco``.
        seed: random seed.
        seeds: count the outcomes of the routes with the seeds 0, 1, …; 0: of none.
        record: keep the trace of each stage.
        plan: that of this scene and controller; None: it is made.
        overrides: scene keys to set.
        on_stage: called with the name of the present part and the completed fraction of it.

    Raises:
        SceneError: the scene cannot be read or is not valid, or the pair cannot follow the route.
        PalmbotsError: another argument is not allowed, or MuJoCo is not installed.
    """
    one_of("world", world, _WORLDS)
    seed, count = seed_of(seed), whole_number("seeds", seeds, 0, 10**6)
    mujoco()  # refuses at once if it is not installed
    report = on_stage or (lambda part, fraction: None)
    if plan is None:
        plan = plan_stages(
            load_scene(scene, overrides), controller,
            on_progress=lambda part: report("planning the stages", part),
        )  # fmt: skip
    pair = Pair(plan.scene)
    stages, carries = _carried(
        plan, pair, world, seed, record, lambda part: report("carrying", part)
    )
    counts = _counted(plan, world, count, lambda part: report("counting outcomes", part))
    return RouteCarry(plan, world, seed, stages, counts, carries)


def _counted(
    plan: RoutePlan, world: str, count: int, report: Callable[[float], None]
) -> OutcomeCounts | None:
    """The outcomes of the routes with the first seeds; None: there are none."""
    if count == 0:
        return None
    pair, ends = Pair(plan.scene), []
    for seed in range(count):
        ends.append(_carried(plan, pair, world, seed, False, lambda part: None)[0][-1])
        report((seed + 1) / count)
    outcomes = [one.outcome for one in ends]
    return OutcomeCounts(
        plan.controller, count, outcomes.count("dropped"), outcomes.count("stalled"),
        reasons=reason_counts(one.reason for one in ends),
    )  # fmt: skip


def _carried(
    plan: RoutePlan,
    pair: Pair,
    world: str,
    seed: int,
    record: bool,
    report: Callable[[float], None],
) -> tuple[tuple[StageResult, ...], tuple[Carry, ...]]:
    """The stages up to the first one that fails, or the last one."""
    offset = Offset()
    run = _in_mujoco if world == WORLD.name else _in_the_plane
    results, carries = [], []
    for k, stage in enumerate(plan.stages):
        scene = pair.stage_scene(stage.waypoints_m, offset)
        result, one, end = run(plan, pair, scene, offset, stage_seed(seed, k), record)
        if one.mujoco_record is not None:
            walls = pair.walls_in_stage(stage.waypoints_m, offset)
            one = replace(one, mujoco_record=replace(one.mujoco_record, walls_m=walls))
        offset = left_over(end, Offset(0.0, stage.drift_m, math.radians(stage.drift_deg)))
        results.append(_result(result, one, offset))
        carries.append(one)
        report((k + 1) / len(plan.stages))
        if results[-1].outcome != "delivered":
            break
    return tuple(results), tuple(carries)


def _result(worst_m: float, one: Carry, offset: Offset) -> StageResult:
    job = one.floor_job
    assert job is not None
    is_over = one.world == DEFAULT_WORLD and worst_m > 0.5 * min(
        one.scene.palm_of(side).width_m for side in ("left", "right")
    )
    return StageResult(
        outcome="dropped" if is_over else one.outcome,
        reason=_OVER_THE_SIDE if is_over else one.reason,
        failure=job.failure,
        time_s=one.time_s,
        worst_m=worst_m,
        ahead_m=offset.ahead_m,
        aside_m=offset.aside_m,
        turned_deg=math.degrees(offset.turn),
    )


def _in_the_plane(
    plan: RoutePlan, pair: Pair, scene: Scene, offset: Offset, seed: int, record: bool
) -> tuple[float, Carry, Offset]:
    """A stage in the quasistatic world: the largest drift, the carry, where the object ends."""
    stage = StageForecast(pair, plan.entry, scene)
    ran = stage.prepared.world.run(stage.prepared, seed, record=True)
    one = make_carry(stage.prepared, seed, ran, record=record)
    assert one.floor_job is not None
    end, worst = stage.drift(ran.measured.trace, offset)
    return worst, one, Offset(one.floor_job.missed_m, end.aside_m, end.turn)


def _in_mujoco(
    plan: RoutePlan, pair: Pair, scene: Scene, offset: Offset, seed: int, record: bool
) -> tuple[float, Carry, Offset]:
    """The same in MuJoCo, from where the object stands."""
    prepared = prepare(scene, plan.entry, WORLD)
    displaced = (pair.sense * offset.aside_m, offset.turn)
    world = CurvedLiftWorld(scene, measures=record, displaced=displaced)
    one = make_carry(
        prepared, seed, run_in_mujoco(prepared, seed, record=record, start=world), record=record
    )
    (x, y, yaw), line = world.object_pose, world.line
    spot = line.at(pair.sense * scene.task.distance_m)
    cos, sin = math.cos(spot.heading), math.sin(spot.heading)
    dx, dy = pair.sense * (x - spot.x), pair.sense * (y - spot.y)
    turn = math.remainder(yaw - spot.heading, 2 * math.pi)
    assert one.lateral_peak_m is not None
    worst = max(map(abs, one.lateral_peak_m.values()))
    return worst, one, Offset(dx * cos + dy * sin, dy * cos - dx * sin, turn)

# SPDX-License-Identifier: Apache-2.0
"""Plans a route: in how many jobs an object is carried along it, and where each one leads.

On a curve the object drifts sideways, which nothing senses (`drift_forecast`). A *stage* is a job
from floor to floor along a part of the route. It ends before the drift uses up the width of the
palms. Both robots then drive away and approach again on the axis of the object.

They find this axis by the forecast: its mean over many simulated stages is the shift. What is left
over is the *offset* at the next approach. The path of a stage ends beside the route by the mean
drift, so that the object stands on the route, turned as the route is. Offsets add up from stage to
stage, and this bounds the number of stages.

A member of the forecast is a chain of quasistatic jobs on the unrolled stages. A stage takes as
many corners as all members pass with at most `NEAR` of the permitted drift. Where one corner is too
much, it is divided (`route_geometry`).

Assumed: robots know their own place, and where along its axis they have left the object.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots._types import SIDES
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result
from palmbots._util.text import millimetres, plural
from palmbots.control.registry import ControllerEntry, ControllerLike, refuse_reference, resolve
from palmbots.errors import SceneError
from palmbots.mujoco.curved_world import held, line_of
from palmbots.mujoco.drift_budget import NEAR
from palmbots.mujoco.drift_forecast import Forecast, SlipRates
from palmbots.mujoco.mjcf import layout
from palmbots.mujoco.path_curve import EASE_M, SHARPEST_TURN, Curve, corner_length, curve_of
from palmbots.mujoco.route_geometry import (
    Footprint,
    ahead,
    crossing,
    divided,
    first_touch,
    heading,
    turn_at,
)
from palmbots.scene.chassis import axle_out
from palmbots.scene.path_section import Path, Point
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.outcome_counts import OutcomeCounts
from palmbots.simulation.prepare import Prepared, prepare

MEMBERS = 24
RADIUS_M = 1.0
CLEAR_M = 0.05  # between the pair and a wall, for steering and drift; assumed
_SEEDS_APART = 2**41
_BETWEEN_STAGES = 2**42  # of their seeds
_LEAST_TURN = math.radians(5)  # of a part of a corner
_APPROACH_M = 0.03  # of a nose to the object at the start of a job


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


@dataclass(frozen=True)
class Offset:
    """Where the object stands, seen from where it was expected, in the direction of travel."""

    ahead_m: float = 0.0
    aside_m: float = 0.0
    """To the left."""
    turn: float = 0.0
    """Anticlockwise [rad]."""


class Pair:
    """What the geometry of a route needs to know of a scene."""

    def __init__(self, scene: Scene) -> None:
        route = scene.task.route
        if route.waypoints_m is None:
            raise SceneError(
                "task.route.waypoints_m: is not set; allowed: a route, for example the scene "
                "around-wall"
            )
        if any(scene.palm_of(side).lip_height_m > 0 for side in SIDES):
            raise SceneError(
                "palm.lip_height_m: lips hold the object, so its drift is not forecast; allowed: "
                "0 on a route"
            )
        self.scene, self.route = scene, route
        self.rates: SlipRates | None = None
        self.prepared: Prepared | None = None
        """That of its first stage."""
        self.points = list(route.waypoints_m)
        self.radius = RADIUS_M if route.radius_m is None else route.radius_m
        self.sense = 1.0 if scene.task.direction == "forward" else -1.0
        part = load_scene(scene, {"task.route": None, "task.path.kind": "arc"})
        self.spread = line_of(part).spread
        out, palm = axle_out(part), max(scene.palm_of(side).length_m for side in SIDES)
        left, right = layout(part).pivots
        self.room = (right - left) / 2 + out + palm / 2
        """Straight distance that the middle of the pair needs at both ends of a stage: up to the
        wheels of robots that begin a job, and half a palm, because docking moves the object."""
        spec = to_spec(held(part), unrolled=True)
        xs = [x - spec.width / 2 for x, _ in spec.silhouette]
        ends = (min(xs), max(xs)) if self.sense > 0 else (-max(xs), -min(xs))
        retreat = palm + _APPROACH_M
        self.footprint = Footprint(self.spread, out, ends, scene.object.depth_m, retreat)

    def used(self, points: Sequence[Point], k: int) -> float:
        """How much of both its lines the rounded way point k takes; 0 at the ends."""
        if not 0 < k < len(points) - 1 or abs(turn := turn_at(points, k)) < 1e-6:
            return 0.0
        return corner_length(turn, self.radius)

    def free(self, points: Sequence[Point], k: int) -> float:
        """The straight length of the line from way point k to the next one."""
        whole = math.dist(points[k], points[k + 1])
        return whole - self.used(points, k) - self.used(points, k + 1)

    def path(self, points: Sequence[Point]) -> dict[str, Any]:
        """The keys of the path from the first to the last one of these points, for the middle of
        the pair."""
        first = ahead(points[0], heading(points[0], points[1]), self.spread / 2)
        return {
            "kind": "waypoints", "waypoints_m": [list(first), *map(list, points[1:])],
            "radius_m": self.radius, "lead_in_m": 0.0,
        }  # fmt: skip

    def curve(self, points: Sequence[Point]) -> Curve:
        """The curve of a stage. Its arc lengths count from half of the pair ahead of the start."""
        path = Path.model_validate(self.path(points))
        return curve_of(path, 0.0, self.spread)

    def stage_scene(self, points: Sequence[Point], offset: Offset = Offset()) -> Scene:
        """The scene of the stage along these points, which begins where the object stands."""
        way = heading(points[0], points[1])
        moved = [ahead(points[0], way, offset.ahead_m), *points[1:]]
        return load_scene(
            self.scene,
            {
                "task.route": None,
                "task.path": self.path(moved),
                "task.distance_m": self.curve(moved).length + self.spread / 2,
            },
        )

    def shifted(self, points: Sequence[Point], drift: Offset) -> tuple[Point, ...]:
        """The points of a stage after which an object that drifts so stands at the last one."""
        way = heading(points[-2], points[-1])
        aim = way - drift.turn
        end = ahead(points[-1], way, 0.0, -drift.aside_m)
        last = crossing(points[-3], heading(points[-3], points[-2]), end, aim)
        return (*points[:-2], last, end)


def plan_stages(
    scene: Scene,
    controller: ControllerLike,
    *,
    members: int = MEMBERS,
    on_progress: Callable[[float], None] | None = None,
) -> RoutePlan:
    """Plan the stages of the route of a scene.

    Raises:
        SceneError: the pair cannot follow the route.
    """
    planner = _Planner(Pair(scene), resolve(controller), members, on_progress)
    return planner.plan()


def stage_seed(seed: int, stage: int) -> int:
    """The seed of a stage, counted from 0, of the route with this seed."""
    return (seed + stage * _BETWEEN_STAGES) % 2**64


class StageForecast:
    """The drift of an object along one stage, in the quasistatic world."""

    def __init__(self, pair: Pair, entry: ControllerEntry, scene: Scene) -> None:
        """`scene`: that of the stage, on its path."""
        self._pair, self._forecast = pair, Forecast(scene, entry, pair.rates)
        pair.rates = self._forecast.rates
        unrolled = {"task.path.kind": "straight", "mujoco.axle_m": axle_out(scene)}
        straight = load_scene(scene, unrolled)
        if pair.prepared is None:
            pair.prepared = prepare(straight, entry)
        # The stages differ in their distance only, which no check depends on.
        self.prepared = replace(pair.prepared, scene=straight, spec=to_spec(straight))
        self._width = self.prepared.spec.width

    def run(self, seed: int) -> Any:
        """The job of a seed, with its trace."""
        return self.prepared.world.run(self.prepared, seed, record=True).measured

    def drift(self, trace: Any, offset: Offset) -> tuple[Offset, float]:
        """Where the object of a job with this trace ends, seen from the axis of the pair, and the
        largest distance of a contact from the middle of its palm [m].

        Docking turns an object until it is parallel to the palms: about the contact at the nose
        that gets under it last, which the other contact, at its heel, allows.
        """
        last = int(np.argmin(trace["contact_m"].max(axis=0)))
        aside = self._pair.sense * offset.aside_m + (last - 0.5) * self._width * offset.turn
        drift = self._forecast.drift(trace, (aside, aside))
        left, right = drift[-1].tolist()
        end = Offset(0.0, self._pair.sense * 0.5 * (left + right), (right - left) / self._width)
        return end, float(np.abs(drift).max())


@dataclass
class _Member:
    """One simulated route, up to the present stage."""

    seed: int
    offset: Offset = Offset()  # immutable
    failed: bool = False


@dataclass(frozen=True)
class _Tried:
    """The stage along some points, as all members pass it."""

    points: tuple[Point, ...]
    ends: list[Offset | None]
    """None: the job of this member failed."""
    worst_m: float


class _Planner:
    """Plans stage by stage."""

    def __init__(
        self,
        pair: Pair,
        entry: ControllerEntry,
        members: int,
        on_progress: Callable[[float], None] | None,
    ) -> None:
        refuse_reference(entry, "a route")
        self.pair, self._entry = pair, entry
        self._members = [_Member(_SEEDS_APART + k) for k in range(members)]
        self._report = on_progress or (lambda fraction: None)
        self._stages: list[RouteStage] = []
        self._budget = 0.5 * min(pair.scene.palm_of(side).width_m for side in SIDES)
        self._turned = 0.0  # rad, by all stages that are planned

    def plan(self) -> RoutePlan:
        """Plan all stages."""
        points = self.pair.points
        turns = [abs(turn_at(points, k)) for k in range(1, len(points) - 1)]
        for k, turn in enumerate(turns, start=1):
            if turn > SHARPEST_TURN:
                raise SceneError(
                    f"task.route.waypoints_m[{k}]: the corner turns by {math.degrees(turn):.0f}°; "
                    f"allowed: at most {math.degrees(SHARPEST_TURN):.0f}°"
                )
        whole = sum(turns)
        self._whole = max(whole, 1e-9)
        self._check_lines(points)
        while len(points) > 2:
            tried, rest = self._next(points)
            self._commit(tried)
            points = rest
        return RoutePlan(
            scene=self.pair.scene,
            controller=self._entry.name,
            stages=tuple(self._stages),
            budget_m=self._budget,
            members=len(self._members),
            failed=sum(one.failed for one in self._members),
            entry=self._entry,
        )

    def _next(self, points: list[Point]) -> tuple[_Tried, list[Point]]:
        """The longest stage from the first point on, and the points of the rest of the route."""
        best = self._longest(points)
        n = 2
        while best is None:
            if abs(turn_at(points, 1)) / n < _LEAST_TURN:
                raise self._exhausted()
            parts = divided(points, 1, n, 2 * self.pair.room, self.pair.radius, EASE_M)
            whole = [points[0], *parts, *points[2:]]
            self._check_lines(whole, corner=points[1])
            best = self._longest(whole)
            n += 1
        return best

    def _longest(self, points: list[Point]) -> tuple[_Tried, list[Point]] | None:
        """As `_next`, without dividing the first corner; None: it is too much for one stage."""
        best = None
        for last in range(1, len(points) - 1):
            if last == len(points) - 2:
                part, rest = tuple(points), points[-1:]
            elif self.pair.free(points, last) < 2 * self.pair.room - 1e-9:
                continue
            else:
                way = heading(points[last], points[last + 1])
                end = self.pair.used(points, last) + self.pair.room
                between = ahead(points[last], way, end)
                part, rest = (*points[: last + 1], between), [between, *points[last + 1 :]]
            tried = self._try(part)
            if tried is None:
                break
            best = tried, rest
        return best

    def _try(self, points: tuple[Point, ...]) -> _Tried | None:
        """The stage along these points; None: it brings a member near the budget."""
        stage = StageForecast(self.pair, self._entry, self.pair.stage_scene(points))
        ends: list[Offset | None] = []
        worst = 0.0
        for k, member in enumerate(self._members):
            share = (k + 1) / len(self._members)
            turn = sum(abs(turn_at(points, i)) for i in range(1, len(points) - 1))
            self._report(min(1.0, (self._turned + share * turn) / self._whole))
            run = None if member.failed else stage.run(stage_seed(member.seed, len(self._stages)))
            if run is None or run.outcome != "delivered":
                ends.append(None)
                continue
            end, most = stage.drift(run.trace, member.offset)
            ends.append(end)
            worst = max(worst, most)
            if worst > NEAR * self._budget:
                return None
        return _Tried(points, ends, worst)

    def _commit(self, tried: _Tried) -> None:
        known = [(one.aside_m, one.turn) for one in tried.ends if one is not None]
        if len(known) < 2:
            raise SceneError(
                f"task.route: stage {len(self._stages) + 1} fails in {len(self._members)} of "
                f"{len(self._members)} simulated routes; allowed: a job that succeeds"
            )
        found: NDArray[np.float64] = np.array(known)
        aside, turn = found.mean(axis=0).tolist()
        spread, spread_turn = found.std(axis=0, ddof=1).tolist()
        drift = Offset(0.0, aside, turn)
        points = self.pair.shifted(tried.points, drift)
        for member, end in zip(self._members, tried.ends, strict=True):
            member.failed = end is None
            if end is not None:
                member.offset = left_over(end, drift)
        turned = sum(turn_at(points, k) for k in range(1, len(points) - 1)) + turn
        self._turned += abs(turned)
        stage = RouteStage(
            waypoints_m=points,
            length_m=self.pair.curve(points).length + self.pair.spread / 2,
            turn_deg=math.degrees(turned),
            drift_m=aside,
            drift_deg=math.degrees(turn),
            spread_m=spread,
            spread_deg=math.degrees(spread_turn),
            worst_m=tried.worst_m,
        )
        self._stages.append(stage)
        _refuse_walls(self.pair, stage, len(self._stages))

    def _check_lines(self, points: Sequence[Point], corner: Point | None = None) -> None:
        """Refuse lines that are too short for the corners at their ends."""
        for k in range(len(points) - 1):
            is_end = k in (0, len(points) - 2)
            needed = self.pair.room if is_end else 0.0
            if self.pair.free(points, k) < needed - 1e-9:
                x, y = points[k] if corner is None else corner
                long, least = (
                    math.ceil(1e2 * value) / 1e2
                    for value in (
                        math.dist(points[k], points[k + 1]),
                        math.dist(points[k], points[k + 1]) - self.pair.free(points, k) + needed,
                    )
                )
                what = f"the line from [{x:g}, {y:g}] is {long:g} m long"
                if corner is not None:
                    what = f"at [{x:g}, {y:g}] the corner takes several stages, and a line there "
                    what += f"is {long:g} m long"
                raise SceneError(
                    f"task.route.waypoints_m: {what}; allowed: at least {least:g} m for the "
                    "corners at its ends, or a smaller task.route.radius_m"
                )

    def _exhausted(self) -> SceneError:
        done = len(self._stages)
        spread = self._stages[-1].spread_m if self._stages else 0.0
        return SceneError(
            f"task.route: after {plural(done, 'stage')} the offset that is left over (σ "
            f"{millimetres(spread)}) leaves no room for another one within "
            f"{millimetres(self._budget)}; allowed: wider palms, less noise or fewer corners"
        )


def left_over(end: Offset, drift: Offset) -> Offset:
    """The offset at the next approach: where the object is, seen from where robots expect it."""
    return replace(end, aside_m=end.aside_m - drift.aside_m, turn=end.turn - drift.turn)


def _refuse_walls(pair: Pair, stage: RouteStage, number: int) -> None:
    curve, begin = pair.curve(stage.waypoints_m), -pair.spread / 2
    # In the frame of the curve the stage begins there, and its first line is along x.
    way = heading(stage.waypoints_m[0], stage.waypoints_m[1])
    origin = ahead(stage.waypoints_m[0], way, -begin)
    walls = [_seen_from(origin, way, wall) for wall in pair.route.walls_m or ()]
    touch = first_touch(pair.footprint.swept(curve, begin, curve.length), walls, CLEAR_M)
    if touch is not None:
        s, what, which = touch
        raise SceneError(
            f"task.route.walls_m[{which}]: {what} would come within {CLEAR_M:g} m of it, "
            f"{s - begin:.2f} m after the start of stage {number}; allowed: other walls or "
            "way points; without walls, palmbots route draws the room of the pair"
        )


def _seen_from(
    origin: Point, way: float, wall: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    cos, sin = math.cos(way), math.sin(way)
    (a, b), (c, d) = (
        (cos * x + sin * y, cos * y - sin * x)
        for x, y in ((wall[i] - origin[0], wall[i + 1] - origin[1]) for i in (0, 2))
    )
    return a, b, c, d

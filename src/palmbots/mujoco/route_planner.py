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
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palmbots._types import SIDES
from palmbots._util.text import millimetres, plural
from palmbots.control.registry import ControllerEntry, ControllerLike, refuse_reference, resolve
from palmbots.errors import SceneError
from palmbots.mujoco.drift_budget import NEAR
from palmbots.mujoco.path_curve import EASE_M, SHARPEST_TURN
from palmbots.mujoco.route_geometry import ahead, divided, first_touch, heading, turn_at
from palmbots.mujoco.route_plan import RoutePlan, RouteStage
from palmbots.mujoco.route_stage import Offset, Pair, StageForecast, left_over, stage_seed
from palmbots.scene.path_section import Point
from palmbots.scene.scene import Scene

MEMBERS = 24
CLEAR_M = 0.05  # between the pair and a wall, for steering and drift; assumed
_SEEDS_APART = 2**41
_LEAST_TURN = math.radians(5)  # of a part of a corner


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


@dataclass
class _Member:
    """One simulated route, up to the present stage."""

    seed: int
    offset: Offset = field(default_factory=Offset)
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


def _refuse_walls(pair: Pair, stage: RouteStage, number: int) -> None:
    curve, begin = pair.curve(stage.waypoints_m), -pair.spread / 2
    # In the frame of the curve the stage begins there, and its first line is along x.
    way = heading(stage.waypoints_m[0], stage.waypoints_m[1])
    walls = pair.walls_seen_from(ahead(stage.waypoints_m[0], way, -begin), way)
    touch = first_touch(pair.footprint.swept(curve, begin, curve.length), walls, CLEAR_M)
    if touch is not None:
        s, what, which = touch
        raise SceneError(
            f"task.route.walls_m[{which}]: {what} would come within {CLEAR_M:g} m of it, "
            f"{s - begin:.2f} m after the start of stage {number}; allowed: other walls or "
            "way points; without walls, palmbots route draws the room of the pair"
        )

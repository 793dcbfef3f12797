# SPDX-License-Identifier: Apache-2.0
"""One stage of a route: its path, its scene, and the forecast of where it leaves the object.

Assumed: robots know their own place, and where along its axis they have left the object.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from palmbots._types import SIDES
from palmbots.control.registry import ControllerEntry
from palmbots.errors import SceneError
from palmbots.mujoco.curved_world import held, line_of
from palmbots.mujoco.drift_forecast import Forecast, SlipRates
from palmbots.mujoco.mjcf import layout
from palmbots.mujoco.path_curve import Curve, corner_length, curve_of
from palmbots.mujoco.route_geometry import (
    Footprint,
    Wall,
    ahead,
    crossing,
    heading,
    seen_from,
    turn_at,
)
from palmbots.scene.chassis import axle_out
from palmbots.scene.path_section import Path, Point
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.prepare import Prepared, prepare

RADIUS_M = 1.0
_BETWEEN_STAGES = 2**42  # of their seeds
_APPROACH_M = 0.03  # of a nose to the object at the start of a job


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

    def walls_seen_from(self, origin: Point, way: float) -> tuple[Wall, ...]:
        """The walls in the frame with this origin, whose x points along this heading."""
        return tuple(
            (*seen_from(origin, way, wall[:2]), *seen_from(origin, way, wall[2:]))
            for wall in self.route.walls_m or ()
        )

    def walls_in_stage(self, points: Sequence[Point], offset: Offset) -> tuple[Wall, ...]:
        """The walls in the frame of MuJoCo's world, in the stage of `stage_scene`."""
        way = heading(points[0], points[1])
        begins = ahead(points[0], way, offset.ahead_m)
        return self.walls_seen_from(begins, way if self.sense > 0 else way + math.pi)

    def shifted(self, points: Sequence[Point], drift: Offset) -> tuple[Point, ...]:
        """The points of a stage after which an object that drifts so stands at the last one."""
        way = heading(points[-2], points[-1])
        aim = way - drift.turn
        end = ahead(points[-1], way, 0.0, -drift.aside_m)
        last = crossing(points[-3], heading(points[-3], points[-2]), end, aim)
        return (*points[:-2], last, end)


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


def left_over(end: Offset, drift: Offset) -> Offset:
    """The offset at the next approach: where the object is, seen from where robots expect it."""
    return replace(end, aside_m=end.aside_m - drift.aside_m, turn=end.turn - drift.turn)

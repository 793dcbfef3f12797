# SPDX-License-Identifier: Apache-2.0
"""The scene in MuJoCo on a curved path: the axles of both robots follow the same line.

A robot drives along the path at the commanded speed. It knows its own position exactly (an
assumption) and steers with line-of-sight guidance: it turns with the path, and back to a heading
that leads to the path within `_AHEAD`. Controllers are not aware of the path.

Distances along the path are arc lengths, towards +x at the start. Contacts lie where the edge of
the object and the palm overlap; their ends are computed at every tick (`edge_contacts`).
"""

import math
from dataclasses import dataclass
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.errors import SceneError
from palmbots.mujoco.contact_forces import Point
from palmbots.mujoco.edge_contacts import fit_edges
from palmbots.mujoco.engine_settings import DEFAULT, Engine
from palmbots.mujoco.lift_world import LiftWorld
from palmbots.mujoco.mjcf import layout
from palmbots.mujoco.path_curve import LEAD_M, Curve, Spot, curve_of
from palmbots.mujoco.robot_mjcf import lifts
from palmbots.mujoco.world import MujocoWorld
from palmbots.scene.chassis import axle_out, chassis
from palmbots.scene.scene import Scene, load_scene

_AHEAD = 0.1  # m, distance within which a robot aims to return to its path
_GAIN = 5.0  # 1/s, gain with which it turns to its heading
_OUT = (-1.0, 1.0)


def world_of(scene: Scene, engine: Engine = DEFAULT, measures: bool = True) -> MujocoWorld:
    """The world of a scene: on a straight or a curved path, or with arms."""
    is_curved = scene.task.path.is_curved
    if lifts(scene):
        return (CurvedLiftWorld if is_curved else LiftWorld)(scene, engine, measures)
    return (CurvedWorld if is_curved else MujocoWorld)(scene, engine, measures)


@dataclass(frozen=True)
class Line:
    """A path in the frame of the world, in which the pair starts at x = 0."""

    curve: Curve
    sense: float
    """Direction of travel: 1 towards +x, −1 towards −x."""
    start: float
    """Arc length of the middle of the pair at the start; < 0: before the curve begins."""
    spread: float
    """Distance of the two axles along the path at the start [m]."""

    def at(self, distance: float) -> Spot:
        """Position, heading and curvature at a distance towards +x."""
        spot = self.curve.at(self.start + self.sense * distance)
        x, y = self.sense * (spot.x - self.start), self.sense * spot.y
        return Spot(x, y, spot.heading, self.sense * spot.curvature)

    def nearest(self, x: float, y: float, guess: float) -> float:
        """The distance of the point of the path nearest to (x, y), near a guess."""
        s = self.curve.nearest(
            self.start + self.sense * x, self.sense * y, self.start + self.sense * guess
        )
        return self.sense * (s - self.start)


def line_of(scene: Scene) -> Line:
    """The path of a scene.

    Raises:
        SceneError: the path is too tight or too long for the pair, or the scene has a slope,
            ridges, walls or stands.
    """
    task = scene.task
    if task.slope_deg != 0:
        raise SceneError(
            f"task.slope_deg: {task.slope_deg:g} would tilt palms sideways on a curved path; "
            "allowed: 0, or task.path.kind = straight"
        )
    for key, given in (
        ("mujoco.ridges", scene.mujoco.ridges),
        ("floor.walls", scene.floor.walls),
        ("floor.stands", scene.floor.stands),
    ):
        if given:
            raise SceneError(
                f"{key}: lie across a straight path; allowed: none, or task.path.kind = straight"
            )
    left, right = layout(held(scene)).pivots
    spread = right - left + 2 * axle_out(scene)
    curve = curve_of(task.path, task.distance_m + spread, spread)
    lead = LEAD_M if task.path.lead_in_m is None else task.path.lead_in_m
    sense = 1.0 if task.direction == "forward" else -1.0
    return Line(curve, sense, -(lead + spread / 2), spread)


def held(scene: Scene) -> Scene:
    """The scene with the object on both palms at the start, also where the robots pick it up."""
    if getattr(scene.task, "from") == "palms":
        return scene
    return load_scene(scene, {"task.from": "palms"})


class CurvedWorld(MujocoWorld):
    """A scene on its curved path in MuJoCo."""

    def __init__(
        self, scene: Scene, engine: Engine = DEFAULT, measures: bool = True, **start: Any
    ) -> None:
        """`start`: of a job on the floor, see `LiftWorld`."""
        self.line = line_of(scene)
        at, out = layout(scene), axle_out(scene)
        self._distance = [at.pivots[0] - out, at.pivots[1] + out]  # of the axles along the path
        self._axle = chassis(at.height, out).axle
        super().__init__(scene, engine, measures, **start)

    def sight(self, first: bool = False) -> _core.WorldObservation:
        """Observe the present instant; the contacts are computed first."""
        fit_edges(self.model, self.data, self._edges)
        return super().sight(first)

    @property
    def way(self) -> float:
        """Position of the middle of the pair along the path, towards +x at the start [m]."""
        return 0.5 * sum(self._distance)

    # --- inside ---------------------------------------------------------------------------------

    def _find(self) -> None:
        super()._find()
        self._body_pos = [self.data.body(f"{side}_body").xpos for side in SIDES]
        self._mj.mj_kinematics(
            self.model, self.data
        )  # before the first step all positions are zero

    def _turning(self, k: int, speed: float) -> float:
        spot, x, y = self._locate(k)
        cos, sin = math.cos(spot.heading), math.sin(spot.heading)
        aside = (y - spot.y) * cos - (x - spot.x) * sin
        off = math.remainder(self._yaw(k) - spot.heading, 2 * math.pi)
        aim = -math.atan(aside / _AHEAD) * max(-1.0, min(1.0, speed / 0.02))
        along = speed * math.cos(off) / (1 - spot.curvature * aside)
        return spot.curvature * along - _GAIN * (off - aim)

    def _locate(self, k: int) -> tuple[Spot, float, float]:
        """The point of the path at which a robot is, and the position of its axle."""
        pos, mat = self._body_pos[k].tolist(), self._body_mat[k].tolist()
        out = _OUT[k] * self._axle
        x, y = pos[0] + out * mat[0], pos[1] + out * mat[3]
        self._distance[k] = self.line.nearest(x, y, self._distance[k])
        return self.line.at(self._distance[k]), x, y

    def _distances(self) -> tuple[float, float]:
        self._locate(0)
        self._locate(1)
        return self._distance[0], self._distance[1]

    def _separation(self, distances: tuple[float, float]) -> float:
        (ax, ay, _), (bx, by, _) = (pos.tolist() for pos in self._palm_pos)
        return math.hypot(bx - ax, by - ay)

    def _in_palm_frame(self, k: int, point: Point) -> Point:
        pos, mat = self._palm_pos[k].tolist(), self._palm_mat[k].tolist()
        d = [point[i] - pos[i] for i in range(3)]
        along, lateral, above = (sum(d[i] * mat[3 * i + j] for i in range(3)) for j in range(3))
        return _OUT[k] * along, lateral, above - self._offset[k]

    def _palms(self) -> tuple[float, float]:
        left, right = self._palm_mat
        return -math.asin(float(left[6])), math.asin(float(right[6]))

    def _fit(self) -> None:
        fit_edges(self.model, self.data, self._edges)


class CurvedLiftWorld(CurvedWorld, LiftWorld):
    """A job that begins or ends on the floor, on a curved path in MuJoCo."""

    def _com_x(self) -> float:
        """The position of the COM along the path."""
        spec, at, mat = self.layout.spec, self._object_pos.tolist(), self._object_mat.tolist()
        x, y = (
            at[i] + mat[3 * i] * spec.com_left + mat[3 * i + 2] * spec.com_height for i in (0, 1)
        )
        return self.line.nearest(x, y, 0.5 * sum(self._distance))

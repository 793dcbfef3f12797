"""The dynamic world on a curved path: each robot's axle follows the same line on the floor.

A robot drives along the path as fast as it is told, and steers by its own place (which it knows
exactly: assumed) with line-of-sight guidance: it turns as the path does, and back to a heading that
leads to the path within `_AHEAD`. Controllers know nothing of it.

Ways along the path are arc lengths, towards +x at the start. Contacts lie where the object's edge
and the palm overlap: their ends are found anew at every tick (`edges`).
"""

import math
from dataclasses import dataclass

from palmbots import _core
from palmbots.dynamic.edges import fit_edges
from palmbots.dynamic.model import layout
from palmbots.dynamic.robot_model import axle_out, chassis
from palmbots.dynamic.settings import DEFAULT, Engine
from palmbots.dynamic.world import MujocoWorld, Point
from palmbots.errors import SceneError
from palmbots.geometry import SIDES
from palmbots.path import LEAD_M, Curve, Spot, curve_of
from palmbots.scene import Scene

__all__ = ["CurvedWorld", "Line", "line_of", "world_of"]

_AHEAD = 0.1  # m, within which a robot aims to be back on its path
_GAIN = 5.0  # 1/s, with which it turns to its heading
_OUT = (-1.0, 1.0)


def world_of(scene: Scene, engine: Engine = DEFAULT, measures: bool = True) -> MujocoWorld:
    """The dynamic world of a scene, on whatever path."""
    kind = CurvedWorld if scene.task.path.is_curved else MujocoWorld
    return kind(scene, engine, measures)


@dataclass(frozen=True)
class Line:
    """A path in the world's frame, where the pair stands at x = 0 at the start."""

    curve: Curve
    sense: float
    """Of travel: 1 towards +x, −1 towards −x."""
    start: float
    """Arc length of the middle of the pair at the start, < 0: before the curve begins."""
    spread: float
    """Of the two axles along the path at the start [m]."""

    def at(self, way: float) -> Spot:
        """The place at a way towards +x; its heading and curvature likewise."""
        spot = self.curve.at(self.start + self.sense * way)
        x, y = self.sense * (spot.x - self.start), self.sense * spot.y
        return Spot(x, y, spot.heading, self.sense * spot.curvature)

    def nearest(self, x: float, y: float, way: float) -> float:
        """The way whose place is nearest to (x, y), near the guess `way`."""
        s = self.curve.nearest(
            self.start + self.sense * x, self.sense * y, self.start + self.sense * way
        )
        return self.sense * (s - self.start)


def line_of(scene: Scene) -> Line:
    """The path of a scene. Raises `SceneError` where it is too tight or too long for the pair, or
    where the scene has what a curved path cannot have."""
    task = scene.task
    if task.slope_deg != 0:
        raise SceneError(
            f"task.slope_deg: {task.slope_deg:g} would tilt palms sideways on a curved path; "
            "allowed: 0, or task.path.kind = straight"
        )
    if scene.dynamic.ridges:
        raise SceneError(
            "dynamic.ridges: lie across a straight way; allowed: none, or task.path.kind = straight"
        )
    left, right = layout(scene).pivots
    spread = right - left + 2 * axle_out(scene)
    curve = curve_of(task.path, task.distance_m + spread, spread)
    lead = LEAD_M if task.path.lead_m is None else task.path.lead_m
    sense = 1.0 if task.direction == "forward" else -1.0
    return Line(curve, sense, -(lead + spread / 2), spread)


class CurvedWorld(MujocoWorld):
    """A scene on its curved path in MuJoCo."""

    def __init__(self, scene: Scene, engine: Engine = DEFAULT, measures: bool = True) -> None:
        self.line = line_of(scene)
        half = self.line.spread / 2
        self._where = [-half, half]  # of the axles, as ways
        at = layout(scene)
        self._axle = chassis(at.height, axle_out(scene)).axle
        super().__init__(scene, engine, measures)

    def sight(self, first: bool = False) -> _core.Sight:
        """As in every world; contacts are found anew."""
        fit_edges(self.model, self.data, self._edges)
        return super().sight(first)

    @property
    def way(self) -> float:
        """How far along the path the pair's middle is, towards +x at the start [m]."""
        return 0.5 * sum(self._where)

    # --- inside ---------------------------------------------------------------------------------

    def _find(self) -> None:
        super()._find()
        self._body_pos = [self.data.body(f"{side}_body").xpos for side in SIDES]
        self._mj.mj_kinematics(self.model, self.data)  # before the first step nothing has a place

    def _turning(self, k: int, speed: float) -> float:
        spot, x, y = self._locate(k)
        cos, sin = math.cos(spot.heading), math.sin(spot.heading)
        aside = (y - spot.y) * cos - (x - spot.x) * sin
        off = math.remainder(self._yaw(k) - spot.heading, 2 * math.pi)
        aim = -math.atan(aside / _AHEAD) * max(-1.0, min(1.0, speed / 0.02))
        along = speed * math.cos(off) / (1 - spot.curvature * aside)
        return spot.curvature * along - _GAIN * (off - aim)

    def _locate(self, k: int) -> tuple[Spot, float, float]:
        """Where on the path a robot is, and where its axle."""
        pos, mat = self._body_pos[k].tolist(), self._body_mat[k].tolist()
        out = _OUT[k] * self._axle
        x, y = pos[0] + out * mat[0], pos[1] + out * mat[3]
        self._where[k] = self.line.nearest(x, y, self._where[k])
        return self.line.at(self._where[k]), x, y

    def _ways(self) -> tuple[float, float]:
        self._locate(0)
        self._locate(1)
        return self._where[0], self._where[1]

    def _separation(self, ways: tuple[float, float]) -> float:
        (ax, ay, _), (bx, by, _) = (pos.tolist() for pos in self._palm_pos)
        return math.hypot(bx - ax, by - ay)

    def _seen(self, k: int, point: Point) -> Point:
        pos, mat = self._palm_pos[k].tolist(), self._palm_mat[k].tolist()
        d = [point[i] - pos[i] for i in range(3)]
        along, across, above = (sum(d[i] * mat[3 * i + j] for i in range(3)) for j in range(3))
        return _OUT[k] * along, across, above - self._offset[k]

    def _palms(self) -> tuple[float, float]:
        left, right = self._palm_mat
        return -math.asin(float(left[6])), math.asin(float(right[6]))

    def _fit(self) -> None:
        fit_edges(self.model, self.data, self._edges)

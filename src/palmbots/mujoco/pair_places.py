# SPDX-License-Identifier: Apache-2.0
"""Where palms, robots and object are in MuJoCo.

Frame: that of `mjcf`. A contact coordinate is the position of a vertex of the object along its
palm, from the foot of the pivot, outward [m].
"""

import math
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.mujoco.contact_forces import Point
from palmbots.mujoco.mjcf import Layout
from palmbots.scene.scene import Scene
from palmbots.scene.spec import contact_radii

_OUT = (-1.0, 1.0)


class PairPlaces:
    """What can be read off the state of `data`, which is MuJoCo's own."""

    def __init__(self, scene: Scene, layout: Layout, model: Any, data: Any) -> None:
        self.scene, self.layout, self.model, self.data = scene, layout, model, data
        self._radius = scene.mujoco.wheel_radius_m
        self._first = _core.first_angles(layout.spec)
        m = model
        self._wrist_at = [int(m.joint(f"{side}_wrist").qposadr[0]) for side in SIDES]
        self._wheel_at = [
            [int(m.joint(f"{side}_{wheel}").dofadr[0]) for wheel in ("port", "starboard")]
            for side in SIDES
        ]
        self._wheel_qpos_at = [
            [int(m.joint(f"{side}_{wheel}").qposadr[0]) for wheel in ("port", "starboard")]
            for side in SIDES
        ]
        bodies = {name: m.body(name).id for s in SIDES for name in (f"{s}_palm", f"{s}_body")}
        object_body = m.body("object").id
        d = data
        # Views into MuJoCo's arrays, which change with every step.
        self._palm_pos = [d.xpos[bodies[f"{s}_palm"]] for s in SIDES]
        self._palm_mat = [d.xmat[bodies[f"{s}_palm"]] for s in SIDES]
        self._body_mat = [d.xmat[bodies[f"{s}_body"]] for s in SIDES]
        self._object_pos, self._object_mat = d.xpos[object_body], d.xmat[object_body]
        spec = layout.spec
        radii = contact_radii(spec)
        self._offset = [palm.offset + r for palm, r in zip(spec.palms, radii, strict=True)]
        self._width = spec.width

    @property
    def contacts(self) -> tuple[float, float]:
        """The contact coordinates p [m]."""
        left, right = self._vertices()
        return self._in_palm_frame(0, left)[0], self._in_palm_frame(1, right)[0]

    @property
    def lifts(self) -> tuple[float, float]:
        """Heights of the middles of the contact edges above their palms [m]; < 0: the contact is
        compressed."""
        left, right = self._vertices()
        return self._in_palm_frame(0, left)[2], self._in_palm_frame(1, right)[2]

    def wrists(self) -> tuple[float, float]:
        """The palm angles as the wrists measure them [rad]."""
        q = self.data.qpos
        return (
            float(q[self._wrist_at[0]]) + self._first[0],
            float(q[self._wrist_at[1]]) + self._first[1],
        )

    def rolled(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """How far the rims of the port and the starboard wheel of each robot have turned towards
        +x [m]."""
        left, right = (
            (self._radius * float(self.data.qpos[a]), self._radius * float(self.data.qpos[b]))
            for a, b in self._wheel_qpos_at
        )
        return left, right

    def _distances(self) -> tuple[float, float]:
        """Positions of the pivots along the path, towards +x at the start [m]; here their x."""
        return float(self._palm_pos[0][0]), float(self._palm_pos[1][0])

    def _separation(self, distances: tuple[float, float]) -> float:
        return distances[1] - distances[0]

    def _midpoint(self) -> float:
        return 0.5 * sum(self._distances())

    def _vertices(self) -> tuple[Point, Point]:
        """The middles of the two contact edges (x, y, z)."""
        x, y, z = self._object_pos.tolist()
        ax, _, _, ay, _, _, az, _, _ = self._object_mat.tolist()
        w = self._width
        return (x, y, z), (x + w * ax, y + w * ay, z + w * az)

    def _in_palm_frame(self, k: int, point: Point) -> Point:
        """A point in the frame of a palm: outward along it, lateral to its left, above it."""
        pos, mat = self._palm_pos[k].tolist(), self._palm_mat[k].tolist()
        dx, dz = point[0] - pos[0], point[2] - pos[2]
        along = dx * mat[0] + dz * mat[6]
        above = dx * mat[2] + dz * mat[8] - self._offset[k]
        return _OUT[k] * along, point[1] - pos[1], above

    @property
    def lateral(self) -> tuple[float, float]:
        """Lateral position of the middle of each contact edge on its palm, to the left seen
        towards +x [m]; no sensor measures it."""
        left, right = self._vertices()
        return self._in_palm_frame(0, left)[1], self._in_palm_frame(1, right)[1]

    def _palms(self) -> tuple[float, float]:
        left, right = self._palm_mat
        return (
            -math.atan2(float(left[6]), float(left[0])),
            math.atan2(float(right[6]), float(right[0])),
        )

    def _pitches(self) -> tuple[float, float]:
        left, right = self._body_mat
        return -math.asin(float(left[6])), math.asin(float(right[6]))

    def _yaw(self, k: int) -> float:
        mat = self._body_mat[k]
        return math.atan2(float(mat[3]), float(mat[0]))

    def _places(self) -> list[tuple[float, float]]:
        """Pivots and contact edges seen from above: x, y, x, y."""
        one, two = (pos.tolist() for pos in self._palm_pos)
        left, right = self._vertices()
        return [(a[i], b[i]) for a, b in ((one, two), (left, right)) for i in (0, 1)]

# SPDX-License-Identifier: Apache-2.0
"""Draws friction cones, forces and the path into MuJoCo's images, for videos and the viewer.

At each palm the friction cone (green: the contact sticks, purple: it slides) and the force on the
object (an arrow, 25 mm for each newton), both moved to the near side, where the object does not
hide them. The line that the robots follow lies on the floor, and walls beside it stand there.
"""

import itertools
import math
from typing import Any

import numpy as np

from palmbots._types import SIDES
from palmbots._util.xml_attributes import rgba
from palmbots.mujoco.curved_world import Line
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.route_geometry import Wall
from palmbots.scene.scene import Scene
from palmbots.viz.style import BOTH, INK, PATH, QUIET, ZERO

METRES_PER_NEWTON = 0.025
_CONE_M, _SPOKES = 0.07, 16
_WALL_M = (0.03, 0.2)  # thickness and height of a drawn wall


class Overlay:
    """The overlay of one world; `into` is a scene of MuJoCo's renderer or viewer."""

    def __init__(self, model: Any, data: Any, scene: Scene) -> None:
        self._mj, self._model, self._data = mujoco(), model, data
        self._friction = [math.atan(scene.palm_of(side).friction) for side in SIDES]
        self._palms = [model.body(f"{side}_palm").id for side in SIDES]
        self._object = model.body("object").id
        palm = max(scene.palm_of(side).width_m for side in SIDES)
        self._near = -0.5 * max(palm, scene.object.depth_m) - 0.01

    def path(self, into: Any, line: Line, way: float) -> None:
        """The path of the robots near the position of their middle [m]."""
        colour = np.fromstring(rgba(PATH), sep=" ", dtype=np.float32)
        spots = [line.at(way + s) for s in np.linspace(-1.0, 1.0, 61)]
        points = [np.array([spot.x, spot.y, 0.001]) for spot in spots]
        for start, end in itertools.pairwise(points):
            self.bar(into, 0.004, start, end, colour)

    def wall(self, into: Any, ends: Wall) -> None:
        """A wall on the floor, which hides little: it is low and translucent."""
        if into.ngeom >= into.maxgeom:
            return
        start, end = np.array(ends[:2]), np.array(ends[2:])
        along = end - start
        way = math.atan2(along[1], along[0])
        cos, sin = math.cos(way), math.sin(way)
        colour = np.fromstring(rgba(QUIET, 0.6), sep=" ", dtype=np.float32)
        size = np.array([0.5 * math.hypot(*along), 0.5 * _WALL_M[0], 0.5 * _WALL_M[1]])
        pos = np.array([*(0.5 * (start + end)), size[2]])
        turned = np.array([cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0])
        box = self._mj.mjtGeom.mjGEOM_BOX
        self._mj.mjv_initGeom(into.geoms[into.ngeom], box, size, pos, turned, colour)
        into.ngeom += 1

    def contacts(
        self, into: Any, motion: tuple[int, int], lookat: np.ndarray, ahead: np.ndarray
    ) -> None:
        """Friction cone and force at both palms, at their centres of pressure.

        `motion`: whether each slides, 0 if not; `lookat`: what the camera looks at [m]; `ahead`:
        unit vector from the left robot to the right one.
        """
        for k in (0, 1):
            self._contact(into, k, motion[k], lookat, ahead)

    def _contact(
        self, into: Any, k: int, motion: int, lookat: np.ndarray, ahead: np.ndarray
    ) -> None:
        m, d = self._model, self._data
        place, force, normal = np.zeros(3), np.zeros(3), 0.0
        six = np.zeros(6)
        for i in range(d.ncon):
            contact = d.contact[i]
            bodies = [int(m.geom_bodyid[g]) for g in contact.geom]
            if set(bodies) != {self._palms[k], self._object} or contact.efc_address < 0:
                continue
            if any("_lip_" in m.geom(int(g)).name for g in contact.geom):
                continue
            self._mj.mj_contactForce(m, d, i, six)
            sign = 1.0 if bodies[0] == self._palms[k] else -1.0  # on the object
            force += sign * (contact.frame.reshape(3, 3).T @ six[:3])
            place += six[0] * contact.pos
            normal += six[0]
        if normal < 1e-3:
            return
        place /= normal
        # On the near side of the object, facing the camera.
        left = np.array([-ahead[1], ahead[0], 0.0])
        force -= left * (force @ left)
        place += left * (self._near - (place - lookat) @ left)
        axis = d.xmat[self._palms[k]].reshape(3, 3)
        colour = np.fromstring(rgba(BOTH if motion else ZERO, 0.9), sep=" ", dtype=np.float32)
        rim = []
        spread = math.tan(self._friction[k])
        for spoke in range(_SPOKES):
            around = 2 * math.pi * spoke / _SPOKES
            lean = spread * (math.cos(around) * axis[:, 0] + math.sin(around) * axis[:, 1])
            rim.append(place + _CONE_M * (axis[:, 2] + lean))
        for spoke in range(_SPOKES):
            self.bar(into, 0.0008, place, rim[spoke], colour)
            self.bar(into, 0.0012, rim[spoke - 1], rim[spoke], colour)
        dark = np.fromstring(rgba(INK), sep=" ", dtype=np.float32)
        tip = place + METRES_PER_NEWTON * force
        self.bar(into, 0.0025, place, tip, dark)
        across = 0.3 * (force[2] * ahead - (force @ ahead) * np.array([0.0, 0.0, 1.0]))
        for side in (-1, 1):  # MuJoCo draws its own arrows at half their length
            barb = 0.25 * METRES_PER_NEWTON * (force + side * across * 2)
            self.bar(into, 0.0025, tip - barb, tip, dark)

    def bar(
        self, into: Any, width: float, start: np.ndarray, end: np.ndarray, colour: np.ndarray
    ) -> None:
        """A rounded bar from start to end [m], unless the scene is full."""
        if into.ngeom >= into.maxgeom:
            return
        shape = self._mj.mjtGeom.mjGEOM_CAPSULE
        geom = into.geoms[into.ngeom]
        self._mj.mjv_initGeom(geom, shape, np.zeros(3), np.zeros(3), np.zeros(9), colour)
        self._mj.mjv_connector(geom, shape, width, start, end)
        into.ngeom += 1

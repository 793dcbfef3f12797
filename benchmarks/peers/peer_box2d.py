# SPDX-License-Identifier: Apache-2.0
"""The task in Box2D version 3 (pyb2d3): kinematic palms, 5 ms steps of four substeps.

Box2D keeps a skin of about 1 cm around polygons, so everything is 20 times as large here.
"""

import importlib
import importlib.metadata
from typing import Any

from peers.common_task import COM_HEIGHT, FRICTION, HALF_PALM, HEIGHT, MASS, STEEP, WIDTH

# Its wheel has no types that a checker could follow; without the wheel it is not there at all.
b2: Any = importlib.import_module("pyb2d3")

STEP, SUBSTEPS = 0.005, 4
SCALE = 20.0
THICK = 0.01


class Box2d:
    """See `task.Engine`."""

    def __init__(self) -> None:
        self.world = b2.World(gravity=(0, -9.80665 * SCALE))
        self.palms = []
        for side, x in ((0, 0.0), (1, WIDTH)):
            palm = self.world.create_kinematic_body(
                position=(x * SCALE, 0), rotation=-STEEP if side == 0 else STEEP
            )
            corners = [(-HALF_PALM, -THICK), (HALF_PALM, -THICK), (HALF_PALM, 0), (-HALF_PALM, 0)]
            palm.create_shape(_shape(), _polygon(corners))
            self.palms.append(palm)
        half = WIDTH / 2
        corners = [(-half, 0.0), (half, 0.0), (half, HEIGHT), (-half, HEIGHT)]
        self.box = self.world.create_dynamic_body(
            position=(half * SCALE, 0.002 * SCALE), enable_sleep=False
        )
        self.box.create_shape(_shape(), _polygon(corners))
        mass = b2.MassData()
        mass.mass, mass.center = MASS, (0, COM_HEIGHT * SCALE)
        mass.rotational_inertia = MASS * SCALE**2 * (WIDTH**2 + HEIGHT**2) / 12  # about the centre
        self.box.mass_data = mass

    def drive(self, side: int, speed: float, turn_rate: float) -> None:
        """Sets how a palm moves."""
        self.palms[side].linear_velocity = (speed * SCALE, 0)
        self.palms[side].angular_velocity = turn_rate

    def step(self, seconds: float) -> None:
        """Advances the engine."""
        for _ in range(round(seconds / STEP)):
            self.world.step(STEP, SUBSTEPS)

    def palm(self, side: int) -> tuple[float, float]:
        """Pivot and angle."""
        return self.palms[side].position.x / SCALE, self.palms[side].angle

    def corner(self, side: int) -> tuple[float, float]:
        """A lower corner of the box."""
        half = -WIDTH / 2 if side == 0 else WIDTH / 2
        at = self.box.world_point((half * SCALE, 0))
        return at.x / SCALE, at.y / SCALE


def _shape() -> Any:
    return b2.shape_def(density=1.0, material=b2.surface_material(friction=FRICTION))


def _polygon(corners: list[tuple[float, float]]) -> Any:
    return b2.polygon(points=[(a * SCALE, b * SCALE) for a, b in corners])


def version() -> str:
    """The engine's version, which the wheel does not state, and that of the wheel."""
    return f"3.1.1 (pyb2d3 {importlib.metadata.version('pyb2d3')})"

# SPDX-License-Identifier: Apache-2.0
"""The task in Rapier (rapier3d, single precision): kinematic palms, 5 ms steps, planar motion.

Rapier's own Python wheel exists for three dimensions only, so the box has a depth, as in MuJoCo.
"""

import importlib
import importlib.metadata
import math
from typing import Any

from peers.common_task import COM_HEIGHT, FRICTION, HALF_PALM, HEIGHT, MASS, STEEP, WIDTH

# Its wheel has no types that a checker could follow; without the wheel it is not there at all.
rapier: Any = importlib.import_module("rapier3d")

STEP = 0.005
THICK, DEPTH = 0.01, 0.1
INERTIA = MASS * (WIDTH**2 + HEIGHT**2) / 12  # only the one about z plays a part


class Rapier:
    """See `task.Engine`."""

    def __init__(self) -> None:
        self.world = rapier.PhysicsWorld(gravity=(0.0, -9.80665, 0.0))
        parameters = self.world.integration_parameters
        parameters.dt = STEP
        parameters.length_unit = 0.1  # tolerances for objects of this size
        parameters.num_solver_iterations = 8
        self.palms = []
        for side, x in ((0, 0.0), (1, WIDTH)):
            body = rapier.RigidBody.kinematic_velocity_based().translation((x, 0.0, 0.0))
            turned = body.rotation((0.0, 0.0, -STEEP if side == 0 else STEEP))
            half = (HALF_PALM, THICK / 2, 0.35 * DEPTH)
            self.palms.append(
                self.world.add_body(turned, [_cuboid(half).translation((0.0, -THICK / 2, 0.0))])
            )
        low = (WIDTH / 2, HEIGHT / 2, DEPTH / 2)
        body = (
            rapier.RigidBody.dynamic()
            .translation((WIDTH / 2, 0.0, 0.0))
            .enabled_translations((True, True, False))
            .enabled_rotations((False, False, True))
            .can_sleep(False)
        )
        mass = rapier.MassProperties((0.0, COM_HEIGHT - HEIGHT / 2, 0.0), MASS, (INERTIA,) * 3)
        shape = _cuboid(low).translation((0.0, HEIGHT / 2, 0.0)).mass_properties(mass)
        self.box = self.world.add_body(body, [shape])

    def drive(self, side: int, speed: float, turn_rate: float) -> None:
        """Sets how a palm moves."""
        palm = self._body(self.palms[side])
        palm.linvel = (speed, 0.0, 0.0)
        palm.angvel = (0.0, 0.0, turn_rate)

    def step(self, seconds: float) -> None:
        """Advances the engine."""
        for _ in range(round(seconds / STEP)):
            self.world.step()

    def palm(self, side: int) -> tuple[float, float]:
        """Pivot and angle."""
        palm = self._body(self.palms[side])
        return palm.translation.x, _angle(palm)

    def corner(self, side: int) -> tuple[float, float]:
        """A lower corner of the box."""
        box = self._body(self.box)
        at, turned = box.translation, _angle(box)
        half = -WIDTH / 2 if side == 0 else WIDTH / 2
        return at.x + half * math.cos(turned), at.y + half * math.sin(turned)

    def _body(self, handle: Any) -> Any:
        return self.world.rigid_bodies[handle]


def _cuboid(half: tuple[float, float, float]) -> Any:
    return rapier.Collider.cuboid(*half).friction(FRICTION)


def _angle(body: Any) -> float:
    """The rotation about z, which is the only one."""
    turned = body.rotation
    return 2 * math.atan2(turned.k, turned.w)


def version() -> str:
    """The engine's version."""
    return importlib.metadata.version("rapier3d")

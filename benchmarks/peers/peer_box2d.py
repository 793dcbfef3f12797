# SPDX-License-Identifier: Apache-2.0
"""The task in Box2D (pybox2d): kinematic palms, 5 ms steps.

Box2D keeps a skin of about 1 cm around polygons, so everything is 20 times as large here.
"""

import Box2D

from peers.common_task import COM_HEIGHT, FRICTION, HALF_PALM, HEIGHT, MASS, STEEP, WIDTH

STEP = 0.005
SCALE = 20.0
THICK = 0.01


class Box2d:
    """See `task.Engine`."""

    def __init__(self) -> None:
        self.world = Box2D.b2World(gravity=(0, -9.80665 * SCALE))
        self.palms = []
        for side, x in ((0, 0.0), (1, WIDTH)):
            body = self.world.CreateKinematicBody(
                position=(x * SCALE, 0), angle=-STEEP if side == 0 else STEEP
            )
            corners = [(-HALF_PALM, -THICK), (HALF_PALM, -THICK), (HALF_PALM, 0), (-HALF_PALM, 0)]
            body.CreatePolygonFixture(
                vertices=[(a * SCALE, b * SCALE) for a, b in corners], friction=FRICTION
            )
            self.palms.append(body)
        half = WIDTH / 2
        corners = [(-half, 0.0), (half, 0.0), (half, HEIGHT), (-half, HEIGHT)]
        self.box = self.world.CreateDynamicBody(position=(half * SCALE, 0.002 * SCALE))
        self.box.CreatePolygonFixture(
            vertices=[(a * SCALE, b * SCALE) for a, b in corners],
            friction=FRICTION,
            density=MASS / (WIDTH * HEIGHT * SCALE**2),
        )
        data = self.box.massData
        about_centre = MASS * SCALE**2 * (WIDTH**2 + HEIGHT**2) / 12
        data.mass = MASS
        data.center = (0, COM_HEIGHT * SCALE)
        data.I = about_centre + MASS * (COM_HEIGHT * SCALE) ** 2  # about the body's origin
        self.box.massData = data
        self.box.sleepingAllowed = False

    def drive(self, side: int, speed: float, turn_rate: float) -> None:
        """Sets how a palm moves."""
        self.palms[side].linearVelocity = (speed * SCALE, 0)
        self.palms[side].angularVelocity = turn_rate

    def step(self, seconds: float) -> None:
        """Advances the engine."""
        for _ in range(round(seconds / STEP)):
            self.world.Step(STEP, 20, 10)

    def palm(self, side: int) -> tuple[float, float]:
        """Pivot and angle."""
        return self.palms[side].position.x / SCALE, self.palms[side].angle

    def corner(self, side: int) -> tuple[float, float]:
        """A lower corner of the box."""
        half = -WIDTH / 2 if side == 0 else WIDTH / 2
        at = self.box.GetWorldPoint((half * SCALE, 0))
        return at.x / SCALE, at.y / SCALE


def version() -> str:
    """The engine's version."""
    return Box2D.__version__

# SPDX-License-Identifier: Apache-2.0
"""The task in pymunk (Chipmunk): kinematic palms, 5 ms steps."""

import pymunk

from peers.common_task import COM_HEIGHT, FRICTION, HALF_PALM, HEIGHT, MASS, STEEP, WIDTH

STEP = 0.005
THICK = 0.01


class Pymunk:
    """See `task.Engine`."""

    def __init__(self) -> None:
        self.space = pymunk.Space()
        self.space.gravity = (0, -9.80665)
        self.space.collision_slop = 1e-5
        self.space.iterations = 30
        self.palms = []
        for side, x in ((0, 0.0), (1, WIDTH)):
            body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            body.position = (x, 0)
            body.angle = -STEEP if side == 0 else STEEP
            corners = [(-HALF_PALM, -THICK), (HALF_PALM, -THICK), (HALF_PALM, 0), (-HALF_PALM, 0)]
            shape = pymunk.Poly(body, corners)
            shape.friction = FRICTION
            self.space.add(body, shape)
            self.palms.append(body)
        low, high, half = -COM_HEIGHT, HEIGHT - COM_HEIGHT, WIDTH / 2
        corners = [(-half, low), (half, low), (half, high), (-half, high)]
        self.box = pymunk.Body(MASS, pymunk.moment_for_poly(MASS, corners))
        self.box.position = (half, COM_HEIGHT)
        shape = pymunk.Poly(self.box, corners)
        shape.friction = 1.0  # pymunk multiplies the two coefficients
        self.space.add(self.box, shape)

    def drive(self, side: int, speed: float, turn_rate: float) -> None:
        """Sets how a palm moves."""
        self.palms[side].velocity = (speed, 0)
        self.palms[side].angular_velocity = turn_rate

    def step(self, seconds: float) -> None:
        """Advances the engine."""
        for _ in range(round(seconds / STEP)):
            self.space.step(STEP)

    def palm(self, side: int) -> tuple[float, float]:
        """Pivot and angle."""
        return self.palms[side].position.x, self.palms[side].angle

    def corner(self, side: int) -> tuple[float, float]:
        """A lower corner of the box."""
        half = -WIDTH / 2 if side == 0 else WIDTH / 2
        at = self.box.local_to_world((half, -COM_HEIGHT))
        return at.x, at.y


def version() -> str:
    """The engine's version."""
    return pymunk.version

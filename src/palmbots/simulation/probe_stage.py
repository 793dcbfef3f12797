# SPDX-License-Identifier: Apache-2.0
"""Robots for probes: their motors do exactly what they are commanded, in any driven world."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from socket import socket
from typing import Any

from palmbots._types import SIDES
from palmbots._util.arguments import seed_of
from palmbots.clocks.control_clock import control_clock
from palmbots.drivers.driver import RawCommand, RawReading
from palmbots.drivers.hardware import HardwareParameters, palm_angle, servo_angle
from palmbots.scene.scene import Scene
from palmbots.simulation.driven_world import Pair, as_built
from palmbots.simulation.imperfect_robot import zones_of
from palmbots.simulation.imperfections import Imperfections
from palmbots.simulation.live_world import LiveRobots
from palmbots.simulation.world_stage import RawStage, raw_frame
from palmbots.simulation.worlds import world_entry

ANGLE_ERROR_DEG = 0.25
_HARDWARE = HardwareParameters()


def palm_errors(seed: int, angle_error_deg: float = ANGLE_ERROR_DEG) -> Pair:
    """By how much each palm really is steeper than its encoder shows [rad], drawn by the seed."""
    error = math.radians(angle_error_deg)
    draws = random.Random(seed_of(seed))
    return draws.uniform(-error, error), draws.uniform(-error, error)


class ProbeStage(RawStage):
    """A pair under an object.

    Args:
        scene: the robots, and the object as it really is.
        world: the name of the world.
        errors: by how much each palm really is steeper than its encoder shows [rad].

    Raises:
        SceneError: the world refuses the scene.
        PalmbotsError: the world needs a dependency that is not installed.
    """

    def __init__(self, scene: Scene, world: str, errors: Pair) -> None:
        super().__init__(Imperfections())
        driven = world_entry(world).driven
        assert driven is not None
        self.world = driven(scene)
        self.errors = errors
        self._zones = [zones_of(scene, side) for side in SIDES]
        self.contacts: Pair = (0.0, 0.0)
        self.farthest_m = 0.0
        """The largest |p| so far, which the robots do not know."""
        self._look()

    @property
    def midpoint(self) -> float:
        """Displacement of the midpoint of the robots [m]."""
        return self.world.advance

    @property
    def carried_m(self) -> float:
        """The same as `midpoint`."""
        return self.world.advance

    @property
    def outcome(self) -> str:
        """``running`` or ``dropped``."""
        return "dropped" if self.world.end else "running"

    def drop_reason(self) -> str | None:
        """Why the object is no longer held."""
        return self.world.end or None

    def _look(self) -> None:
        """A palm that is pressed too lightly keeps its last contact."""
        pairs = zip(self.world.pressed, self.contacts, strict=True)
        left, right = (was if p is None else p for p, was in pairs)
        self.contacts = left, right
        self.farthest_m = max(self.farthest_m, abs(left), abs(right))

    def readings(self) -> tuple[RawReading, RawReading]:
        """What the encoders and switches of each robot read; encoders also count fractions."""
        per_m = _HARDWARE.encoder_ticks_per_turn / (2 * math.pi * _HARDWARE.wheel_radius_m)
        rows = zip(
            as_built(self.world.rolled()), self.world.wrists(), self.errors, self.contacts,
            self._zones, strict=True,
        )  # fmt: skip
        left, right = (
            RawReading(
                (rims[0] * per_m, rims[1] * per_m),
                tuple(zone.from_m <= p <= zone.to_m for zone in zones),
                servo_angle(_HARDWARE, palm - error),
            )
            for rims, palm, error, p, zones in rows
        )
        return left, right

    def frames(self) -> tuple[Any, Any]:
        """The readings as frames."""
        left, right = self.readings()
        return raw_frame(left), raw_frame(right)

    def step(self, left: RawCommand, right: RawCommand) -> None:
        """One control period."""
        r = _HARDWARE.wheel_radius_m
        (a, b), (c, d) = left.wheels_rad_s, right.wheels_rad_s
        palms = [
            now if one.servo_rad is None else palm_angle(_HARDWARE, one.servo_rad) + error
            for one, now, error in zip((left, right), self.world.wrists(), self.errors, strict=True)
        ]
        self.world.step(as_built(((a * r, b * r), (c * r, d * r))), (palms[0], palms[1]))
        self._look()


def run_probe_world(
    scene: Scene,
    door: socket,
    *,
    world: str = "quasistatic",
    seed: int = 0,
    lockstep: bool = False,
    on_line: Callable[[str], None] = lambda line: None,
) -> ProbeStage:
    """Run a world for robots that probe until the programs of both have gone or the object is
    dropped.

    Args:
        scene: the robots, and the object as it really is.
        door: where the programs connect.
        world: name of the world.
        seed: of the errors of the palm angles.
        lockstep: each tick waits for the programs; otherwise the world runs in real time.
        on_line: called with a line that names the programs still missing after some seconds.

    Raises:
        PalmbotsError: a program does not connect in time, or is not a robot.
    """
    stage = ProbeStage(scene, world, palm_errors(seed))
    robots = LiveRobots(scene, stage, door, 1.0, waits=lockstep, watchdog_s=0.0)
    robots.wait(on_line)
    clock = control_clock("world", scene.control.period_s)
    while stage.outcome == "running" and len(robots.missing()) < len(SIDES):
        if not lockstep:
            clock.wait()
        robots.tick()
    robots.end()
    return stage

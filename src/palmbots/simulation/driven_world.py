# SPDX-License-Identifier: Apache-2.0
"""Worlds whose wheels and palms are moved from outside (`DrivenWorld`), and the quasistatic one.

The caller simulates the robots: motors, sensors and programs. Wheels are those on the port and the
starboard side of a robot that looks towards +x, and roll forward towards +x.
"""

import math
from typing import Protocol

import palmbots._core as _core
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.scene.spec import refuse_floor, to_spec
from palmbots.scene.unequal_pivots import raise_right_pivot

Pair = tuple[float, float]
"""Left robot, right robot."""
Wheels = tuple[Pair, Pair]
"""The port and starboard wheel of the left robot, and those of the right one."""


def as_built(wheels: Wheels) -> Wheels:
    """Between these wheels and the left and right ones, forward, of a person who looks towards the
    partner. The right robot looks towards −x."""
    (left, right), (other_left, other_right) = wheels
    return (left, right), (-other_right, -other_left)


class DrivenWorld(Protocol):
    """An object on two palms, moved tick by tick."""

    end: str
    """Why the object is no longer held; empty if it is."""

    @property
    def pressed(self) -> tuple[float | None, float | None]:
        """Contact coordinate [m] at which each palm is pressed; None: too lightly."""
        ...

    @property
    def advance(self) -> float:
        """Displacement of the midpoint of the pivots towards +x [m]."""
        ...

    def rolled(self) -> Wheels:
        """How far each wheel has rolled [m], from any start."""
        ...

    def wrists(self) -> Pair:
        """The angles of the palms over the horizontal [rad]."""
        ...

    def step(self, rims: Wheels, angles: Pair) -> None:
        """One control period with these speeds of the wheel rims [m/s]; the palms turn to these
        angles [rad].

        Raises:
            PalmbotsError: the simulation failed.
        """
        ...


class QuasistaticWorld:
    """The planar world. A robot has the mean speed of its wheels; it does not turn."""

    def __init__(self, scene: Scene, pivot_heights_m: Pair = (0.0, 0.0)) -> None:
        """`pivot_heights_m`: of the pivots over where the scene has them."""
        refuse_floor(scene, "robots that are driven from outside do")
        spec = to_spec(scene)
        self._tilt = raise_right_pivot(spec, pivot_heights_m[1] - pivot_heights_m[0])
        self._world = _core.World(spec)
        self._spins = [robot.traction_limit < robot.motor_limit for robot in spec.robots]
        self._period_s = scene.control.period_s
        self._inertia = _core.InertiaFilter(spec)
        self._rolled: Wheels = ((0.0, 0.0), (0.0, 0.0))
        self.advance = 0.0
        self.end = self._world.check()

    @property
    def pressed(self) -> tuple[float | None, float | None]:
        """Contact coordinate [m] at which each palm is pressed."""
        return self._world.contacts

    def rolled(self) -> Wheels:
        """How far each wheel has rolled [m]."""
        return self._rolled

    def wrists(self) -> Pair:
        """The angles of the palms over the horizontal, not over the line between the pivots."""
        left, right = self._world.palms
        return left - self._tilt, right + self._tilt

    def step(self, rims: Wheels, angles: Pair) -> None:
        """One control period; see `DrivenWorld`."""
        if self.end:
            raise PalmbotsError("world: the object is no longer held")
        left, right = (0.5 * sum(wheels) for wheels in rims)
        t = self._period_s
        cos = math.cos(self._tilt)
        palms = angles[0] + self._tilt, angles[1] - self._tilt
        push = self._inertia.step(left + right)
        lags = [0.0, 0.0]  # of robots that stalled
        if self._world.is_limited:
            ways = left * t * cos, right * t * cos
            before = self._world.pivots
            self.end = self._world.move(((ways[0], 0.0), (ways[1], 0.0)), palms, push)[0]
            if not self.end:
                lags = [
                    (now[0] - then[0] - way) / cos
                    for now, then, way in zip(self._world.pivots, before, ways, strict=True)
                ]
        else:
            self.end = self._world.advance((right - left) * t * cos, palms, push)[0]
        self.advance += 0.5 * (left + right) * t + 0.5 * sum(lags)
        (a, b), (c, d) = self._rolled
        (va, vb), (vc, vd) = rims
        e, f = (0.0 if spin else lag for spin, lag in zip(self._spins, lags, strict=True))
        self._rolled = (
            (a + va * t + e, b + vb * t + e),
            (c + vc * t + f, d + vd * t + f),
        )

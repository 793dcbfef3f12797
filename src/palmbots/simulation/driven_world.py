# SPDX-License-Identifier: Apache-2.0
"""Worlds whose wheels and palms are moved from outside (`DrivenWorld`), and the quasistatic one.

The caller simulates the robots: motors, sensors and programs. Wheels are numbered
left, right as seen by a person who looks towards the partner; forward is towards the partner.
"""

import math
from typing import Protocol

import palmbots._core as _core
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.scene.unequal_pivots import raise_right_pivot

Pair = tuple[float, float]
"""Left robot, right robot."""
Wheels = tuple[Pair, Pair]
"""The left and right wheel of the left robot, and those of the right one."""


class DrivenWorld(Protocol):
    """An object on two palms, moved tick by tick."""

    rolled_m: Wheels
    """What each wheel has rolled forward so far."""
    palms: Pair
    """The angles of the palms over the horizontal [rad]."""
    midpoint: float
    """Displacement of the midpoint of the pivots towards +x [m]."""
    end: str
    """Why the object is no longer held; empty if it is."""

    @property
    def pressed(self) -> tuple[float | None, float | None]:
        """Contact coordinate [m] at which each palm is pressed; None: too lightly."""
        ...

    def step(self, rims_m_s: Wheels, palms_rad: Pair) -> None:
        """One control period with these speeds of the wheel rims; the palms turn to these angles.

        Raises:
            PalmbotsError: the simulation failed.
        """
        ...


class DrivenQuasistatic:
    """The planar world. A robot has the mean speed of its wheels; it does not turn."""

    def __init__(self, scene: Scene, pivot_heights_m: Pair = (0.0, 0.0)) -> None:
        """`pivot_heights_m`: of the pivots over where the scene has them."""
        spec = to_spec(scene)
        self._tilt = raise_right_pivot(spec, pivot_heights_m[1] - pivot_heights_m[0])
        self._world = _core.World(spec)
        self._period_s = scene.control.period_s
        self._inertia = _core.InertiaFilter(spec)
        self.rolled_m: Wheels = ((0.0, 0.0), (0.0, 0.0))
        self.palms: Pair = self._as_seen(self._world.palms)
        self.midpoint = 0.0
        self.end = self._world.check()

    @property
    def pressed(self) -> tuple[float | None, float | None]:
        """Contact coordinate [m] at which each palm is pressed."""
        return self._world.contacts

    def step(self, rims_m_s: Wheels, palms_rad: Pair) -> None:
        """One control period; see `DrivenWorld`."""
        if self.end:
            raise PalmbotsError("world: the object is no longer held")
        left, right = (0.5 * sum(wheels) for wheels in rims_m_s)
        together = left - right  # forward is towards the partner
        change = -(left + right) * self._period_s * math.cos(self._tilt)
        palms = palms_rad[0] + self._tilt, palms_rad[1] - self._tilt
        self.end = self._world.advance(change, palms, self._inertia.step(together))[0]
        self.palms = self._as_seen(self._world.palms)
        self.midpoint += 0.5 * together * self._period_s
        (a, b), (c, d) = self.rolled_m
        (va, vb), (vc, vd) = rims_m_s
        t = self._period_s
        self.rolled_m = ((a + va * t, b + vb * t), (c + vc * t, d + vd * t))

    def _as_seen(self, palms: Pair) -> Pair:
        """Angles over the horizontal of angles over the line between the pivots."""
        return palms[0] - self._tilt, palms[1] + self._tilt

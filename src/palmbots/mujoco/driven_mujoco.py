# SPDX-License-Identifier: Apache-2.0
"""The MuJoCo world whose wheels and palms are moved from outside. Nobody steers the robots: one
whose wheels differ drives a curve."""

from palmbots.errors import SceneError
from palmbots.mujoco.world import MujocoWorld
from palmbots.scene.scene import Scene
from palmbots.simulation.driven_world import Pair, Wheels


def _as_built(wheels: Wheels) -> Wheels:
    """Between left, right, forward of a person who looks towards the partner, and port, starboard,
    towards +x. The right robot looks towards −x."""
    (left, right), (other_left, other_right) = wheels
    return (left, right), (-other_right, -other_left)


class DrivenMujoco:
    """A `palmbots.simulation.driven_world.DrivenWorld`."""

    def __init__(self, scene: Scene, pivot_heights_m: Pair = (0.0, 0.0)) -> None:
        """`pivot_heights_m`: of the pivots over where the scene has them.

        Raises:
            SceneError: the path is curved.
        """
        if scene.task.path.is_curved:
            raise SceneError(
                "task.path.kind: robots that nobody steers cannot follow a curved path; "
                "allowed: straight"
            )
        self.world = MujocoWorld(scene, measures=False, pivot_heights_m=pivot_heights_m)
        self._sight = self.world.sight(first=True)
        self._start = _as_built(self.world.rolled())
        self.rolled_m: Wheels = ((0.0, 0.0), (0.0, 0.0))
        self.end = ""
        self._observe()

    def _observe(self) -> None:
        self.palms: Pair = self.world.wrists()
        self.midpoint = self._sight.midpoint
        now = _as_built(self.world.rolled())
        (a, b), (c, d) = (
            (wheels[0] - start[0], wheels[1] - start[1])
            for wheels, start in zip(now, self._start, strict=True)
        )
        self.rolled_m = ((a, b), (c, d))

    @property
    def pressed(self) -> tuple[float | None, float | None]:
        """Contact coordinate [m] at which each palm is pressed; None: too lightly."""
        left, right = (
            at if is_closed else None
            for at, is_closed in zip(self.world.touched, self.world.is_pressed, strict=True)
        )
        return left, right

    def step(self, rims_m_s: Wheels, palms_rad: Pair) -> None:
        """One control period; see `DrivenWorld`."""
        self.world.turn_wheels(_as_built(rims_m_s), palms_rad)
        self._sight = self.world.sight()
        self.end = self.world.end
        self._observe()

# SPDX-License-Identifier: Apache-2.0
"""A workbench for simulated robots: each stands alone on the floor, without an object.

A rod can be laid on a palm, and a person can measure where a robot stands and how its palm lies.
"""

import math
from dataclasses import dataclass
from typing import Any

from palmbots._types import SIDES, Side
from palmbots.drivers.driver import RawCommand, RawReading
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.imperfect_robot import ImperfectRobot
from palmbots.simulation.imperfections import Imperfections
from palmbots.simulation.world_stage import RawStage, raw_frame


@dataclass
class Pose:
    """Where a robot stands, seen from where it was put down: ahead and to the left [m], and how far
    it has turned to the left [rad]."""

    ahead_m: float = 0.0
    left_m: float = 0.0
    heading: float = 0.0


class BenchStage(RawStage):
    """A `palmbots.simulation.world_stage.Stage` without an object.

    Args:
        scene: speeds, noise and palms of the robots.
        seed: of the noise.
        imperfections: what the robots really are.
    """

    midpoint = carried_m = 0.0
    outcome = "running"
    contacts = (0.0, 0.0)

    def drop_reason(self) -> None:
        """There is nothing to drop."""

    def __init__(self, scene: Scene, seed: int, imperfections: Imperfections) -> None:
        super().__init__(imperfections)
        self._period_s = scene.control.period_s
        self._has_arms = to_spec(scene, unrolled=True).uses_floor
        self._separations = {side: imperfections.of(side).wheel_separation_m for side in SIDES}
        self.robots = {
            side: ImperfectRobot(imperfections.of(side), scene, side, seed) for side in SIDES
        }
        self._rolled = dict.fromkeys(SIDES, (0.0, 0.0))
        self.poses = {side: Pose() for side in SIDES}
        self.rods: dict[Side, float | None] = dict.fromkeys(SIDES)
        """Contact coordinate of the rod on each palm [m]; None: there is none."""
        self.moves = dict.fromkeys(SIDES, False)

    def reading(self, side: Side) -> RawReading:
        """What the hardware of a robot reads."""
        robot = self.robots[side]
        return robot.reading(self._rolled[side], self.rods[side], robot.palm_rad)

    def frames(self) -> tuple[Any, Any]:
        """The readings as frames."""
        return raw_frame(self.reading("left")), raw_frame(self.reading("right"))

    def step(self, left: RawCommand, right: RawCommand) -> None:
        """One control period."""
        for side, command in zip(SIDES, (left, right), strict=True):
            self.move(side, command)

    def move(self, side: Side, command: RawCommand) -> None:
        """One control period of one robot."""
        before = (self.robots[side].palm_rad, self.robots[side].pivot_m)
        one, other = self.robots[side].move(command)
        t, pose = self._period_s, self.poses[side]
        turn = (other - one) / self._separations[side] * t
        ahead, middle = 0.5 * (one + other) * t, pose.heading + turn / 2
        pose.ahead_m += ahead * math.cos(middle)
        pose.left_m += ahead * math.sin(middle)
        pose.heading += turn
        a, b = self._rolled[side]
        self._rolled[side] = (a + one * t, b + other * t)
        now = (self.robots[side].palm_rad, self.robots[side].pivot_m)
        self.moves[side] = one != 0 or other != 0 or now != before

    def put_down(self, side: Side, pose: Pose | None = None) -> None:
        """Put a robot at the start of the tape."""
        self.poses[side] = Pose() if pose is None else pose

    def measured(self, side: Side) -> str:
        """What a person reads off a tape to 1 mm, and off a protractor to 0.5°."""
        pose, palm_deg = self.poses[side], math.degrees(self.robots[side].palm_rad)
        arm = f", pivot at {1000 * self.robots[side].pivot_m:.0f} mm" if self._has_arms else ""
        return (
            f"{side}: {1000 * pose.ahead_m:.0f} mm along, {1000 * pose.left_m:.0f} mm to the left, "
            f"palm {round(2 * palm_deg) / 2:g}°{arm}"
        )

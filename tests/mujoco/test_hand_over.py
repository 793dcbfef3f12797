# SPDX-License-Identifier: Apache-2.0
"""A small object goes from one palm to the other in MuJoCo, as in the quasistatic world
(tests/simulation/test_hand_over.py). Robots are driven by hand."""

import math

import pytest

from palmbots.mujoco.lift_world import LiftWorld
from palmbots.scene.scene import load_scene

SHALLOW, STEEP = 9.0, 30.0
UP_M = 0.1
SPEED, ACCELERATION, ARM_SPEED, TURN = 0.05, 0.3, 0.05, math.radians(20)
FREE_N = 0.02
Goals = tuple[float, float]


def approach(now: float, goal: float, most: float) -> float:
    return now + max(-most, min(most, goal - now))


class Hands:
    """Drives wheels, wrists and arms of both robots at limited rates."""

    def __init__(self) -> None:
        keys = {
            "floor.walls": [], "task.dock": "together", "palm.shallow_deg": SHALLOW,
            "palm.steep_deg": STEEP,
        }  # fmt: skip
        self.world = LiftWorld(load_scene("lone", keys))
        self._palms = self.world.layout.spec.palms
        self._speeds = [0.0, 0.0]
        self._angles = [math.radians(STEEP)] * 2
        self._heights = [palm.lowest_pivot(math.radians(STEEP)) for palm in self._palms]

    def drive(
        self, seconds: float, palms_deg: Goals, speeds: Goals = (0.0, 0.0), up: Goals = (0.0, 0.0)
    ) -> None:
        period = self.world.scene.control.period_s
        for _ in range(round(seconds / period)):
            for k in (0, 1):
                goal = math.radians(palms_deg[k])
                self._angles[k] = approach(self._angles[k], goal, TURN * period)
                self._speeds[k] = approach(self._speeds[k], speeds[k], ACCELERATION * period)
                floor = self._palms[k].lowest_pivot(self._angles[k])
                way = math.inf if up[k] == 0 else ARM_SPEED * period
                self._heights[k] = approach(self._heights[k], floor + up[k], way)
            follows = (up[0] == 0, up[1] == 0)
            self.world.arms = (self._heights[0], self._heights[1]), follows, follows
            self.world.move((self._speeds[0], self._speeds[1]), (self._angles[0], self._angles[1]))

    def gap(self) -> float:
        """Between the noses [m]."""
        noses = [
            float(self.world.data.body(f"{side}_palm").xpos[0])
            - out * 0.5 * palm.length * math.cos(angle)
            for side, out, palm, angle in zip(
                ("left", "right"), (-1, 1), self._palms, self._angles, strict=True
            )
        ]
        return noses[1] - noses[0]

    def pressed(self) -> tuple[bool, bool]:
        """Whether the object presses each palm."""
        self.world.sight()
        left, right = self.world.measured.force
        return left > FREE_N, right > FREE_N

    def tilt_deg(self) -> float:
        """The angle of the object, anticlockwise seen from the side."""
        return -math.degrees(math.asin(float(self.world.data.body("object").xmat[2])))

    def take(self, side: int) -> None:
        """Drives the palm of this side under the object until the noses nearly meet, then raises it
        and drives away."""
        inward = SPEED * (1 - 2 * side)
        palms = (SHALLOW, STEEP) if side == 0 else (STEEP, SHALLOW)

        def drive(seconds: float, speed: float = 0.0, up: float = 0.0) -> None:
            both = [(0.0, 0.0), (0.0, 0.0)]
            both[side] = speed, up
            (one, rise), (other, other_rise) = both
            self.drive(seconds, palms, (one, other), (rise, other_rise))

        while self.gap() > 0.005:
            drive(0.02, inward)
        drive(0.3)
        assert self.tilt_deg() == pytest.approx(math.copysign(SHALLOW, -inward), abs=0.3)
        drive(0.3, -inward)
        drive(2.5, up=UP_M)
        assert self.pressed() == ((True, False) if side == 0 else (False, True))
        drive(1.0, -inward, UP_M)
        drive(0.5, up=UP_M)
        assert self.tilt_deg() == pytest.approx(math.copysign(SHALLOW, -inward), abs=0.1)


@pytest.mark.slow
def test_the_palm_of_the_partner_takes_the_place_of_the_wall() -> None:
    hands = Hands()
    hands.drive(1.5, (SHALLOW, STEEP))
    hands.take(0)
    hands.drive(8.0, (SHALLOW, STEEP), (0.0, SPEED), (UP_M, 0.0))
    hands.drive(5.0, (SHALLOW, STEEP), (SPEED, 0.0), (UP_M, 0.0))
    hands.drive(1.0, (SHALLOW, STEEP), (0.0, 0.0), (UP_M, 0.0))
    hands.drive(2.5, (SHALLOW, STEEP))
    hands.drive(2.5, (STEEP, SHALLOW))
    assert hands.pressed() == (True, False)
    hands.drive(3.0, (STEEP, SHALLOW), (-SPEED, 0.0))
    hands.drive(0.5, (STEEP, SHALLOW))
    assert hands.pressed() == (False, False)
    assert hands.tilt_deg() == pytest.approx(0.0, abs=0.1)
    put_down = hands.world.object_pose[0]
    assert put_down > 0.2
    hands.take(1)
    hands.drive(3.0, (STEEP, SHALLOW), (0.0, SPEED), (0.0, UP_M))
    assert hands.pressed() == (False, True)
    assert hands.world.object_pose[0] > put_down + 0.1

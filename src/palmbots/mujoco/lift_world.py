# SPDX-License-Identifier: Apache-2.0
"""The scene in MuJoCo for a job that begins or ends on the floor or on a stand: robots whose arms
rise and sink.

An arm is a vertical slide. While it follows the floor, its motor aims at the height at which the
nose of its palm just touches the floor, and presses it down with `_PRESS_N` at most. Otherwise it
holds the height that is commanded. An arm that only pressed would leave the weight of the object to
the nose, and wrists of the default strength could not hold their angles. Noses slide on the floor
without friction.

Switches feel what lies on the upper side of the palm, and what presses its heel as the outer end.
They do not feel what touches the nose.
"""

import math
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.mujoco.contact_forces import PalmLoads
from palmbots.mujoco.engine_settings import DEFAULT, Engine
from palmbots.mujoco.robot_mjcf import STRONGEST_N, arm_weight
from palmbots.mujoco.world import HEADING, MujocoWorld
from palmbots.scene.scene import Scene
from palmbots.simulation.carry_ends import ends_in

_PRESS_N = 2.0  # by which an arm presses its nose on the floor, at most; assumed
_SLOW = 0.5  # of the commanded speed
_MOVES_M_S = 0.005  # a robot that is commanded to move more slowly stands
_ENDS_LOW = ends_in("low")
_STALLS_S = 0.05  # wheels of a robot that is too slow for longer stall

Pair = tuple[float, float]


class LiftWorld(MujocoWorld):
    """A scene in MuJoCo whose object stands on the floor or on a stand before or after the job."""

    arms: tuple[Pair, tuple[bool, bool], tuple[bool, bool]]
    """Heights to which the pivots rise or sink in the next `move` [m], at constant rates; whether a
    nose is on the floor or the object may touch a stand; whether each arm follows the floor."""

    def __init__(
        self,
        scene: Scene,
        engine: Engine = DEFAULT,
        measures: bool = True,
        headings: Pair = (0.0, 0.0),
        displaced: Pair = (0.0, 0.0),
    ) -> None:
        """`headings`: at which the robots start, and which they keep because they measure their
        headings with these errors, anticlockwise seen from above [rad]. `displaced`: how far the
        middle of the object is towards +y of the robots' axis at the start [m], and its angle to
        this axis, anticlockwise [rad]."""
        self._headings, self._displaced = headings, displaced
        self._stands = self._begins_low = scene.task.ends[0] != "palms"
        self._slow_s = [0.0, 0.0]
        self._weight = arm_weight(scene)
        self._halves = [0.5 * scene.palm_of(side).length_m for side in SIDES]
        self._first_x = 0.0
        super().__init__(scene, engine, measures)
        self._first_x = self._com_x()

    def move(self, speeds: Pair, angles: Pair) -> None:
        """Simulate one control period, with the arms as well."""
        heights, _, follows = self.arms
        for k in (0, 1):
            motor = self._motors[k]
            weakest = self._weight - _PRESS_N if follows[k] else -STRONGEST_N
            self.model.actuator_forcerange[motor[0], 0] = weakest
            self.data.ctrl[motor] = (heights[k] - self._heights[k]) / self._period
            self._heights[k] = heights[k]
        before = self._distances()
        super().move(speeds, angles)
        for k, (now, then) in enumerate(zip(self._distances(), before, strict=True)):
            is_slow = (
                follows[k]
                and abs(speeds[k]) > _MOVES_M_S
                and (now - then) / speeds[k] < _SLOW * self._period
            )
            self._slow_s[k] = self._slow_s[k] + self._period if is_slow else 0.0

    def sight(self, first: bool = False) -> _core.WorldObservation:
        """Observe the present instant. Lateral positions count while the object is held."""
        peak = self.lateral_peak if any(self.arms[1]) and not first else None
        found = super().sight(first)
        if peak is not None:
            self.lateral_peak = peak
        return found

    @property
    def object_pose(self) -> tuple[float, float, float]:
        """Place of the middle between both contact edges (x, y) [m], and the angle of the object,
        anticlockwise seen from above [rad]."""
        (ax, ay, _), (bx, by, _) = self._vertices()
        return 0.5 * (ax + bx), 0.5 * (ay + by), math.atan2(by - ay, bx - ax)

    @property
    def warnings(self) -> list[str]:
        """Warnings about the start."""
        return [] if self._begins_low else super().warnings

    # --- inside ---------------------------------------------------------------------------------

    def _find(self) -> None:
        super()._find()
        m = self.model
        self._motors = [
            [m.actuator(f"{side}_arm_{part}").id for part in ("angle", "speed")] for side in SIDES
        ]
        self._heights = [self.layout.height + raised for raised in self.layout.raised]
        left, right = self._heights
        on_floor = self.scene.task.ends[0] == "floor"
        self.arms = (left, right), (self._begins_low, self._begins_low), (on_floor, on_floor)
        for k, side in enumerate(SIDES):
            self._turn_robot(m.joint(f"{side}_body").qposadr[0], k)
        if self._begins_low:
            self._displace(m.joint("object").qposadr[0])

    def _turn_robot(self, at: int, k: int) -> None:
        """Turn a robot about its pivot to the heading at which it starts."""
        q, heading, pivot = self.data.qpos, self._headings[k], self.layout.pivots[k]
        arm = float(q[at]) - pivot
        q[at : at + 2] = pivot + arm * math.cos(heading), arm * math.sin(heading)
        q[at + 3 : at + 7] = math.cos(0.5 * heading), 0.0, 0.0, math.sin(0.5 * heading)

    def _displace(self, at: int) -> None:
        """Move the object, whose frame is at its left contact edge, to where it stands."""
        q, (aside, turn), half = self.data.qpos, self._displaced, 0.5 * self.layout.spec.width
        q[at] += half * (1 - math.cos(turn))
        q[at + 1] += aside - half * math.sin(turn)
        q[at + 3 : at + 7] = math.cos(0.5 * turn), 0.0, 0.0, math.sin(0.5 * turn)

    def _turning(self, k: int, speed: float) -> float:
        return super()._turning(k, speed) + HEADING * self._headings[k]

    def _adjust_arms(self) -> None:
        """Slides hold the weights where they are."""

    def _com_x(self) -> float:
        spec, at, mat = self.layout.spec, self._object_pos, self._object_mat
        return float(at[0] + mat[0] * spec.com_left + mat[2] * spec.com_height)

    def _floor_state(self) -> dict[str, Any]:
        (a, b), (c, d) = self.rolled()
        return {
            "heights": (float(self._palm_pos[0][2]), float(self._palm_pos[1][2])),
            "rolled": (0.5 * (a + b), 0.5 * (c + d)),
            "moved": self._com_x() - self._first_x,
            "object_sine": max(-1.0, min(1.0, float(self._object_mat[6]))),
            "stands": self._stands,
            "stalls": tuple(slow > _STALLS_S for slow in self._slow_s),
        }

    def _pressing(self, p: Pair, loads: PalmLoads) -> list[list[list[float]]]:
        self._stands = not any((*loads.force, *loads.heel))
        return [
            [further, vertex if at >= -half else [0.0, 0.0], [heel, heel * half]]
            for (further, vertex), heel, at, half in zip(
                loads.sums, loads.heel, p, self._halves, strict=True
            )
        ]

    @property
    def _ends(self) -> dict[str, str]:
        return _ENDS_LOW if any(self.arms[1]) else super()._ends

# SPDX-License-Identifier: Apache-2.0
"""Where robots and object are, as far as real robots know: for viewers.

A robot knows the sign of its contact coordinate, its palm and its odometry. The object is drawn
level, and each contact at the pivot, or a little inward or outward of it, as its sign says.
"""

from typing import Any

import numpy as np

from palmbots._types import SIDES
from palmbots.drivers.driver import Drive
from palmbots.pair.drive_table import drive_table
from palmbots.scene.placement import Placement, place
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

_ASIDE_M = 0.015
"""Where a contact is drawn that is not at the pivot; the true place is not known."""


def drawn_contact(sign: Any) -> Any:
    """The contact coordinate at which a contact with this sign is drawn [m]."""
    return _ASIDE_M * np.asarray(sign, float)


class EstimatedCarry:
    """Places robots and object from what the station shows of the robots."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.spec = scene, to_spec(scene, unrolled=True)
        self._drives: dict[str, dict[Any, Drive]] = {s: drive_table(scene, s) for s in SIDES}
        self._way = 1.0 if scene.task.direction == "forward" else -1.0
        self._turns = np.array([self._angle(side, 0) for side in SIDES])
        self._time_s: float | None = None

    def _angle(self, side: str, palm: int) -> float:
        return self._drives[side][palm, 0, True, False].palm_rad

    def at(self, robots: dict[str, Any], time_s: float) -> Placement:
        """The placement at one instant; robots that were never heard are at the start."""
        known = [robots.get(side) or {} for side in SIDES]
        travel = self.scene.task.distance_m
        covered = [travel * (robot.get("progress") or 0.0) for robot in known]
        wanted = np.array([
            self._angle(side, 1 if robot.get("palm") == "shallow" else 0)
            for side, robot in zip(SIDES, known, strict=True)
        ])  # fmt: skip
        self._turn(wanted, time_s)
        nominal = self.spec.com_left + self.spec.com_right
        return place(
            self.spec,
            separation=[nominal + self._way * (covered[1] - covered[0])],
            midpoint=[self._way * sum(covered) / 2],
            palm=[self._turns],
            contact=[drawn_contact([robot.get("sign", 0) for robot in known])],
            turn=[0.0],
        )

    def _turn(self, wanted: Any, time_s: float) -> None:
        """Palms turn at their rate: the robots report only whether they have arrived."""
        passed = 0.0 if self._time_s is None else max(0.0, time_s - self._time_s)
        self._time_s = time_s
        rates = [np.radians(self.scene.palm_of(side).rate_deg_s) for side in SIDES]
        most = np.array(rates) * passed
        self._turns = self._turns + np.clip(wanted - self._turns, -most, most)

    def palm_rad(self) -> tuple[float, float]:
        """The palm angles as they are drawn."""
        return float(self._turns[0]), float(self._turns[1])

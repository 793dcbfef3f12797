# SPDX-License-Identifier: Apache-2.0
"""What a driver reads, as the core's program of a robot takes it (`ReadingGauge`)."""

import math
from typing import Any

from palmbots._types import Side
from palmbots._util.arguments import show
from palmbots.drivers.driver import Reading
from palmbots.errors import PalmbotsError
from palmbots.pair.pair_file import Pair
from palmbots.robot.odometry import Odometry
from palmbots.scene.scene import Scene

_MOST_MV = 0xFFFE
_NOT_MEASURED = 0xFFFF


class ReadingGauge:
    """Makes the inputs of the core from the readings of one robot's driver.

    Args:
        pair: the pair.
        side: of the robot.
        scene: of the pair.
        first: the driver's first reading.
        resumed_m: what a carry had covered that goes on after a boot [m].

    Raises:
        PalmbotsError: the battery is to be checked, but the driver does not measure it.
    """

    def __init__(
        self, pair: Pair, side: Side, scene: Scene, first: Reading | None, resumed_m: float
    ) -> None:
        self._hardware = pair.settings.hardware.of(side)
        self._stopping = math.ceil(self._hardware.stopping_s / scene.control.period_s - 1e-9)
        self._odometry = Odometry(scene.task.distance_m, resumed_m)
        self.has_encoders = first is None or not math.isnan(first.distance_m)
        """The driver measures the distance; otherwise the core takes the time in its place."""
        is_checked = self._hardware.battery_low_v > 0
        if is_checked and first is not None and first.battery_v is None:
            raise PalmbotsError(
                f"{pair.file}: hardware.battery_low_v: value is "
                f"{show(self._hardware.battery_low_v)}, but the driver does not measure the "
                "battery; allowed: 0"
            )

    @property
    def to_store_m(self) -> float:
        """The covered distance, for a carry that goes on after a boot."""
        return self._odometry.to_store_m if self.has_encoders else 0.0

    def take(
        self,
        seen: Reading,
        *,
        carries: bool,
        counts: bool = True,
        share_of_way: float = 1.0,
        **others: Any,
    ) -> dict[str, Any]:
        """The arguments of the core's `Reading`; `carries`: after the last step the wheels may
        turn; `counts`: what the robot moves counts as a part of the distance; `share_of_way`: the
        share of the distance after which it is covered for this robot."""
        if self.has_encoders:
            self._odometry.take(seen.distance_m, carries, counts)
        battery_v = seen.battery_v
        battery_mv = _NOT_MEASURED if battery_v is None else min(round(1000 * battery_v), _MOST_MV)
        return {
            "sign": seen.sign,
            "palm_at_target": seen.palm_at_target,
            "contact": seen.has_contact,
            "battery_ok": battery_v is None or battery_v >= self._hardware.battery_low_v,
            "battery_mv": max(0, battery_mv),
            "covered": self._odometry.is_covered(share_of_way) or seen.far_enough,
            "progress": round(65535 * self._odometry.share),
            "stopping": self._stopping,
            "arm_there": seen.arm_there,
            "arm_steps": seen.arm_steps,
            "beneath": seen.beneath,
            **others,
        }

# SPDX-License-Identifier: Apache-2.0
"""What a driver reads, as the core's program of a robot takes it (`ReadingGauge`)."""

import math
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots._util.arguments import show
from palmbots.drivers.driver import Reading
from palmbots.errors import PalmbotsError
from palmbots.pair.pair_file import Pair
from palmbots.pair.stored_state import StoredState
from palmbots.robot.odometry import Approach, Odometry
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

_MOST_MV = 0xFFFE
_NOT_MEASURED = 0xFFFF


class ReadingGauge:
    """Makes the inputs of the core from the readings of one robot's driver.

    Args:
        pair: the pair.
        side: of the robot.
        scene: of the pair.
        first: the driver's first reading.
        state: what the robot had stored before a boot.

    Raises:
        PalmbotsError: the driver does not measure what it has to: the battery, or how far the robot
            has driven below an object on a stand.
    """

    def __init__(
        self, pair: Pair, side: Side, scene: Scene, first: Reading | None, state: StoredState
    ) -> None:
        self._hardware = pair.settings.hardware.of(side)
        self._stopping = math.ceil(self._hardware.stopping_s / scene.control.period_s - 1e-9)
        self._odometry = Odometry(scene.task.distance_m, state.covered_m)
        self._approach: Approach | None = None
        leads = (side == "right") == (scene.task.direction == "forward")
        self._sense = -1.0 if leads else 1.0  # of the direction of travel, towards the partner
        self.has_encoders = first is None or not math.isnan(first.distance_m)
        """The driver measures the distance; otherwise the core takes the time in its place."""
        is_checked = self._hardware.battery_low_v > 0
        if is_checked and first is not None and first.battery_v is None:
            raise PalmbotsError(
                f"{pair.file}: hardware.battery_low_v: value is "
                f"{show(self._hardware.battery_low_v)}, but the driver does not measure the "
                "battery; allowed: 0"
            )
        says_beneath = first is None or first.beneath is not None
        if scene.task.ends[0] == "stand" and not says_beneath:
            if not self.has_encoders:
                raise PalmbotsError(
                    f'task.from: value is "stand", and the {side} robot does not know when it is '
                    "below the object: it has no wheel encoders "
                    "(hardware.encoder_ticks_per_turn), and its driver does not state it "
                    "(Reading.beneath); allowed: floor, palms"
                )
            way_m = _core.way_below(to_spec(scene), SIDES.index(side))
            self._approach = Approach(way_m, state.approached_m)

    @property
    def to_store_m(self) -> tuple[float, float]:
        """The covered distance, and how far the robot has driven towards an object on a stand, for
        a carry that goes on after a boot."""
        covered_m = self._odometry.to_store_m if self.has_encoders else 0.0
        return covered_m, 0.0 if self._approach is None else self._approach.to_store_m

    def take(
        self,
        seen: Reading,
        *,
        carries: bool,
        counts: bool = True,
        share_of_way: float = 1.0,
        backs_off: bool = False,
        **others: Any,
    ) -> dict[str, Any]:
        """The arguments of the core's `Reading`; `carries`: after the last step the wheels may
        turn; `counts`: what the robot moves counts as a part of the distance; `share_of_way`: the
        share of the distance after which it is covered for this robot; `backs_off`: the robot
        drives back to try again."""
        if self.has_encoders:
            self._odometry.take(seen.distance_m, carries, counts)
        is_beneath = bool(seen.beneath)
        if self._approach is not None:
            self._approach.drive(self._sense * seen.distance_m, carries, backs_off)
            is_beneath = self._approach.is_there
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
            "beneath": is_beneath,
            **others,
        }

# SPDX-License-Identifier: Apache-2.0
"""What a driver reads, as the core's program of a robot takes it (`ReadingGauge`)."""

import math
from typing import Any

import palmbots._core as _core
from palmbots._types import Side
from palmbots._util.arguments import show
from palmbots.drivers.driver import Reading
from palmbots.errors import PalmbotsError
from palmbots.runtime.pair_file import Pair
from palmbots.scene.scene import Scene


class ReadingGauge:
    """What the core has to know of a driver's readings.

    Raises:
        PalmbotsError: the battery is to be checked, but the driver does not measure it.
    """

    def __init__(self, pair: Pair, side: Side, scene: Scene, first: Reading | None) -> None:
        self._hardware = pair.settings.hardware.of(side)
        self._goal_m = scene.task.distance_m
        self._stopping = math.ceil(self._hardware.stopping_s / scene.control.period_s)
        self._start_m = 0.0
        self.has_encoders = first is None or not math.isnan(first.distance_m)
        """The driver measures the distance; otherwise the core takes the time in its place."""
        is_checked = self._hardware.battery_low_v > 0
        if is_checked and first is not None and first.battery_v is None:
            raise PalmbotsError(
                f"hardware.battery_low_v: value is {show(self._hardware.battery_low_v)}, but the "
                "driver does not measure the battery; allowed: 0"
            )

    def reading(self, seen: Reading, *, rests: bool, **others: Any) -> Any:
        """The reading for the core; `rests`: the distance is counted from here."""
        covered_m = 0.0
        if self.has_encoders:
            if rests:
                self._start_m = seen.distance_m
            covered_m = seen.distance_m - self._start_m
        battery_v = seen.battery_v
        battery_mv = 0xFFFF if battery_v is None else min(round(1000 * battery_v), 0xFFFE)
        return _core.runtime.Reading(
            seen.sign,
            seen.palm_at_target,
            contact=seen.has_contact,
            battery_ok=battery_v is None or battery_v >= self._hardware.battery_low_v,
            battery_mv=max(0, battery_mv),
            covered=covered_m >= self._goal_m,
            progress=round(65535 * max(0.0, min(1.0, covered_m / self._goal_m))),
            stopping=self._stopping,
            **others,
        )

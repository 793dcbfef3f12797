# SPDX-License-Identifier: Apache-2.0
"""What the station knows of one robot."""

import math
from dataclasses import dataclass
from typing import Any

import palmbots._core as _core
from palmbots.links.packet_statistics import EndStatistics
from palmbots.pair.fault_words import fault_line
from palmbots.wire import Packet, Status

LOST_AFTER_S = 1.0
_NOT_MEASURED = 0xFFFF
_MANY_OVERRUNS = 5
_MUCH_LOSS = 0.1
_NUMBERS = ("progress", "battery", "overruns", "phase")
_PHASES: dict[int, str] = _core.lift_state_numbers


def phase_name(number: int) -> str:
    """The phase of a job with this number in a status; empty: it is none, or not known yet."""
    return _PHASES.get(number, "")


@dataclass
class RobotView:
    """The newest news of one robot."""

    link: EndStatistics
    """Of its packets."""
    status: Status | None = None
    """None: it has never been heard."""
    heard_s: float = -math.inf
    """When it was heard last."""
    stamp: tuple[int, int] = (0, 0)
    """Epoch and number of its newest packet."""
    answer_s: float | None = None
    """Age of the newest packet of the station that it has acknowledged; None: it has not heard this
    station."""
    order_age_s: float = math.inf
    """The greatest age at which it obeys an order."""

    def __post_init__(self) -> None:
        self._numbers: dict[str, int] = {}

    def take(self, packet: Packet, status: Status, now: float) -> None:
        """A status of the robot has arrived."""
        if packet.epoch != self.stamp[0]:
            self._numbers.clear()
        self.status, self.heard_s, self.stamp = status, now, (packet.epoch, packet.sequence)
        # A robot at rest reports no progress; its last one is kept until it is released.
        is_over = status.item == "progress" and status.mode in ("done", "stopped", "fault")
        if status.item in _NUMBERS and not (is_over and status.item in self._numbers):
            self._numbers[status.item] = status.value

    @property
    def is_late(self) -> bool:
        """Orders reach it too late to have an effect."""
        return self.answer_s is not None and self.answer_s > self.order_age_s

    def late_line(self) -> str:
        """What an operator should know of a robot that is late."""
        return (
            f"a packet and its answer take {self.answer_s:.1f} s: orders have no effect "
            f"(limits.order_age_s is {self.order_age_s:g}), and what is shown is as old"
        )

    def is_heard(self, now: float) -> bool:
        """Whether it has been heard lately."""
        return now - self.heard_s < LOST_AFTER_S

    @property
    def progress(self) -> float | None:
        """Covered part of the distance, from 0 to 1."""
        value = self._numbers.get("progress")
        return None if value is None else value / _NOT_MEASURED

    @property
    def battery_v(self) -> float | None:
        """Voltage of the battery; None: not measured."""
        value = self._numbers.get("battery", _NOT_MEASURED)
        return None if value == _NOT_MEASURED else value / 1000

    @property
    def phase(self) -> str:
        """The phase of a job on the floor; empty: it is none, or not known yet."""
        return phase_name(self._numbers.get("phase", _NOT_MEASURED))

    def frame(self, now: float) -> dict[str, Any] | None:
        """The same for a screen; None: the robot has never been heard."""
        status = self.status
        if status is None:
            return None
        return {
            "is_heard": self.is_heard(now),
            "silent_s": round(now - self.heard_s, 2),
            "mode": status.mode,
            "fault": status.fault,
            "sign": status.sign,
            "palm": status.palm,
            "palm_at_target": status.palm_at_target,
            "case": status.case.strip(),
            "at_rest": status.at_rest,
            "stop": status.stop,
            "progress": self.progress,
            "phase": self.phase,
            "battery_v": self.battery_v,
            "overruns": self._numbers.get("overruns"),
            "loss": self.link.loss(now),
            "round_trip_s": self.link.round_trip_s(now),
            "boots": self.stamp[0],
        }

    def warnings(self, now: float) -> list[str]:
        """What an operator should know."""
        if self.status is None:
            return ["has not been heard yet"]
        if not self.is_heard(now):
            return [f"not heard for {now - self.heard_s:.0f} s"]
        found = [self.late_line()] if self.is_late else []
        if self.status.fault != "none":
            found.append(f"fault {fault_line(self.status.fault)}")
        if (late := self._numbers.get("overruns", 0)) >= _MANY_OVERRUNS:
            found.append(f"missed {late} control ticks in its last 100 steps")
        if (loss := self.link.loss(now)) is not None and loss >= _MUCH_LOSS:
            found.append(f"{100 * loss:.0f} % of its packets are lost")
        return found

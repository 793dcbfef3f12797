# SPDX-License-Identifier: Apache-2.0
"""Publishes to ROS 2 what a robot's program does. It runs beside that program, and only watches."""

import math
import time
from collections.abc import Callable
from typing import Any

from palmbots._types import Side
from palmbots._util.optional_imports import require
from palmbots.pair.pair_file import Pair
from palmbots.robot.observation import Observation, Observations, observation_socket
from palmbots.ros2.robot_messages import RobotMessages
from palmbots.ros2.ros2_topics import OF_THE_BASE, PUBLISHED, Topic, type_of

_SILENCE_S = 1.0
_SLOW_PERIOD_S = 1.0
_OK, _WARNING, _ERROR, _STALE = range(4)  # levels of a DiagnosticStatus


def run_bridge(
    pair: Pair,
    side: Side,
    *,
    seconds: float = math.inf,
    on_change: Callable[[str], None] = lambda _: None,
) -> dict[str, int]:
    """Publish what the program of one robot does, until the time is over.

    Args:
        pair: the pair.
        side: which of its robots.
        seconds: how long.
        on_change: called with a line when the robot's program is heard, and when it falls silent.

    Returns:
        How many messages were published on each topic.

    Raises:
        PalmbotsError: DDS cannot be used, its package is missing, or another program watches the
            robot.
    """
    observations = Observations(observation_socket(pair.state_file(side)))
    try:
        bridge = Bridge(pair, side)
        try:
            end_s = time.monotonic() + seconds
            while (now := time.monotonic()) < end_s:
                was_heard = bridge.is_heard
                for seen in observations.receive(min(bridge.wait_s, end_s - now)):
                    bridge.take(seen)
                bridge.step()
                if bridge.is_heard != was_heard:
                    words = "is heard" if bridge.is_heard else "is silent"
                    on_change(f"{side} robot: its program {words}")
            return bridge.counts()
        finally:
            bridge.close()
    finally:
        observations.close()


class Bridge:
    """The publishers of one robot.

    Args:
        pair: the pair.
        side: which of its robots.

    Raises:
        PalmbotsError: DDS cannot be used, or its package is missing.
    """

    def __init__(self, pair: Pair, side: Side) -> None:
        settings = pair.settings.ros2
        self._made: Any = require("palmbots.ros2.ros2_messages", "ros2")
        module: Any = require("palmbots.ros2.ros2_node", "ros2")
        self._header: Callable[[str], Any] = module.header
        scene = pair.checked_scene()
        self._side, self._robot = side, f"palmbots: {side} robot"
        self._hardware = f"palmbots-{pair.settings.pair.number}-{side}"
        self._messages = RobotMessages(settings, side, scene.task.direction, self._header)
        self.wait_s = 1.0 / settings.rate_hz
        self._fast = _Beat(self.wait_s)
        self._slow = _Beat(_SLOW_PERIOD_S)
        self._seen: Observation | None = None
        self._heard_s = -math.inf
        self._mode = ""
        self._node = module.Ros2Node(settings.domain())
        self._publishers = {
            topic.name: self._node.publisher(
                topic.name if topic.name.startswith("/") else settings.topic(side, topic.name),
                type_of(topic, settings),
                topic.quality,
            )
            for topic in published_topics(pair)
        }

    @property
    def is_heard(self) -> bool:
        """The robot's program runs."""
        return time.monotonic() - self._heard_s <= _SILENCE_S

    def take(self, seen: Observation) -> None:
        """Take in an observation; a new mode is published at once."""
        self._seen, self._heard_s = seen, time.monotonic()
        self._messages.take_distance(seen.time_s, seen.distance_m)
        self._publish_mode(seen.mode)

    def step(self) -> None:
        """Publish what is due."""
        seen = self._seen if self.is_heard else None
        if seen is None:
            self._publish_mode("off")
        elif self._fast.is_due():
            for name, message in self._messages.of(seen):
                self._publish(name, message)
        if self._slow.is_due():
            self._publish("/diagnostics", self._diagnostics(seen))
            if seen is not None and seen.battery_v is not None:
                voltage = self._made.BatteryState(
                    self._header(self._messages.base_frame), voltage=seen.battery_v
                )
                self._publish("battery_state", voltage)

    def counts(self) -> dict[str, int]:
        """How many messages were published on each topic."""
        return {name: publisher.count for name, publisher in self._publishers.items()}

    def close(self) -> None:
        """Leave the domain; the mode is `off` for those who listen."""
        self._publish_mode("off")
        self._node.close()

    def _publish(self, name: str, message: Any) -> None:
        if name in self._publishers:
            self._publishers[name].publish(message)

    def _publish_mode(self, mode: str) -> None:
        if mode != self._mode:
            self._mode = mode
            self._publish("mode", self._made.String(mode))

    def _diagnostics(self, seen: Observation | None) -> Any:
        made = self._made
        level, message, values = _health(seen)
        table = [made.KeyValue(key, value) for key, value in values.items()]
        status = made.DiagnosticStatus(level, self._robot, message, self._hardware, table)
        return made.DiagnosticArray(self._header(""), [status])


def published_topics(pair: Pair) -> list[Topic]:
    """The topics that are published: not what the driver ``ros2`` and its base publish already."""
    has_ros2_base = pair.settings.driver.kind == "ros2"
    taken = {*OF_THE_BASE, "battery_state"} if has_ros2_base else set()
    return [topic for topic in PUBLISHED if topic.name not in taken]


def _health(seen: Observation | None) -> tuple[int, str, dict[str, str]]:
    """Level, message and values of a diagnostic status."""
    if seen is None:
        return _STALE, "the robot's program is silent", {}
    values = {
        "mode": seen.mode,
        "fault": seen.fault,
        "sign": str(seen.sign),
        "contact": str(seen.has_contact).lower(),
        "palm_at_target": str(seen.palm_at_target).lower(),
        "distance_m": "" if seen.distance_m is None else f"{seen.distance_m:.4f}",
        "battery_v": "" if seen.battery_v is None else f"{seen.battery_v:.2f}",
        "overruns": str(seen.overruns),
        **{f"packets_{verdict}": str(count) for verdict, count in seen.received.items()},
    }
    if seen.mode == "fault":
        return _ERROR, f"fault: {seen.fault}", values
    if seen.mode == "stopped":
        return _WARNING, "a stop is in force", values
    if seen.fault != "none":
        return _WARNING, f"{seen.mode}: {seen.fault}", values
    return _OK, seen.mode, values


class _Beat:
    """Says when something that is done periodically is due; never in bursts."""

    def __init__(self, period_s: float) -> None:
        self._period_s, self._next_s = period_s, -math.inf

    def is_due(self) -> bool:
        """Whether it is due now; the next time is a period later."""
        now = time.monotonic()
        if now < self._next_s - 0.1 * self._period_s:  # a tick of the robot may come a little early
            return False
        following_s = self._next_s + self._period_s
        self._next_s = following_s if following_s > now else now + self._period_s
        return True

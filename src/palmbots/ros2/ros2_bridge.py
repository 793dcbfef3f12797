# SPDX-License-Identifier: Apache-2.0
"""Publishes to ROS 2 what a robot's program does. It runs beside that program, and only watches."""

import math
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from palmbots._types import Side
from palmbots._util.optional_imports import require
from palmbots.pair.pair_file import Pair
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.robot.observation import Observation, Observations, observation_socket
from palmbots.ros2.ros2_topics import OF_THE_BASE, PUBLISHED, Topic, travel_sign
from palmbots.scene.scene import load_scene

_SILENCE_S = 1.0
_SLOW_PERIOD_S = 1.0
_NOT_MEASURED = 1e6
"""Variance of what the robot does not measure, such as its way to the side."""
_MEASURED = 1e-4
"""Variance of distance and speed by odometry: assumed, 1 cm and 1 cm/s."""
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
        settings = self._settings = pair.settings.ros2
        self._made: Any = require("palmbots.ros2.ros2_messages", "ros2")
        module: Any = require("palmbots.ros2.ros2_node", "ros2")
        self._header: Callable[[str], Any] = module.header
        scene = load_scene(pair.scene())
        self._side, self._robot = side, f"palmbots: {side} robot"
        self._hardware = f"palmbots-{pair.settings.pair.number}-{side}"
        self._frames = {
            name: f"{settings.namespace(side)}/{name}"
            for name in ("odom", "base_link", "palm_link")
        }
        leads = (side == "right") == (scene.task.direction == "forward")
        self._travels = travel_sign(leads, settings.front)
        self._pitch = 1 if settings.front == "partner" else -1
        self.wait_s = 1.0 / settings.rate_hz
        self._fast = _Beat(self.wait_s)
        self._slow = _Beat(_SLOW_PERIOD_S)
        self._seen: Observation | None = None
        self._heard_s = -math.inf
        self._mode = ""
        self._speedometer = _Speedometer()
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
        self._speedometer.take(seen.time_s, seen.distance_m)
        self._publish_mode(seen.mode)

    def step(self) -> None:
        """Publish what is due."""
        seen = self._seen if self.is_heard else None
        if seen is None:
            self._publish_mode("off")
        elif self._fast.is_due():
            for name, message in self._measured(seen):
                self._publish(name, message)
        if self._slow.is_due():
            self._publish("/diagnostics", self._diagnostics(seen))
            if seen is not None and seen.battery_v is not None:
                voltage = self._made.BatteryState(
                    self._header(self._frames["base_link"]), voltage=seen.battery_v
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

    def _measured(self, seen: Observation) -> list[tuple[str, Any]]:
        """What changes from tick to tick, by topic."""
        made = self._made
        base = self._header(self._frames["base_link"])
        twist = made.Twist(linear=made.Vector3(x=self._travels * seen.speed_m_s))
        is_stamped = self._settings.cmd_vel_type == "TwistStamped"
        settings = self._settings
        position = (
            math.radians(settings.palm_joint_zero_deg) + settings.palm_joint_sign * seen.palm_rad
        )
        measured = [
            ("cmd_vel", made.TwistStamped(base, twist) if is_stamped else twist),
            ("joint_states", made.JointState(base, [settings.palm_joint], [position])),
            ("contact", made.Int8(seen.sign)),
            ("contact_present", made.Bool(seen.has_contact)),
        ]
        transforms = [self._palm_transform(seen.palm_rad)]
        if seen.distance_m is not None:
            measured.append(("odom", self._odometry(seen.distance_m)))
            transforms.insert(0, self._base_transform(seen.distance_m))
        return [*measured, ("/tf", made.TFMessage(transforms))]

    def _odometry(self, distance_m: float) -> Any:
        made = self._made
        x, speed = self._travels * distance_m, self._travels * self._speedometer.speed_m_s
        return made.Odometry(
            self._header(self._frames["odom"]),
            self._frames["base_link"],
            made.PoseWithCovariance(made.Pose(made.Point(x=x)), _covariance()),
            made.TwistWithCovariance(made.Twist(linear=made.Vector3(x=speed)), _covariance()),
        )

    def _base_transform(self, distance_m: float) -> Any:
        made = self._made
        move = made.Transform(made.Vector3(x=self._travels * distance_m))
        return made.TransformStamped(
            self._header(self._frames["odom"]), self._frames["base_link"], move
        )

    def _palm_transform(self, palm_rad: float) -> Any:
        """The palm turns about the y axis, so that its normal leans towards the partner."""
        made, settings = self._made, self._settings
        half = 0.5 * self._pitch * palm_rad
        turn = made.Transform(
            made.Vector3(x=settings.palm_x_m, z=settings.palm_z_m),
            made.Quaternion(y=math.sin(half), w=math.cos(half)),
        )
        return made.TransformStamped(
            self._header(self._frames["base_link"]), self._frames["palm_link"], turn
        )

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


def type_of(topic: Topic, settings: Ros2Table) -> str:
    """The message of a topic; of several, the one that the settings name."""
    chosen = [name for name in topic.types if name.endswith(f"/{settings.cmd_vel_type}")]
    return (chosen or [*topic.types])[0]


def _covariance() -> list[float]:
    """Of x, y, z and the rotations about them; the robot measures its way forward only."""
    variances = (_MEASURED, *(_NOT_MEASURED,) * 5)
    return [variances[i // 6] if i % 7 == 0 else 0.0 for i in range(36)]


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


class _Speedometer:
    """The mean speed over at least the last 0.1 s, if so much is known."""

    _WINDOW_S = 0.1

    def __init__(self) -> None:
        self._points: deque[tuple[float, float]] = deque()

    def take(self, time_s: float, distance_m: float | None) -> None:
        """Take in a distance."""
        if distance_m is None:
            self._points.clear()
            return
        self._points.append((time_s, distance_m))
        while len(self._points) > 2 and time_s - self._points[1][0] >= self._WINDOW_S:
            self._points.popleft()

    @property
    def speed_m_s(self) -> float:
        """The speed; 0 as long as too little is known."""
        if len(self._points) < 2:
            return 0.0
        (since_s, from_m), (until_s, to_m) = self._points[0], self._points[-1]
        return (to_m - from_m) / (until_s - since_s) if until_s > since_s else 0.0

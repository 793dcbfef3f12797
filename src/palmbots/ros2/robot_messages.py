# SPDX-License-Identifier: Apache-2.0
"""What a robot reads and commands in a tick, as messages of ROS 2. Needs the extra ``ros2``."""

import math
from collections import deque
from collections.abc import Callable
from typing import Any, Protocol

from palmbots._types import Side
from palmbots._util.optional_imports import require
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.ros2.ros2_topics import travel_sign

_NOT_MEASURED = 1e6
"""Variance of what the robot does not measure, such as its way to the side."""
_MEASURED = 1e-4
"""Variance of distance and speed by odometry: assumed, 1 cm and 1 cm/s."""


class Reading(Protocol):
    """What is known of a tick: the fields of an `Observation` with these names."""

    @property
    def sign(self) -> int: ...  # noqa: D102
    @property
    def has_contact(self) -> bool: ...  # noqa: D102
    @property
    def palm_rad(self) -> float: ...  # noqa: D102
    @property
    def speed_m_s(self) -> float: ...  # noqa: D102
    @property
    def distance_m(self) -> float | None: ...  # noqa: D102


class RobotMessages:
    """The messages of one robot.

    Args:
        settings: names, frames and signs, the table ``[ros2]``.
        side: which robot.
        direction: of travel, the scene's key.
        header: the header of a message in a frame, with the time of the tick.
    """

    def __init__(
        self,
        settings: Ros2Table,
        side: Side,
        direction: str,
        header: Callable[[str], Any],
    ) -> None:
        self._made: Any = require("palmbots.ros2.ros2_messages", "ros2")
        self._settings, self._header = settings, header
        self._frames = {
            name: f"{settings.namespace(side)}/{name}"
            for name in ("odom", "base_link", "palm_link")
        }
        leads = (side == "right") == (direction == "forward")
        self._travels = travel_sign(leads, settings.front)
        self._pitch = 1 if settings.front == "partner" else -1
        self._speedometer = _Speedometer()

    @property
    def base_frame(self) -> str:
        """The frame of the robot's base."""
        return self._frames["base_link"]

    def take_distance(self, time_s: float, distance_m: float | None) -> None:
        """Take in the distance covered, from which the speed in ``odom`` comes."""
        self._speedometer.take(time_s, distance_m)

    def of(self, seen: Reading) -> list[tuple[str, Any]]:
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


def _covariance() -> list[float]:
    """Of x, y, z and the rotations about them; the robot measures its way forward only."""
    variances = (_MEASURED, *(_NOT_MEASURED,) * 5)
    return [variances[i // 6] if i % 7 == 0 else 0.0 for i in range(36)]


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

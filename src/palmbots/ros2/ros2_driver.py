# SPDX-License-Identifier: Apache-2.0
"""The driver of a robot whose base and palm are nodes of ROS 2.

The base is the motor board: it must stop the wheels when no `cmd_vel` has come for the time of the
watchdog, which is its own timeout (``cmd_vel_timeout`` of diff_drive_controller).
"""

import math
import time
from typing import Any

from palmbots._types import Side
from palmbots._util.optional_imports import require
from palmbots.drivers.driver import Drive, DriverSettings, Reading
from palmbots.errors import PalmbotsError
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.ros2.ros2_topics import COMMANDS, READINGS, Topic, travel_sign, type_of

_BASE_STARTS_WITHIN_S = 20.0
_POLL_S = 0.02
_REPEAT_S = 1.0  # a trajectory is sent again if the palm has not arrived by its end and this


class Ros2Driver:
    """Drives a base by ``cmd_vel`` and a palm by its joint, and reads what they publish.

    Args:
        settings: the topics and the palm's joint.
        side: of the robot.
        leads: the robot travels away from its partner.
        watchdog_s: ``control.watchdog_s``; a command expires after it.

    Raises:
        PalmbotsError: DDS cannot be used, or its package is missing.
    """

    def __init__(self, settings: Ros2Table, side: Side, leads: bool, watchdog_s: float) -> None:
        self._settings = settings
        self._messages: Any = require("palmbots.ros2.ros2_messages", "ros2")
        module: Any = require("palmbots.ros2.ros2_node", "ros2")
        self._header = module.header
        self._frame = f"{settings.namespace(side)}/base_link"
        self._sign = travel_sign(leads, settings.front)
        self._target_rad: float | None = None
        self._sent_s = -math.inf
        self._start: tuple[float, float, float] | None = None
        node = self._node = module.Ros2Node(settings.domain())

        def publisher(topic: Topic) -> Any:
            kind = type_of(topic, settings)
            name = settings.topic(side, getattr(settings, topic.name))
            lifespan_s = watchdog_s if topic.name == "cmd_vel" else None
            return node.publisher(name, kind, topic.quality, lifespan_s=lifespan_s)

        is_usable = {"joint_states": self._names_the_palm, "odom": _is_finite}

        def subscriber(topic: Topic) -> Any:
            if not (name := getattr(settings, topic.name)):
                return None
            full, usable = settings.topic(side, name), is_usable.get(topic.name, lambda _: True)
            return node.subscriber(full, topic.types[0], topic.quality, usable)

        palm = "trajectory" if settings.palm_command == "trajectory" else "position"
        commands = {topic.name: topic for topic in COMMANDS}
        self._velocity = publisher(commands["cmd_vel"])
        self._palm = publisher(commands[palm])
        readings = {topic.name: subscriber(topic) for topic in READINGS}
        self._joints, self._odometry = readings["joint_states"], readings["odom"]
        self._contact, self._present = readings["contact"], readings["contact_present"]
        self._battery = readings["battery_state"]
        self._needed = [self._joints, self._contact]
        if self._odometry is not None:
            self._needed.append(self._odometry)
        self._read = [*self._needed, self._present, self._battery]

    def read(self) -> Reading:
        """The newest reading. Waits only for the first one.

        Raises:
            PalmbotsError: nobody publishes what has to be read.
        """
        self._take()
        give_up = time.monotonic() + _BASE_STARTS_WITHIN_S
        while missing := self._missing():
            if time.monotonic() > give_up:
                domain = self._settings.domain()
                raise PalmbotsError(
                    f"ros2: nothing is heard on {' and '.join(missing)}; "
                    f"does the base run, in domain {domain}?"
                )
            time.sleep(_POLL_S)
            self._take()
        sign = self._contact.message.data
        return Reading(
            sign=(sign > 0) - (sign < 0),
            palm_at_target=self._is_at_target(),
            distance_m=self._distance_m(),
            battery_v=self._battery_v(),
            has_contact=self._has_contact(),
        )

    def _missing(self) -> list[str]:
        """The topics on which nothing that can be used has been heard yet."""
        return [
            f"{one.name} about {self._settings.palm_joint}" if one is self._joints else one.name
            for one in self._needed
            if one.message is None
        ]

    def _take(self) -> None:
        for one in self._read:
            if one is not None:
                one.take()

    def _names_the_palm(self, message: Any) -> bool:
        """Whether joint states are about the palm; other nodes may publish others."""
        return self._settings.palm_joint in message.name and math.isfinite(self._angle_in(message))

    def _angle_in(self, message: Any) -> float:
        """The position of the palm's joint; NaN: not stated."""
        index = list(message.name).index(self._settings.palm_joint)
        return message.position[index] if index < len(message.position) else math.nan

    def _is_at_target(self) -> bool:
        if self._target_rad is None or self._joints.message is None:
            return False
        away = abs(self._angle_in(self._joints.message) - self._joint_position(self._target_rad))
        return away <= math.radians(self._settings.palm_tolerance_deg)

    def _joint_position(self, palm_rad: float) -> float:
        """The position of the joint at this angle of the palm."""
        settings = self._settings
        return math.radians(settings.palm_joint_zero_deg) + settings.palm_joint_sign * palm_rad

    def _distance_m(self) -> float:
        """The way along the heading of the first odometry, positive in the direction of travel."""
        if self._odometry is None:
            return math.nan
        pose = self._odometry.message.pose.pose
        x, y, q = pose.position.x, pose.position.y, pose.orientation
        if self._start is None:
            yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
            self._start = (x, y, yaw)
        x0, y0, yaw0 = self._start
        return self._sign * ((x - x0) * math.cos(yaw0) + (y - y0) * math.sin(yaw0))

    def _has_contact(self) -> bool:
        if self._present is None:
            return True
        return self._present.message is not None and bool(self._present.message.data)

    def _battery_v(self) -> float | None:
        if self._battery is None or self._battery.message is None:
            return None
        voltage = float(self._battery.message.voltage)
        return voltage if math.isfinite(voltage) else None

    @property
    def works(self) -> bool:
        """Every topic that has to be read is still published."""
        now = time.monotonic()
        return all(now - one.heard_s <= self._settings.silence_s for one in self._needed)

    def write(self, drive: Drive) -> None:
        """Command palm and wheels; if `drive.wheels` is false, the wheels stop."""
        self._drive(drive.speed_m_s if drive.wheels else 0.0)
        self._turn(drive.palm_rad)

    def stop(self) -> None:
        """Stop the wheels; the palm keeps its angle."""
        self._drive(0.0)

    def close(self) -> None:
        """Stop the wheels, and leave the domain."""
        self.stop()
        self._node.close()

    def _drive(self, speed_m_s: float) -> None:
        made = self._messages
        twist = made.Twist(linear=made.Vector3(x=self._sign * speed_m_s))
        is_stamped = self._settings.cmd_vel_type == "TwistStamped"
        stamped = made.TwistStamped(self._header(self._frame), twist) if is_stamped else twist
        self._velocity.publish(stamped)

    def _turn(self, palm_rad: float) -> None:
        made, settings = self._messages, self._settings
        position = self._joint_position(palm_rad)
        if settings.palm_command != "trajectory":
            kind = made.Float64MultiArray
            is_array = settings.palm_command == "array"
            self._palm.publish(kind(data=[position]) if is_array else made.Float64(position))
            self._target_rad = palm_rad
            return
        # A controller starts each trajectory anew, so the same one is not repeated on the way.
        now = time.monotonic()
        is_new = palm_rad != self._target_rad
        is_late = now - self._sent_s > settings.palm_time_s + _REPEAT_S and not self._is_at_target()
        self._target_rad = palm_rad
        if is_new or is_late:
            self._sent_s = now
            seconds, rest = divmod(round(settings.palm_time_s * 1e9), 1_000_000_000)
            point = made.JointTrajectoryPoint(
                positions=[position], time_from_start=made.Duration(seconds, rest)
            )
            self._palm.publish(
                made.JointTrajectory(joint_names=[settings.palm_joint], points=[point])
            )


def open_ros2(settings: DriverSettings) -> Ros2Driver:
    """The driver of a robot, as ``[ros2]`` of its ``pair.toml`` describes it.

    Raises:
        PalmbotsError: DDS cannot be used, or its package is missing.
    """
    table = settings.table or Ros2Table()
    return Ros2Driver(table, settings.side, settings.leads, settings.watchdog_s)


def _is_finite(odometry: Any) -> bool:
    pose = odometry.pose.pose
    values = (*vars(pose.position).values(), *vars(pose.orientation).values())
    return all(map(math.isfinite, values))

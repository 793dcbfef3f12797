# SPDX-License-Identifier: Apache-2.0
"""Topics of a robot in ROS 2: what is published, and what is read.

This module needs no package of ROS 2 or DDS: the documentation reads it, too.
"""

from dataclasses import dataclass

from palmbots.pair.ros2_keys import Ros2Table


@dataclass(frozen=True)
class Topic:
    """One topic."""

    name: str
    """In the robot's namespace; with / in front: as it stands."""
    types: tuple[str, ...]
    """Names of the message; several: a key chooses."""
    quality: str
    """`QUALITIES` of the publisher."""
    meaning: str
    is_optional: bool = False
    """Published, or read, only where it is measured."""


@dataclass(frozen=True)
class Quality:
    """Quality of service, in the words of ROS 2."""

    reliable: bool
    transient_local: bool
    depth: int
    meaning: str


QUALITIES = {
    "default": Quality(True, False, 10, "the default of ROS 2"),
    "command": Quality(True, False, 1, "as default, but only the newest"),
    "latched": Quality(True, True, 1, "the newest one also reaches subscribers that come later"),
    "tf": Quality(True, False, 100, "as tf2 publishes"),
    "sensor": Quality(False, False, 5, "sensor data: lost samples are not repeated"),
}

_STAMPED = ("geometry_msgs/msg/TwistStamped", "geometry_msgs/msg/Twist")
_ODOMETRY = "nav_msgs/msg/Odometry"
_JOINTS = "sensor_msgs/msg/JointState"
_BATTERY = "sensor_msgs/msg/BatteryState"
_BOOL = "std_msgs/msg/Bool"
_SIGN = "std_msgs/msg/Int8"

PUBLISHED = (
    Topic(
        "cmd_vel",
        _STAMPED,
        "default",
        "Velocity that the robot's program commands, in base_link.",
    ),
    Topic(
        "joint_states",
        (_JOINTS,),
        "default",
        "Position of the palm's joint, as commanded: the program only knows whether it is reached.",
    ),
    Topic(
        "odom",
        (_ODOMETRY,),
        "default",
        "Distance and speed in the direction of travel, from the robot's odometry.",
        is_optional=True,
    ),
    Topic("/tf", ("tf2_msgs/msg/TFMessage",), "tf", "odom to base_link, base_link to palm_link."),
    Topic("contact", (_SIGN,), "default", "Sign of the contact coordinate p; 1 is outward."),
    Topic("contact_present", (_BOOL,), "default", "Something lies on the palm."),
    Topic(
        "battery_state",
        (_BATTERY,),
        "default",
        "Voltage of the battery, once per second.",
        is_optional=True,
    ),
    Topic(
        "mode",
        ("std_msgs/msg/String",),
        "latched",
        "Mode of the robot, whenever it changes; off: its program does not run.",
    ),
    Topic(
        "/diagnostics",
        ("diagnostic_msgs/msg/DiagnosticArray",),
        "default",
        "Mode, fault, battery, missed ticks and packets, once per second.",
    ),
)
"""What ``palmbots ros2`` publishes."""

OF_THE_BASE = ("cmd_vel", "joint_states", "odom", "/tf", "contact", "contact_present")
"""What is already published if the robot's driver is ``ros2``: by the driver, and by the base."""

COMMANDS = (
    Topic("cmd_vel", _STAMPED, "command", "Velocity in base_link, in every control period."),
    Topic(
        "trajectory",
        ("trajectory_msgs/msg/JointTrajectory",),
        "command",
        "Motion of the palm's joint, whenever the target changes.",
    ),
    Topic(
        "position",
        ("std_msgs/msg/Float64MultiArray", "std_msgs/msg/Float64"),
        "command",
        "Position of the palm's joint, in every control period.",
    ),
)
"""What the driver ``ros2`` publishes; the names are keys of [ros2]."""

READINGS = (
    Topic("joint_states", (_JOINTS,), "sensor", "The palm's angle."),
    Topic("odom", (_ODOMETRY,), "sensor", "The distance covered.", is_optional=True),
    Topic("contact", (_SIGN,), "sensor", "Sign of the contact coordinate p."),
    Topic("contact_present", (_BOOL,), "sensor", "Anything on the palm.", is_optional=True),
    Topic("battery_state", (_BATTERY,), "sensor", "Voltage of the battery.", is_optional=True),
)
"""What the driver ``ros2`` reads; the names are keys of [ros2]."""


def type_of(topic: Topic, settings: Ros2Table) -> str:
    """The message of a topic; of several, the one that a key of [ros2] chooses."""
    palm = "Float64" if settings.palm_command == "float" else "Float64MultiArray"
    ends = (f"/{settings.cmd_vel_type}", f"/{palm}")
    return next((name for name in topic.types if name.endswith(ends)), topic.types[0])


def dds_topic(name: str) -> str:
    """The name in DDS of a topic with a full name, such as ``rt/left/odom`` of ``/left/odom``."""
    return f"rt{name}"


def dds_type(name: str) -> str:
    """The name in DDS of a type: ``std_msgs::msg::dds_::Bool_`` for ``std_msgs/msg/Bool``."""
    package, kind, message = name.split("/")
    return f"{package}::{kind}::dds_::{message}_"


def travel_sign(leads: bool, front: str) -> int:
    """1 if a robot drives forward when it travels, else -1.

    Args:
        leads: the robot travels away from its partner.
        front: key of [ros2].
    """
    return -1 if leads == (front == "partner") else 1

# SPDX-License-Identifier: Apache-2.0
"""The table ``[ros2]`` of ``pair.toml``: names of topics and frames of robots in ROS 2.

A robot's topics are in a namespace of its own, ``/left`` or ``/right``.
"""

import os
import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from palmbots._types import Side
from palmbots._util.arguments import whole_number
from palmbots.scene.fields import Range, field_error
from palmbots.scene.section import Section

_TOKEN = r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*_?"
_NAME = re.compile(rf"/?{_TOKEN}(/{_TOKEN})*")
LARGEST_DOMAIN = 232
"""A larger number would need UDP ports above 65535."""


def _name(is_optional: bool) -> Any:
    def check(value: object) -> object:
        fits = isinstance(value, str) and (_NAME.fullmatch(value) or (is_optional and not value))
        if not fits:
            allowed = "a ROS 2 name such as base/odom: letters, digits and _, with / between names"
            raise field_error(value, "is no name", f'{allowed}, or ""' if is_optional else allowed)
        return value

    return BeforeValidator(check)


def _domain(value: object) -> object:
    if not isinstance(value, int) or isinstance(value, bool) or not -1 <= value <= LARGEST_DOMAIN:
        allowed = f"0 to {LARGEST_DOMAIN}, or -1"
        raise field_error(value, "is no domain", allowed)
    return value


Name = Annotated[str, _name(False)]
OptionalName = Annotated[str, _name(True)]
Domain = Annotated[int, BeforeValidator(_domain)]
Rate = Annotated[float, BeforeValidator(Range("Hz", least=0.1, most=1000))]
Silence = Annotated[float, BeforeValidator(Range("s", least=0.01, most=100))]
Turn = Annotated[float, BeforeValidator(Range("°", least=-360, most=360))]
Tolerance = Annotated[float, BeforeValidator(Range("°", least=0.01, most=45))]
Position = Annotated[float, BeforeValidator(Range("m", least=-10, most=10))]


class Ros2Table(Section):
    """[ros2] How ROS 2 sees both robots, and the base that the driver ros2 drives."""

    domain_id: Domain = -1
    """ROS domain, 0 to 232; -1: what the variable ROS_DOMAIN_ID says, else 0."""
    left_namespace: Name = "left"
    """Namespace of the left robot's topics, and prefix of its frames."""
    right_namespace: Name = "right"
    """The same of the right robot."""
    rate_hz: Rate = 50.0
    """How often palmbots ros2 publishes each topic, at most once per control period."""
    cmd_vel_type: Literal["Twist", "TwistStamped"] = "TwistStamped"
    """Type of cmd_vel: TwistStamped, as newer distributions expect, or Twist."""
    front: Literal["partner", "away"] = "partner"
    """Where the x axis of base_link points: to the partner, if the palm is at the front, or away
    from it."""
    palm_x_m: Position = 0.0
    """Position of the palm's pivot in base_link, forward."""
    palm_z_m: Position = 0.0
    """The same, upward."""
    palm_joint: Name = "palm_joint"
    """Name of the palm's joint in joint_states and in commands."""
    palm_joint_sign: Literal[1, -1] = 1
    """-1: the joint's position falls when the palm becomes steeper."""
    palm_joint_zero_deg: Turn = 0.0
    """Position of the joint when the palm is horizontal."""
    palm_command: Literal["trajectory", "array", "float"] = "trajectory"
    """How the driver commands the palm: trajectory (JointTrajectory), array (Float64MultiArray), or
    float (Float64)."""
    palm_time_s: Silence = 0.5
    """Duration of a palm's turn in a JointTrajectory."""
    palm_tolerance_deg: Tolerance = 1.0
    """The palm is at its target if its joint is this close."""
    cmd_vel: Name = "cmd_vel"
    """Topic of the base for velocities, in the namespace; with / in front: as it stands."""
    trajectory: Name = "palm_controller/joint_trajectory"
    """Topic for palm_command = "trajectory"."""
    position: Name = "palm_controller/commands"
    """Topic for palm_command = "array" and "float"."""
    joint_states: Name = "joint_states"
    """Topic with the position of the palm's joint."""
    odom: OptionalName = "odom"
    """Topic with the odometry; "": the base has none."""
    contact: Name = "contact"
    """Topic with the sign of p, an Int8: -1, 0 or 1."""
    contact_present: OptionalName = ""
    """Topic that says whether anything lies on the palm, a Bool; "": the palm cannot say."""
    battery_state: OptionalName = ""
    """Topic with the voltage, a BatteryState; "": not measured."""
    silence_s: Silence = 0.5
    """The base counts as lost if a topic that the driver reads is silent for longer."""

    def namespace(self, side: Side) -> str:
        """The namespace of a robot, without the slash in front."""
        return (self.left_namespace if side == "left" else self.right_namespace).strip("/")

    def topic(self, side: Side, name: str) -> str:
        """The full name of a topic of a robot."""
        return name if name.startswith("/") else f"/{self.namespace(side)}/{name}"

    def domain(self) -> int:
        """The number of the domain.

        Raises:
            PalmbotsError: ROS_DOMAIN_ID is not one.
        """
        if self.domain_id >= 0:
            return self.domain_id
        text = os.environ.get("ROS_DOMAIN_ID", "").strip() or "0"
        number = int(text) if text.isascii() and text.isdecimal() and len(text) < 9 else text
        return whole_number("ROS_DOMAIN_ID", number, 0, LARGEST_DOMAIN)

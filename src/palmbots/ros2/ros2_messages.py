# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 messages that are exchanged, as DDS types.

Each class of `MESSAGES` has the name and the fields of the message in the packages of ROS 2, and
the name that ROS 2 gives its type in DDS. It is also an attribute of this module under its own
name, such as `Bool`. Units are those of REP-103: metres, radians, seconds, volts. Needs the extra
``ros2``.
"""

import re
import types as python_types
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any

from cyclonedds.idl import IdlStruct, types

from palmbots.ros2.ros2_topics import dds_type

# As in the .msg files of the packages, one message a line; = states a default other than 0 or "".
_DEFINITIONS = """
builtin_interfaces/msg/Time: int32 sec, uint32 nanosec
builtin_interfaces/msg/Duration: int32 sec, uint32 nanosec
std_msgs/msg/Header: Time stamp, string frame_id
std_msgs/msg/Bool: bool data
std_msgs/msg/Int8: int8 data
std_msgs/msg/Float64: float64 data
std_msgs/msg/String: string data
std_msgs/msg/MultiArrayDimension: string label, uint32 size, uint32 stride
std_msgs/msg/MultiArrayLayout: MultiArrayDimension[] dim, uint32 data_offset
std_msgs/msg/Float64MultiArray: MultiArrayLayout layout, float64[] data
geometry_msgs/msg/Vector3: float64 x, float64 y, float64 z
geometry_msgs/msg/Point: float64 x, float64 y, float64 z
geometry_msgs/msg/Quaternion: float64 x, float64 y, float64 z, float64 w=1
geometry_msgs/msg/Pose: Point position, Quaternion orientation
geometry_msgs/msg/PoseWithCovariance: Pose pose, float64[36] covariance
geometry_msgs/msg/Twist: Vector3 linear, Vector3 angular
geometry_msgs/msg/TwistStamped: Header header, Twist twist
geometry_msgs/msg/TwistWithCovariance: Twist twist, float64[36] covariance
geometry_msgs/msg/Transform: Vector3 translation, Quaternion rotation
geometry_msgs/msg/TransformStamped: Header header, string child_frame_id, Transform transform
tf2_msgs/msg/TFMessage: TransformStamped[] transforms
nav_msgs/msg/Odometry: Header header, string child_frame_id, PoseWithCovariance pose, \
TwistWithCovariance twist
sensor_msgs/msg/JointState: Header header, string[] name, float64[] position, float64[] velocity, \
float64[] effort
sensor_msgs/msg/BatteryState: Header header, float32 voltage=nan, float32 temperature=nan, \
float32 current=nan, float32 charge=nan, float32 capacity=nan, float32 design_capacity=nan, \
float32 percentage=nan, uint8 power_supply_status, uint8 power_supply_health, \
uint8 power_supply_technology, bool present=1, float32[] cell_voltage, \
float32[] cell_temperature, string location, string serial_number
trajectory_msgs/msg/JointTrajectoryPoint: float64[] positions, float64[] velocities, \
float64[] accelerations, float64[] effort, Duration time_from_start
trajectory_msgs/msg/JointTrajectory: Header header, string[] joint_names, \
JointTrajectoryPoint[] points
diagnostic_msgs/msg/KeyValue: string key, string value
diagnostic_msgs/msg/DiagnosticStatus: byte level, string name, string message, \
string hardware_id, KeyValue[] values
diagnostic_msgs/msg/DiagnosticArray: Header header, DiagnosticStatus[] status
"""
_FIELD = re.compile(r"(\w+)(\[(\d*)\])? (\w+)(?:=(\w+))?")


def _field(known: dict[str, type], text: str) -> tuple[str, Any, Any]:
    """Name, annotation and default of a field."""
    match = _FIELD.fullmatch(text)
    assert match is not None, text
    kind, is_array, length, name, default = match.groups()
    element: Any = {"string": str, "bool": bool}.get(kind) or known.get(kind)
    element = element or getattr(types, kind)
    if is_array:
        array = types.array(element, int(length)) if length else types.sequence(element)
        zeros = [0.0] * int(length or 0)
        return name, Annotated[Sequence[Any], array], field(default_factory=lambda: [*zeros])
    if kind in known:
        return name, element, field(default_factory=element)
    make = {"string": str, "bool": bool, "float32": float, "float64": float}.get(kind, int)
    return name, element, make() if default is None else make(default)


def _message(known: dict[str, type], name: str, fields: str) -> type[Any]:
    """The class of a message."""
    rows = [_field(known, text) for text in fields.split(", ")]
    content = {
        "__annotations__": {key: kind for key, kind, _ in rows},
        "__module__": __name__,
        "__doc__": f"The message {name}.",
    } | {key: default for key, _, default in rows}
    made = python_types.new_class(
        name.rpartition("/")[2],
        (IdlStruct,),
        {"typename": dds_type(name)},
        lambda c: c.update(content),
    )
    return dataclass(made)


MESSAGES: dict[str, type[Any]] = {}
"""All messages, by their name in ROS 2."""
_known: dict[str, type[Any]] = {}
for _line in _DEFINITIONS.strip().splitlines():
    _name, _fields = _line.split(": ")
    MESSAGES[_name] = _known[_name.rpartition("/")[2]] = _message(_known, _name, _fields)


def __getattr__(name: str) -> Any:
    """A message by its own name, such as ``Bool``."""
    if name in _known:
        return _known[name]
    raise AttributeError(f"module {__name__} has no attribute {name}")

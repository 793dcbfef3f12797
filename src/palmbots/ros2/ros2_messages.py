# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 messages that are exchanged, as DDS types.

Each class has the name and the fields of the message in the packages of ROS 2, and the name that
ROS 2 gives its type in DDS. Units are those of REP-103: metres, radians, seconds, volts. Needs the
extra ``ros2``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, TypeAlias

from cyclonedds.idl import IdlStruct, types

Texts: TypeAlias = Annotated[Sequence[str], types.sequence(str)]
# cyclonedds declares the element as a class, and provides numbers as annotated types.
_DOUBLE: Any = types.float64
_FLOAT: Any = types.float32
Doubles: TypeAlias = Annotated[Sequence[float], types.sequence(_DOUBLE)]
Floats: TypeAlias = Annotated[Sequence[float], types.sequence(_FLOAT)]
Covariance: TypeAlias = Annotated[Sequence[float], types.array(_DOUBLE, 36)]


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    """A point in time, since 1970."""

    sec: types.int32 = 0
    nanosec: types.uint32 = 0


@dataclass
class Duration(IdlStruct, typename="builtin_interfaces::msg::dds_::Duration_"):
    """A length of time."""

    sec: types.int32 = 0
    nanosec: types.uint32 = 0


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    """When, and in which frame."""

    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass
class Bool(IdlStruct, typename="std_msgs::msg::dds_::Bool_"):
    """True or false."""

    data: bool = False


@dataclass
class Int8(IdlStruct, typename="std_msgs::msg::dds_::Int8_"):
    """A small whole number."""

    data: types.int8 = 0


@dataclass
class Float64(IdlStruct, typename="std_msgs::msg::dds_::Float64_"):
    """A number."""

    data: types.float64 = 0.0


@dataclass
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    """A text."""

    data: str = ""


@dataclass
class MultiArrayDimension(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayDimension_"):
    """One dimension of an array."""

    label: str = ""
    size: types.uint32 = 0
    stride: types.uint32 = 0


Dimensions: TypeAlias = Annotated[
    Sequence[MultiArrayDimension], types.sequence(MultiArrayDimension)
]


@dataclass
class MultiArrayLayout(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayLayout_"):
    """The dimensions of an array."""

    dim: Dimensions = field(default_factory=list)
    data_offset: types.uint32 = 0


@dataclass
class Float64MultiArray(IdlStruct, typename="std_msgs::msg::dds_::Float64MultiArray_"):
    """Several numbers."""

    layout: MultiArrayLayout = field(default_factory=MultiArrayLayout)
    data: Doubles = field(default_factory=list)


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    """A vector."""

    x: types.float64 = 0.0
    y: types.float64 = 0.0
    z: types.float64 = 0.0


@dataclass
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    """A position."""

    x: types.float64 = 0.0
    y: types.float64 = 0.0
    z: types.float64 = 0.0


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    """A rotation; the default is none."""

    x: types.float64 = 0.0
    y: types.float64 = 0.0
    z: types.float64 = 0.0
    w: types.float64 = 1.0


@dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    """A position and a rotation."""

    position: Point = field(default_factory=Point)
    orientation: Quaternion = field(default_factory=Quaternion)


@dataclass
class PoseWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovariance_"):
    """A pose and how sure it is: x, y, z, and the rotations about them."""

    pose: Pose = field(default_factory=Pose)
    covariance: Covariance = field(default_factory=lambda: [0.0] * 36)


@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    """A velocity."""

    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass
class TwistStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TwistStamped_"):
    """A velocity with time and frame."""

    header: Header = field(default_factory=Header)
    twist: Twist = field(default_factory=Twist)


@dataclass
class TwistWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::TwistWithCovariance_"):
    """A velocity and how sure it is."""

    twist: Twist = field(default_factory=Twist)
    covariance: Covariance = field(default_factory=lambda: [0.0] * 36)


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    """From one frame to another."""

    translation: Vector3 = field(default_factory=Vector3)
    rotation: Quaternion = field(default_factory=Quaternion)


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    """A transform, with time and both frames."""

    header: Header = field(default_factory=Header)
    child_frame_id: str = ""
    transform: Transform = field(default_factory=Transform)


Transforms: TypeAlias = Annotated[Sequence[TransformStamped], types.sequence(TransformStamped)]


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    """Several transforms."""

    transforms: Transforms = field(default_factory=list)


@dataclass
class Odometry(IdlStruct, typename="nav_msgs::msg::dds_::Odometry_"):
    """Pose in the frame of the header, velocity in the child frame."""

    header: Header = field(default_factory=Header)
    child_frame_id: str = ""
    pose: PoseWithCovariance = field(default_factory=PoseWithCovariance)
    twist: TwistWithCovariance = field(default_factory=TwistWithCovariance)


@dataclass
class JointState(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    """Positions of joints; velocities and efforts may be left out."""

    header: Header = field(default_factory=Header)
    name: Texts = field(default_factory=list)
    position: Doubles = field(default_factory=list)
    velocity: Doubles = field(default_factory=list)
    effort: Doubles = field(default_factory=list)


_NAN = float("nan")


@dataclass
class BatteryState(IdlStruct, typename="sensor_msgs::msg::dds_::BatteryState_"):
    """A battery. NaN and 0: not known."""

    header: Header = field(default_factory=Header)
    voltage: types.float32 = _NAN
    temperature: types.float32 = _NAN
    current: types.float32 = _NAN
    charge: types.float32 = _NAN
    capacity: types.float32 = _NAN
    design_capacity: types.float32 = _NAN
    percentage: types.float32 = _NAN
    power_supply_status: types.uint8 = 0
    power_supply_health: types.uint8 = 0
    power_supply_technology: types.uint8 = 0
    present: bool = True
    cell_voltage: Floats = field(default_factory=list)
    cell_temperature: Floats = field(default_factory=list)
    location: str = ""
    serial_number: str = ""


@dataclass
class JointTrajectoryPoint(IdlStruct, typename="trajectory_msgs::msg::dds_::JointTrajectoryPoint_"):
    """Where the joints are at a time after the start."""

    positions: Doubles = field(default_factory=list)
    velocities: Doubles = field(default_factory=list)
    accelerations: Doubles = field(default_factory=list)
    effort: Doubles = field(default_factory=list)
    time_from_start: Duration = field(default_factory=Duration)


Points: TypeAlias = Annotated[Sequence[JointTrajectoryPoint], types.sequence(JointTrajectoryPoint)]


@dataclass
class JointTrajectory(IdlStruct, typename="trajectory_msgs::msg::dds_::JointTrajectory_"):
    """A motion of joints; it starts at once if the stamp is 0."""

    header: Header = field(default_factory=Header)
    joint_names: Texts = field(default_factory=list)
    points: Points = field(default_factory=list)


@dataclass
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    """A named value."""

    key: str = ""
    value: str = ""


KeyValues: TypeAlias = Annotated[Sequence[KeyValue], types.sequence(KeyValue)]


@dataclass
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    """How a component is. Level 0: OK, 1: warning, 2: error, 3: nothing is heard of it."""

    level: types.byte = 0
    name: str = ""
    message: str = ""
    hardware_id: str = ""
    values: KeyValues = field(default_factory=list)


Statuses: TypeAlias = Annotated[Sequence[DiagnosticStatus], types.sequence(DiagnosticStatus)]


@dataclass
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    """How several components are."""

    header: Header = field(default_factory=Header)
    status: Statuses = field(default_factory=list)


def ros_name(message: type[IdlStruct]) -> str:
    """The name of a message in ROS 2, such as ``std_msgs/msg/Bool``."""
    return message.__idl_typename__.replace("::dds_::", "/").replace("::", "/").removesuffix("_")


MESSAGES: dict[str, type[Any]] = {
    ros_name(message): message
    for message in list(globals().values())
    if isinstance(message, type) and issubclass(message, IdlStruct) and message is not IdlStruct
}
"""All messages, by their name in ROS 2."""

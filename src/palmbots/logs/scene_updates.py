# SPDX-License-Identifier: Apache-2.0
"""The three-dimensional part of a carry log: solids, poses of their frames, contact points.

The 3D panel of Foxglove reads `foxglove.SceneUpdate` and `foxglove.FrameTransforms`
(https://docs.foxglove.dev/docs/sdk/schemas). Rerun reads the frames but draws no SceneUpdate. It
draws robot descriptions, so the same solids are also logged as URDF in a ROS 2 string, which both
viewers read.
"""

import math
import struct
from collections.abc import Iterable

from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.timestamp_pb2 import Timestamp  # ty: ignore[missing-module-member]  # made at run time

from palmbots._types import SIDES
from palmbots._util.xml_attributes import parts_of
from palmbots.scene.placement import Placement
from palmbots.viz.solids import WORLD, Ball, Box, Cylinder, Solid, Vector, poses
from palmbots.viz.style import SLIDES, ZERO


def transforms(place: Placement, row: int, nanoseconds: int) -> FrameTransforms:
    """The poses of all frames at one instant."""
    message = FrameTransforms()
    for frame, (origin, turn) in poses(place, row).items():
        added = message.transforms.add(parent_frame_id=WORLD, child_frame_id=frame)
        added.timestamp.FromNanoseconds(nanoseconds)
        added.translation.x, added.translation.y, added.translation.z = origin
        added.rotation.CopyFrom(_about_y(turn))
    return message


def scene_update(parts: Iterable[Solid]) -> SceneUpdate:
    """All solids: one entity for each frame, which moves with the frame and never expires."""
    entities: dict[str, SceneEntity] = {}
    for part in parts:
        entity = entities.setdefault(
            part.frame,
            SceneEntity(
                timestamp=Timestamp(), frame_id=part.frame, id=part.frame, frame_locked=True
            ),
        )
        _add(entity, part)
    return SceneUpdate(entities=entities.values())


def contact_update(motion: tuple[int, int], nanoseconds: int) -> SceneUpdate:
    """The contact points: green where they stick; yellow, with an arrow, where they slide."""
    message = SceneUpdate()
    for k, side in enumerate(SIDES):
        colour = _colour(ZERO if motion[k] == 0 else SLIDES)
        entity = message.entities.add(
            frame_id=f"{side}_contact", id=f"{side}_contact", frame_locked=True
        )
        entity.timestamp.FromNanoseconds(nanoseconds)
        ball = entity.spheres.add(color=colour, size=Vector3(x=0.012, y=0.012, z=0.012))
        ball.pose.orientation.w = 1.0
        if motion[k] != 0:
            outward = (-1, 1)[k] * motion[k] > 0  # along the frame's x, or against it
            turned = Quaternion(w=1.0) if outward else Quaternion(z=1.0)
            entity.arrows.add(
                pose=Pose(position=Vector3(), orientation=turned),
                color=colour,
                shaft_length=0.03,
                shaft_diameter=0.006,
                head_length=0.015,
                head_diameter=0.014,
            )
    return message


def ros_string(text: str) -> bytes:
    """A ROS 2 `std_msgs/msg/String`: CDR, little-endian; the length includes the closing zero."""
    data = text.encode() + b"\0"
    return b"\x00\x01\x00\x00" + struct.pack("<I", len(data)) + data


def _about_y(turn: float) -> Quaternion:
    """A rotation in the (x, z) plane from x towards z, which is about −y."""
    return Quaternion(y=-math.sin(turn / 2), w=math.cos(turn / 2))


def _colour(text: str) -> Color:
    red, green, blue = (part / 255 for part in parts_of(text))
    return Color(r=red, g=green, b=blue, a=1.0)


def _pose(centre: Vector, turn: Quaternion) -> Pose:
    return Pose(position=Vector3(x=centre[0], y=centre[1], z=centre[2]), orientation=turn)


def _add(entity: SceneEntity, part: Solid) -> None:
    shape, colour = part.shape, _colour(part.colour)
    if isinstance(shape, Box):
        size = Vector3(x=shape.size[0], y=shape.size[1], z=shape.size[2])
        entity.cubes.add(pose=_pose(shape.centre, _about_y(shape.turn)), size=size, color=colour)
    elif isinstance(shape, Cylinder):
        half = math.sqrt(0.5)  # foxglove's cylinders stand along z: turn them about x
        entity.cylinders.add(
            pose=_pose(shape.centre, Quaternion(x=half, w=half)),
            size=Vector3(x=2 * shape.radius, y=2 * shape.radius, z=shape.length),
            bottom_scale=1.0,
            top_scale=1.0,
            color=colour,
        )
    elif isinstance(shape, Ball):
        size = Vector3(x=2 * shape.radius, y=2 * shape.radius, z=2 * shape.radius)
        entity.spheres.add(pose=_pose((0.0, 0.0, 0.0), Quaternion(w=1.0)), size=size, color=colour)
    else:
        corners, faces = shape.mesh()
        points = (corners[i] for face in faces for i in face)
        entity.triangles.add(
            pose=_pose((0.0, 0.0, 0.0), Quaternion(w=1.0)),
            points=[Point3(x=x, y=y, z=z) for x, y, z in points],
            color=colour,
        )

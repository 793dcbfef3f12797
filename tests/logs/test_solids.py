# SPDX-License-Identifier: Apache-2.0
"""The three-dimensional scene of a log: closed solids, connected frames, one robot description."""

import math
import struct
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

import palmbots as pb
from palmbots import write_log
from palmbots.logs.robot_description import urdf
from palmbots.logs.scene_updates import ros_string, scene_update, transforms
from palmbots.scene.placement import placements
from palmbots.scene.spec import to_spec
from palmbots.viz.solids import Prism, contact_balls, solids

BOX = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0))
ARROW = ((0.0, 0.0), (2.0, 1.0), (4.0, 0.0), (2.0, 4.0))
ALONG = ((0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (0.0, 1.0))
COMB = (
    (0, 0),
    (5, 0),
    (5, 3),
    (4, 3),
    (4, 1),
    (3, 1),
    (3, 3),
    (2, 3),
    (2, 1),
    (1, 1),
    (1, 3),
    (0, 3),
)


def area(outline):
    pairs = zip(outline, (*outline[1:], outline[0]), strict=True)
    return sum(ax * by - bx * ay for (ax, ay), (bx, by) in pairs) / 2


@pytest.fixture(scope="module")
def done():
    return pb.carry("paper-offset", "distributed", seed=1, overrides={"task.distance_m": 0.3})


@pytest.mark.parametrize("outline", [BOX, ARROW, ALONG, COMB])
def test_prism_is_closed_and_faces_outward(outline):
    """Gauss: the volume under outward faces is area × depth only if all of them face outward."""
    corners, faces = Prism(outline, 0.5).mesh()
    a, b, c = np.array(corners)[np.array(faces).T]
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(area(outline) * 0.5)
    normals = np.cross(b - a, c - a)
    assert np.abs(normals.sum(axis=0)).max() < 1e-12


def test_every_solid_is_in_a_known_frame(done):
    spec = to_spec(done.scene)
    parts = solids(done.scene, spec)
    update = scene_update(parts)
    frames = {entity.frame_id for entity in update.entities}
    moving = transforms(placements(spec, done.trace, slice(0, 1)), 0, 0).transforms
    assert {t.parent_frame_id for t in moving} == {"world"}
    assert frames - {"world"} <= {t.child_frame_id for t in moving}
    assert all(entity.frame_locked for entity in update.entities)
    assert len({entity.id for entity in update.entities}) == len(update.entities)
    drawn = sum(
        len(e.cubes) + len(e.cylinders) + len(e.spheres) + len(e.triangles) for e in update.entities
    )
    assert drawn == len(parts)


def test_frames_stand_where_the_side_view_has_them(done):
    """Palm and object, moved by their transforms, meet at the contact points."""
    spec = to_spec(done.scene)
    place = placements(spec, done.trace, slice(None, None, 20))
    for row in range(len(place.turn)):
        message = transforms(place, row, 0)
        by_frame = {t.child_frame_id: t for t in message.transforms}

        def moved(frame, x, z, by_frame=by_frame):
            t = by_frame[frame]
            assert (t.rotation.x, t.rotation.z, t.translation.y) == (0, 0, 0)
            angle = -2 * math.atan2(t.rotation.y, t.rotation.w)
            cos, sin = math.cos(angle), math.sin(angle)
            return (t.translation.x + cos * x - sin * z, t.translation.z + sin * x + cos * z)

        for k, side in enumerate(("left", "right")):
            p = float(done.trace["contact"][20 * row, k])
            on_palm = moved(f"{side}_palm", (-1, 1)[k] * p, spec.palms[k].offset)
            assert on_palm == pytest.approx(place.contact[row, k], abs=1e-12)
            x, _, z, _ = spec.outline[0 if k == 0 else spec.contact_right]
            assert moved("object", x, z) == pytest.approx(on_palm, abs=1e-12)


def test_the_robot_description_is_one_tree(done):
    parts = [*solids(done.scene, to_spec(done.scene)), *contact_balls()]
    robot = ET.fromstring(urdf(parts))
    links = [link.get("name") for link in robot.findall("link")]
    children = [child.get("link") for child in robot.findall("joint/child")]
    parents = {parent.get("link") for parent in robot.findall("joint/parent")}
    assert links[0] == "world"
    assert children == links[1:]
    assert parents == {"world"}
    assert {"left_palm", "right_palm", "left_robot", "right_robot", "object"} <= set(links)
    shapes = {shape.tag for shape in robot.findall("link/visual/geometry/*")}
    assert shapes == {"box", "cylinder", "sphere"}


def test_ros_string_is_encoded_as_cdr():
    data = ros_string("θ")
    assert data[:4] == b"\x00\x01\x00\x00"
    (length,) = struct.unpack_from("<I", data, 4)
    assert data[8:] == "θ".encode() + b"\0"
    assert length == len(data) - 8


def test_the_log_holds_the_scene_in_foxglove_schemas(done, tmp_path):
    """The schemas are Foxglove's own, byte for byte, so that its viewer knows them."""
    write_log(done, tmp_path / "c.mcap")
    with open(tmp_path / "c.mcap", "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        topics = ["/solids", "/tf", "/contacts"]
        found = [(c.topic, s, r, m) for s, c, r, m in reader.iter_decoded_messages(topics=topics)]
    names = {topic: schema.name for topic, schema, _, _ in found if schema is not None}
    assert names["/solids"] == names["/contacts"] == SceneUpdate.DESCRIPTOR.full_name
    assert names["/tf"] == FrameTransforms.DESCRIPTOR.full_name
    motion = {
        round(float(t) * 1e9): m
        for t, m in zip(done.trace["time"], done.trace["motion"].to_numpy(), strict=True)
    }
    for topic, _, record, message in found:
        if topic == "/tf":
            assert {t.timestamp.ToNanoseconds() for t in message.transforms} == {record.log_time}
        if topic == "/contacts":
            slides = [len(entity.arrows) == 1 for entity in message.entities]
            assert slides == [value != 0 for value in motion[record.log_time]]

# SPDX-License-Identifier: Apache-2.0
"""Positions in the world frame, computed by hand and on real carries (docs/theory/notation.md)."""

import math

import numpy as np
import pytest

import palmbots as pb
from palmbots.scene.placement import floor_level, place, placements
from palmbots.scene.spec import to_spec


def one(spec, separation, palm, contact, turn=0.0):
    """The placement of one state with the midpoint at the origin."""
    return place(
        spec, separation=[separation], midpoint=[0.0], palm=[palm], contact=[contact], turn=[turn]
    )


def test_placement_of_a_level_box_by_hand():
    spec = to_spec(pb.load_scene("paper"))
    angle = math.radians(15)
    positions = one(spec, 0.25, (angle, angle), (0.0, 0.0))
    assert positions.pivot[0].tolist() == [[-0.125, 0], [0.125, 0]]
    assert positions.contact[0] == pytest.approx(positions.pivot[0])
    x, y = 0.075 * math.cos(angle), 0.075 * math.sin(angle)
    assert positions.palm_outer[0] == pytest.approx(np.array([[-0.125 - x, y], [0.125 + x, y]]))
    assert positions.palm_inner[0] == pytest.approx(np.array([[-0.125 + x, -y], [0.125 - x, -y]]))
    assert positions.palm_turn[0].tolist() == [-angle, angle]
    box = np.array([[-0.125, 0], [0.125, 0], [0.125, 0.16], [-0.125, 0.16]])
    assert positions.outline[0] == pytest.approx(box)
    assert positions.com[0] == pytest.approx([0, 0.04])


def test_pivot_offset_is_along_the_normal():
    spec = to_spec(pb.load_scene("paper-offset"))
    angle = math.radians(15)
    positions = one(spec, 0.25, (angle, angle), (0.0, 0.0))
    sin, cos = 0.01 * math.sin(angle), 0.01 * math.cos(angle)
    assert positions.contact[0] == pytest.approx(
        np.array([[-0.125 + sin, cos], [0.125 - sin, cos]])
    )


@pytest.mark.parametrize("scene", ["paper", "paper-offset"])
@pytest.mark.parametrize("controller", ["none", "distributed"])
def test_real_carries_close_the_loop(scene, controller):
    """Hung on its left contact, the object touches the right palm where the trace says."""
    result = pb.carry(scene, controller, seed=2, overrides={"task.distance_m": 0.5})
    assert result.trace is not None
    spec = to_spec(result.scene)
    positions = placements(spec, result.trace, slice(None))
    vertex = positions.outline[:, spec.contact_right]
    assert np.abs(vertex - positions.contact[:, 1]).max() < 1e-12
    assert np.abs(positions.outline[:, 0] - positions.contact[:, 0]).max() == 0
    apart = positions.pivot[:, 1, 0] - positions.pivot[:, 0, 0]
    assert apart == pytest.approx(result.trace["separation"].to_numpy(), abs=1e-15)


def test_placement_of_mirrored_state_is_mirrored():
    spec = to_spec(pb.load_scene("paper-offset"))
    angles, contacts = (0.1, 0.25), (0.02, -0.01)
    ours = one(spec, 0.26, angles, contacts, 0.0)
    theirs = one(spec, 0.26, angles[::-1], contacts[::-1], 0.0)
    for name in ("pivot", "palm_inner", "palm_outer", "contact"):
        mirrored = getattr(theirs, name)[:, ::-1] * [-1, 1]
        assert getattr(ours, name) == pytest.approx(mirrored, abs=1e-16), name


def test_floor_is_below_robots_and_object():
    box = to_spec(pb.load_scene("paper"))
    assert floor_level(box) == pytest.approx(-0.25)
    belly = [[0.0, 0.0], [0.1, -0.4], [0.25, 0.0], [0.25, 0.5], [0.0, 0.5]]
    hanging = {"vertices_m": belly, "contacts": [0, 2], "com_m": [0.125, 0.1]}
    assert floor_level(to_spec(pb.load_scene({"object": hanging}))) == pytest.approx(-0.45)

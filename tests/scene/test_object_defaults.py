# SPDX-License-Identifier: Apache-2.0
"""An outline of the user's own: its contacts, centre of mass and mass are those of the outline."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.scene.overrides import parse_overrides
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.variations import with_values

L_SHAPE = [[0, 0], [0.25, 0], [0.25, 0.06], [0.08, 0.06], [0.08, 0.25], [0, 0.25]]
U_SHAPE = [
    [0, 0], [0.3, 0], [0.3, 0.2], [0.29, 0.2], [0.29, 0.01], [0.01, 0.01], [0.01, 0.2], [0, 0.2],
]  # fmt: skip
TRAY = [
    [0, 0], [0.4, 0], [0.4, 0.05], [0.39, 0.05], [0.39, 0.005], [0.01, 0.005], [0.01, 0.05],
    [0, 0.05],
]  # fmt: skip
# A square frame, open at one point of its upper side, so that its outline is one polygon.
FRAME = [
    [0, 0], [0.3, 0], [0.3, 0.3], [0.151, 0.3], [0.151, 0.28], [0.28, 0.28], [0.28, 0.02],
    [0.02, 0.02], [0.02, 0.28], [0.149, 0.28], [0.149, 0.3], [0, 0.3],
]  # fmt: skip
STRIPS = [
    [0.0, 0.0], [0.01, 0.0], [0.01, 0.005], [0.24, 0.005], [0.24, 0.0], [0.25, 0.0],
    [0.25, 0.165], [0.0, 0.165],
]  # fmt: skip


def sampled_centroid(vertices: list) -> tuple[float, float, float]:
    """Area and centroid by counting the points of a fine grid that lie inside (even-odd rule)."""
    (left, low), (right, high) = np.min(vertices, axis=0), np.max(vertices, axis=0)
    n = 800
    x = left + (right - left) * (np.arange(n) + 0.5) / n
    y = low + (high - low) * (np.arange(n) + 0.5) / n
    px, py = np.meshgrid(x, y)
    inside = np.zeros_like(px, dtype=bool)
    for (ax, ay), (bx, by) in zip(vertices, [*vertices[1:], vertices[0]], strict=True):
        if ay != by:
            crosses = ((ay > py) != (by > py)) & (px < ax + (py - ay) / (by - ay) * (bx - ax))
            inside ^= crosses
    area = (right - left) * (high - low) * inside.mean()
    return area, px[inside].mean(), py[inside].mean()


@pytest.mark.parametrize("vertices", [L_SHAPE, U_SHAPE, TRAY, FRAME, STRIPS])
@pytest.mark.parametrize("is_clockwise", [False, True])
def test_outline_alone_describes_a_uniform_body(vertices: list, is_clockwise: bool) -> None:
    vertices = vertices[::-1] if is_clockwise else vertices
    area, x, y = sampled_centroid(vertices)
    item = load_scene({"object": {"vertices_m": vertices, "depth_m": 0.2}}).object
    assert item.com_m == pytest.approx((x, y), abs=1e-3)
    assert item.mass_kg == pytest.approx(125 * area * 0.2, rel=0.02)
    left, right = (vertices[k] for k in item.contacts)
    assert left == [0, 0]
    assert right == [max(x for x, y in vertices if y == 0), 0]


def test_60_cm_box_has_its_own_com_and_is_delivered() -> None:
    vertices = [[0, 0], [0.60, 0], [0.60, 0.16], [0, 0.16]]
    scene = load_scene({"object": {"vertices_m": vertices}})
    assert scene.object.com_m == (0.3, 0.08)
    assert scene.object.mass_kg == pytest.approx(1.2)
    assert pb.carry(scene, record=False).outcome == "delivered"


def test_override_of_the_outline_alone_is_the_same(tmp_path: Path) -> None:
    wanted = load_scene({"object": {"vertices_m": U_SHAPE}})
    text = f"object.vertices_m={U_SHAPE}"
    assert load_scene("paper", {"object.vertices_m": U_SHAPE}) == wanted
    assert load_scene("paper", {"object": {"vertices_m": U_SHAPE}}) == wanted
    assert load_scene(Scene(), parse_overrides([text]), called="--set") == wanted
    assert load_scene("paper", {"object": "tray", "object.vertices_m": U_SHAPE}).object == (
        wanted.object
    )
    file = tmp_path / "u.toml"
    file.write_text(text)
    assert load_scene(file) == wanted


def test_keys_given_beside_the_outline_are_kept() -> None:
    given: dict[str, Any] = {"com_m": [0.1, 0.02], "mass_kg": 2.0, "contacts": [0, 1]}
    for key, value in given.items():
        changed = load_scene("paper", {"object.vertices_m": L_SHAPE, f"object.{key}": value})
        assert changed.object.model_dump()[key] == (tuple(value) if key != "mass_kg" else 2.0)
        assert changed.object.model_dump() | {key: 0} == (
            load_scene({"object": {"vertices_m": L_SHAPE}}).object.model_dump() | {key: 0}
        )


def test_other_overrides_leave_the_object_alone() -> None:
    scene = load_scene({"object": {"vertices_m": L_SHAPE, "com_m": [0.12, 0.03]}})
    assert load_scene(scene, {"object.depth_m": 0.3}).object.com_m == (0.12, 0.03)
    assert load_scene({"object": {"depth_m": 0.3}}).object.mass_kg == 0.5
    moved = with_values(scene, ["object.vertices_m[4]"], [[0.08, 0.3]], called="sweep:")
    assert moved.object.com_m == (0.12, 0.03)


def test_default_box_is_unchanged() -> None:
    assert Scene().object.com_m == (0.125, 0.04) and Scene().object.mass_kg == 0.5
    assert load_scene({"object": {}}) == load_scene("paper") == Scene()


@pytest.mark.parametrize("vertices", [L_SHAPE, U_SHAPE, TRAY, FRAME])
def test_com_outside_the_material_is_carried_by_every_part(vertices: list, tmp_path: Path) -> None:
    scene = load_scene(
        {"object": {"vertices_m": vertices}, "task": {"distance_m": 0.2}, "palm": {"friction": 0.4}}
    )
    carry = pb.carry(scene, seed=1)
    assert carry.outcome == "delivered"
    pb.write_log(carry, tmp_path / "carry.mcap")
    assert pb.replay(tmp_path / "carry.mcap").identical
    assert pb.contact_modes(scene).feasible
    assert pb.analyze(scene).summary()
    assert pb.load_scene(scene.model_dump()) == scene


@pytest.mark.parametrize("vertices", [L_SHAPE, FRAME])
def test_mujoco_inertia_of_an_outline_is_that_of_its_material(vertices: list) -> None:
    """Against the sum over random points inside the outline (Monte Carlo, fixed seed)."""
    from palmbots.mujoco.engine import mujoco
    from palmbots.mujoco.mjcf import mjcf

    scene = load_scene({"object": {"vertices_m": vertices}})
    model = mujoco().MjModel.from_xml_string(mjcf(scene))
    body = model.body("object")
    _, cx, cy = sampled_centroid(vertices)
    x, y = np.random.default_rng(3).uniform(0, np.max(vertices, axis=0), (100_000, 2)).T
    inside = np.zeros(len(x), bool)
    for (ax, ay), (bx, by) in zip(vertices, [*vertices[1:], vertices[0]], strict=True):
        if ay != by:  # a ray to the right crosses this edge
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
    assert inside.sum() > 20_000
    square = (x - cx) ** 2 + (y - cy) ** 2
    about_y = scene.object.mass_kg * float(square[inside].mean())
    assert min(abs(body.inertia - about_y)) < 0.02 * about_y
    assert body.ipos == pytest.approx([cx, 0, cy], abs=5e-4)


def test_box_and_closed_ring_are_outlines() -> None:
    ring = [[0, 0], [0.4, 0], [0.4, 0.2], [0, 0.2]]
    wanted = load_scene({"object": {"vertices_m": ring}})
    assert load_scene({"object": {"box_m": [0.4, 0.2]}}) == wanted
    assert load_scene({"object": {"vertices_m": [*ring, ring[0]]}}) == wanted
    # Over an object of its own, in either direction: the later one counts, and brings its COM.
    tray = load_scene("paper", {"object": "tray", "object.depth_m": 0.1})
    assert load_scene(tray, {"object.box_m": [0.4, 0.2]}).object == wanted.object
    boxed = {"object": {"box_m": [0.3, 0.1]}}
    assert load_scene(boxed, {"object.vertices_m": ring}).object == wanted.object


def test_com_of_the_papers_box_in_another_outline_is_named() -> None:
    """`init scene` states it; an outline that is edited there keeps it."""
    found = pb.carry(
        {
            "object": {
                "vertices_m": [[0, 0], [0.4, 0], [0.4, 0.2], [0, 0.2]],
                "com_m": [0.125, 0.04],
            }
        },
        record=False,
    )
    assert any("object.com_m is [0.125, 0.04]" in line for line in found.warnings)
    assert not any("object.com_m" in line for line in pb.carry(record=False).warnings)

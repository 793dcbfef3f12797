# SPDX-License-Identifier: Apache-2.0
"""The MJCF of a scene: masses, inertias, places, contacts."""

import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.mjcf import layout, mjcf, steps_per_tick
from palmbots.scene.extrusion import gyration, triangles
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec

OBJECTS = sorted(pb.object_names())
mj = mujoco()


def compiled(scene: Scene) -> tuple[Any, Any]:
    model: Any = mj.MjModel.from_xml_string(mjcf(scene))
    data: Any = mj.MjData(model)
    mj.mj_forward(model, data)
    return model, data


def area(points: list[tuple[float, float]]) -> float:
    x, z = np.array(points).T
    return 0.5 * float(x @ np.roll(z, -1) - z @ np.roll(x, -1))


@pytest.mark.parametrize("name", OBJECTS)
def test_triangles_fill_the_outline_and_nothing_else(name: str) -> None:
    spec = to_spec(load_scene("paper", {"object": name}))
    outline = [(x, y) for x, _, y, _ in spec.outline]
    pieces = [area([outline[i] for i in piece]) for piece in triangles(outline)]
    assert len(pieces) == len(outline) - 2
    assert min(pieces) > 0  # every one counter-clockwise
    assert sum(pieces) == pytest.approx(area(outline), rel=1e-12)


def test_triangles_of_an_outline_with_straight_corners() -> None:
    outline = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]
    assert sum(area([outline[i] for i in t]) for t in triangles(outline)) == pytest.approx(2.0)


def test_inertia_is_that_of_boxes_put_together() -> None:
    """The L-shape is two boxes, whose inertia MuJoCo knows itself."""
    thing = load_scene("paper", {"object": "l-shape"}).object
    base, tower, depth = (0.25, 0.08), (0.10, 0.06), thing.depth_m
    areas = [base[0] * base[1], tower[0] * tower[1]]
    masses = [thing.mass_kg * a / sum(areas) for a in areas]
    boxes: Any = mj.MjModel.from_xml_string(
        f"""<mujoco><worldbody><body><freejoint/>
        <geom type="box" size="{base[0] / 2} {depth / 2} {base[1] / 2}"
          pos="{base[0] / 2} 0 {base[1] / 2}" mass="{masses[0]}"/>
        <geom type="box" size="{tower[0] / 2} {depth / 2} {tower[1] / 2}"
          pos="{tower[0] / 2} 0 {base[1] + tower[1] / 2}" mass="{masses[1]}"/>
        </body></worldbody></mujoco>"""
    )
    model, _ = compiled(load_scene("paper", {"object": "l-shape"}))
    body = model.body("object")
    assert body.mass[0] == pytest.approx(thing.mass_kg)
    assert sorted(body.inertia) == pytest.approx(sorted(boxes.body_inertia[1]), rel=1e-6)
    # The axes too: the middle one is y, and the others are turned alike.
    turned, other = np.empty(9), np.empty(9)
    mj.mju_quat2Mat(turned, body.iquat)
    mj.mju_quat2Mat(other, boxes.body_iquat[1])
    whole = turned.reshape(3, 3) @ np.diag(body.inertia) @ turned.reshape(3, 3).T
    parts = other.reshape(3, 3) @ np.diag(boxes.body_inertia[1]) @ other.reshape(3, 3).T
    assert whole == pytest.approx(parts, rel=1e-6, abs=1e-9)


def test_gyration_of_a_rectangle_far_from_the_origin() -> None:
    rectangle = [(100.0, 50.0), (100.3, 50.0), (100.3, 50.2), (100.0, 50.2)]
    found = gyration(rectangle, 0.1)
    wide, high, deep = 0.3**2 / 12, 0.2**2 / 12, 0.1**2 / 12
    assert (found.xx, found.yy, found.zz) == pytest.approx(
        (deep + high, wide + high, wide + deep), rel=1e-9
    )
    assert found.xz == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", ["paper", "paper-offset", "figure8"])
def test_it_starts_where_the_quasistatic_world_does(name: str) -> None:
    scene = load_scene(name, {"start.left_m": 0.021, "start.right_m": -0.013})
    model, data = compiled(scene)
    spec, at = to_spec(scene), layout(scene)
    foot = at.spec.contact_right
    for k, (side, sense, vertex) in enumerate((("left", -1, 0), ("right", 1, foot))):
        palm = data.body(f"{side}_palm")
        mat = palm.xmat.reshape(3, 3)
        assert sense * math.atan2(mat[2, 0], mat[0, 0]) == pytest.approx(spec.palms[k].steep)
        for end in ("near", "far"):
            ball = data.geom(f"vertex_{vertex}_{end}").xpos - palm.xpos
            assert sense * mat[:, 0] @ ball == pytest.approx(spec.start[k], abs=1e-9)
            assert mat[:, 2] @ ball == pytest.approx(spec.palms[k].offset, abs=1e-9)
    # Each vertex touches its palm as near as no matter, and nothing else touches.
    touching = {
        frozenset((model.geom(c.geom1).name, model.geom(c.geom2).name)) for c in data.contact
    }
    for c in data.contact:
        assert abs(c.dist) < 1e-6
    assert {pair for pair in touching if "floor" not in pair} <= {
        frozenset((f"{side}_palm", f"vertex_{vertex}_{end}"))
        for side, vertex in (("left", 0), ("right", foot))
        for end in ("near", "far")
    }


def test_masses_are_the_scenes() -> None:
    scene = load_scene("paper", {"mujoco.body_kg": 2.5, "mujoco.palm_kg": 0.07})
    model, _ = compiled(scene)
    for side in ("left", "right"):
        assert model.body(f"{side}_body").subtreemass[0] == pytest.approx(2.5 + 0.2 + 0.07)
    assert model.body_subtreemass[0] == pytest.approx(2 * 2.77 + 0.5)


def test_slope_rotates_gravity_and_backward_travel_mirrors_it() -> None:
    for direction, sense in (("forward", 1.0), ("backward", -1.0)):
        scene = load_scene("paper", {"task.slope_deg": 3.0, "task.direction": direction})
        gravity = compiled(scene)[0].opt.gravity
        assert np.linalg.norm(gravity) == pytest.approx(9.80665)
        assert gravity[0] / gravity[2] == pytest.approx(sense * math.tan(math.radians(3.0)))


def test_ridges_have_the_height_and_length_of_the_scene() -> None:
    scene = load_scene(
        "paper", {"mujoco.ridges": [{"at_m": 0.4, "height_m": 0.004, "length_m": 0.06}]}
    )
    model, data = compiled(scene)
    top = data.geom("ridge_1").xpos[2] + model.geom("ridge_1").size[0]
    assert top == pytest.approx(0.004)
    assert data.geom("ridge_1").xpos[0] == pytest.approx(0.4)
    half = math.sqrt(model.geom("ridge_1").size[0] ** 2 - data.geom("ridge_1").xpos[2] ** 2)
    assert 2 * half == pytest.approx(0.06)


@pytest.mark.parametrize(
    ("period", "step", "steps"), [(0.01, 0.001, 10), (0.01, 0.003, 4), (0.0005, 0.001, 1)]
)
def test_control_periods_are_whole_steps(period: float, step: float, steps: int) -> None:
    scene = load_scene("paper", {"control.period_s": period, "mujoco.step_s": step})
    assert steps_per_tick(scene) == steps
    assert compiled(scene)[0].opt.timestep * steps == pytest.approx(period)

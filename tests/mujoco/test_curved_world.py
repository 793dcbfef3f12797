# SPDX-License-Identifier: Apache-2.0
"""The dynamic world on curved paths: robots on their line, the object on askew palms, lips."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.logs.replaying import replay
from palmbots.mujoco.curved_world import CurvedWorld, world_of
from palmbots.mujoco.world import MujocoWorld
from palmbots.scene.scene import Scene, load_scene

STEEP = (math.radians(15), math.radians(15))


def scene_with(**keys: Any) -> Scene:
    path = {f"task.path.{k}": v for k, v in ({"kind": "arc", "radius_m": 1.0} | keys).items()}
    return load_scene("paper", path)


def driven(world: MujocoWorld, seconds: float, speed: float = 0.06) -> None:
    for _ in range(round(seconds / world.scene.control.period_s)):
        world.move((speed, speed), STEEP)


def in_circle(scene: Scene, seconds: float = 7.0) -> CurvedWorld:
    world = CurvedWorld(scene)
    driven(world, seconds)
    return world


@pytest.mark.parametrize(("turn", "axle"), [("left", None), ("right", 0.2)])
def test_axles_keep_to_the_circle(turn: str, axle: float | None) -> None:
    scene = load_scene(scene_with(turn=turn), {"mujoco.axle_m": axle})
    world = in_circle(scene, 12.0 if axle is None else 20.0)
    line, side = world.line, 1 if turn == "left" else -1
    # The circle that the clothoid leads to: its centre by the path's own middle of the arc.
    spot = line.at(0.8)  # on the circle, in both cases
    centre = np.array([spot.x, spot.y]) + side * np.array(
        [-math.sin(spot.heading), math.cos(spot.heading)]
    )
    for k, name in enumerate(("left", "right")):
        wheels = [world.data.body(f"{name}_{w}").xpos[:2] for w in ("port", "starboard")]
        assert math.dist(np.mean(wheels, axis=0), centre) == pytest.approx(1.0, abs=1e-3)
        radial = np.mean(wheels, axis=0) - centre
        ahead = side * np.array([-radial[1], radial[0]])
        yaw = world._yaw(k)
        assert math.atan2(ahead[1], ahead[0]) == pytest.approx(yaw, abs=math.radians(0.3))


def test_robots_follow_the_path_at_the_commanded_speed() -> None:
    world = in_circle(scene_with(radius_m=0.6))
    before = world.advance
    driven(world, 3.0)
    assert (world.advance - before) / 3.0 == pytest.approx(0.06, rel=0.003)
    apart = world._separation(world._distances())
    distances = world._distances()
    assert apart == pytest.approx(
        2 * 0.6 * math.sin((distances[1] - distances[0]) / 2 / 0.6), rel=1e-3
    )


@pytest.mark.parametrize("radius", [2.0, 1.0, 0.5])
def test_the_object_rolls_as_both_palms_ask(radius: float) -> None:
    """tan ρ = tan θ sin β, sin β = d / 2 R: the inner side of the object is the higher one."""
    world = in_circle(scene_with(radius_m=radius), 8.0)
    mat = world.data.body("object").xmat.reshape(3, 3)
    roll = math.asin(mat[2, 1])
    wanted = math.atan(math.tan(STEEP[0]) * 0.125 / radius)
    assert roll == pytest.approx(wanted, rel=0.12)


def test_change_of_curvature_shifts_the_object_backward() -> None:
    """Up to width × d × |Δκ| / 4 for contacts that do not give; seen is about 0.63 of it."""
    scene = load_scene(scene_with(angle_deg=40.0), {"robot.noise_m_s": 0.0})
    done = pb.carry(scene, "none", world="mujoco", overrides={"task.distance_m": 0.6})
    assert done.trace is not None
    left, right = done.trace["contact"].to_numpy()[-1]
    most = 0.07 * 0.25 * 1.0 / 4
    assert 0.5 * most < left < most and -most < right < -0.5 * most


@pytest.mark.slow
@pytest.mark.parametrize("mirrored", [False, True])
def test_it_drifts_outward_and_the_mirror_image_likewise(mirrored: bool) -> None:
    scene = load_scene(scene_with(), {"task.distance_m": 0.9})
    done = pb.carry(scene.mirrored() if mirrored else scene, world="mujoco", seed=1)
    assert done.outcome == "delivered" and done.trace is not None
    # Travelling towards −x a turn to the left is seen from the other side: the centre lies at +y
    # of a path that leads back, so that outward is −y of the palms in both.
    across = done.trace["lateral"].to_numpy()[-1]
    assert across.max() < -4e-3
    x, y = (done.trace[f"pivot_{n}"].to_numpy()[-1].mean() for n in "xy")
    assert (x < 0) == mirrored and y > 0.1


def test_lateral_coordinate_is_zero_on_a_straight_path(monkeypatch: pytest.MonkeyPatch) -> None:
    done = pb.carry("paper", world="mujoco", overrides={"task.distance_m": 0.1})
    assert type(world_of(done.scene)) is MujocoWorld
    assert done.trace is not None
    assert float(np.abs(done.trace["lateral"]).max()) < 1e-9
    assert done.lateral_peak_m is not None
    assert done.lateral_peak_m.values() == pytest.approx((0.0, 0.0), abs=1e-9)


def shifted(world: CurvedWorld, aside: float) -> None:
    """Put the object aside, as it is turned."""
    at = int(world.model.joint("object").qposadr[0])
    yaw = 0.5 * (world._yaw(0) + world._yaw(1))
    world.data.qpos[at] -= aside * math.sin(yaw)
    world.data.qpos[at + 1] += aside * math.cos(yaw)


@pytest.mark.parametrize("aside", [-0.03, -0.01, 0.0, 0.02])
def test_edges_touch_where_they_lie_on_the_palm(aside: float) -> None:
    """An object 100 mm deep on palms of 70 mm: what lies on the palm is all of its width, or less
    where an end of the object comes in from the side."""
    world = CurvedWorld(scene_with())
    shifted(world, aside)
    driven(world, 0.1, 0.0)
    assert world.lateral == pytest.approx((aside, aside), abs=1e-3)
    for k, side in enumerate(("left", "right")):
        vertex = (0, world.layout.spec.contact_right)[k]
        ends = [
            world._in_palm_frame(k, world.data.geom(f"vertex_{vertex}_{end}").xpos.tolist())[1]
            for end in ("near", "far")
        ]
        wanted = [max(-0.0343, -0.049 + aside), min(0.0343, 0.049 + aside)]
        assert ends == pytest.approx(wanted, abs=5e-4), side


def test_beyond_the_palms_side_it_falls() -> None:
    world = CurvedWorld(scene_with())
    world.sight()
    shifted(world, 0.036)
    driven(world, 0.01, 0.0)
    assert world._end(world.contacts, (True, True)) == "off-palm"
    near = CurvedWorld(scene_with())
    shifted(near, 0.034)
    driven(near, 0.3, 0.0)
    assert near._end(near.contacts, (True, True)) == ""


@pytest.mark.slow
@pytest.mark.parametrize("height", [0.03, 0.0])
def test_lips_stop_the_drift(height: float) -> None:
    lips = {"palm.lip_height_m": height, "palm.lip_clearance_m": 0.008, "task.distance_m": 1.0}
    if height == 0.0:
        lips["palm.width_m"] = 0.116  # as wide as with lips
    done = pb.carry(load_scene(scene_with(radius_m=0.7), lips), world="mujoco", seed=1)
    assert done.outcome == "delivered" and done.lateral_peak_m is not None
    peak = max(map(abs, done.lateral_peak_m.values()))
    assert (peak == pytest.approx(0.008, abs=1.5e-3)) == (height > 0)
    assert height > 0 or peak > 0.0105


def test_lips_are_no_switches() -> None:
    """Pressed against a lip from the side, no sensor feels more than the weight."""
    scene = load_scene(scene_with(), {"palm.lip_height_m": 0.03, "palm.lip_clearance_m": 0.01})
    world = CurvedWorld(scene)
    shifted(world, 0.0102)
    driven(world, 0.2, 0.0)
    touching = {
        str(world.model.geom(int(g)).name) for i in range(world.data.ncon)
        for g in world.data.contact[i].geom
    }  # fmt: skip
    assert any("_lip_" in name for name in touching)
    world.sight()
    angle = math.radians(15)
    up = sum(
        f * math.cos(angle) - d * math.sin(angle)
        for f, d in zip(world.measured.force, world.measured.friction_force, strict=True)
    )
    assert up == pytest.approx(0.5 * 9.80665, rel=0.05)


@pytest.mark.parametrize("controller", ["centralized", "resilient"])
def test_controllers_are_unchanged(controller: str) -> None:
    scene = load_scene(scene_with(radius_m=2.0), {"task.distance_m": 0.6})
    done = pb.carry(scene, controller, world="mujoco", seed=2, record=False)
    assert done.outcome == "delivered"


def test_curved_carry_replays_bit_for_bit(tmp_path: Path) -> None:
    points = {"task.path.waypoints_m": [[0, 0], [0.4, 0.02], [0.8, 0.2]], "task.distance_m": 0.3}
    done = pb.carry("paper", world="mujoco", seed=4, overrides=points)
    pb.write_log(done, tmp_path / "carry.mcap")
    again = replay(tmp_path / "carry.mcap")
    assert again.identical, again.difference
    assert again.log.lateral_peak_m == done.lateral_peak_m


@pytest.mark.parametrize(("controller", "turn"), [("silent", "left"), ("shared-sign", "right")])
def test_controllers_that_use_signs_carry_along_an_arc(controller: str, turn: str) -> None:
    """They know nothing of the path: their palms still bring the contacts back."""
    scene = load_scene(scene_with(turn=turn), {"task.distance_m": 0.5, "robot.noise_m_s": 0.01})
    run = pb.carry(scene, controller, world="mujoco", seed=1, record=False)
    assert run.outcome == "delivered"
    assert max(run.contact_peak_m.values()) < 0.03
    assert run.lateral_peak_m is not None
    assert max(run.lateral_peak_m.values()) < scene.palm.width_m / 2

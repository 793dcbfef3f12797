# SPDX-License-Identifier: Apache-2.0
"""The dynamic world at rest and in motion, against statics and what was commanded."""

import math
from pathlib import Path

import pytest

import palmbots as pb
from palmbots._types import SIDES
from palmbots.mujoco.world import MujocoWorld
from palmbots.scene.scene import Scene, load_scene

STEEP = (math.radians(15), math.radians(15))


def world_of(changes: dict[str, object] | None = None) -> MujocoWorld:
    return MujocoWorld(load_scene("paper", changes))


@pytest.mark.parametrize("name", sorted(pb.object_names()))
def test_at_rest_the_palms_bear_the_weight_within_the_friction_cones(name: str) -> None:
    world = world_of({"object": name})
    world.sight()
    measured, scene = world.measured, world.scene
    up = 0.0
    for k, side in enumerate(SIDES):
        palm = scene.palm_of(side)
        angle = world.wrists()[k]
        up += measured.force[k] * math.cos(angle) - measured.friction_force[k] * math.sin(angle)
        assert abs(measured.friction_force[k]) <= palm.friction * measured.force[k] * 1.001
    assert up == pytest.approx(scene.object.mass_kg * 9.80665, rel=0.01)


def test_at_rest_the_palms_stand_at_their_angles() -> None:
    world = world_of()
    sight = world.sight()
    assert sight is not None
    assert world.wrists() == pytest.approx(STEEP, abs=math.radians(0.02))
    left, right = (world.data.body(f"{s}_palm").xmat.reshape(3, 3) for s in ("left", "right"))
    for mat, sense in ((left, -1), (right, 1)):
        assert sense * math.atan2(mat[2, 0], mat[0, 0]) == pytest.approx(STEEP[0], abs=1e-3)


def driven(world: MujocoWorld, speed: float, seconds: float) -> None:
    for _ in range(round(seconds / world.scene.control.period_s)):
        world.move((speed, speed), STEEP)
        world.sight()


def test_robots_drive_at_the_commanded_speed() -> None:
    world = world_of()
    driven(world, 0.06, 1.0)
    before = world.advance
    driven(world, 0.06, 2.0)
    assert (world.advance - before) / 2.0 == pytest.approx(0.06, rel=0.002)
    assert world.measured.wheel_slip == pytest.approx(
        (0.0, 0.0), abs=3e-4
    )  # 0.3 % of radius is dent


def test_unequal_wheels_do_not_lead_astray() -> None:
    """A mismatch of 4 % would turn a robot by 0.04 · 0.3 m / 0.22 m = 3° on its way of 0.3 m."""
    world = world_of({"mujoco.wheel_radius_mismatch": 0.04})
    driven(world, 0.06, 5.0)
    assert 0.0 < max(map(abs, world.measured.yaw)) < math.radians(0.3)


def test_object_that_moves_sideways_keeps_its_support() -> None:
    """Wheels that differ by a tenth shift the object by 0.8 mm across palms that it overlaps by
    15 mm on either side."""
    keys = {"mujoco.wheel_radius_mismatch": 0.1, "task.distance_m": 0.3}
    done = pb.carry("paper", world="mujoco", seed=0, overrides=keys)
    assert done.outcome == "delivered" and done.lateral_peak_m is not None
    assert 4e-4 < max(map(abs, done.lateral_peak_m.values())) < 2e-3
    assert done.trace is not None and float(done.trace["vertex_height"].min()) > -2e-3
    even = pb.carry("paper", world="mujoco", seed=0, overrides={"task.distance_m": 0.3})
    for side in SIDES:
        assert done.contact_peak_m[side] == pytest.approx(even.contact_peak_m[side], abs=1e-3)


def test_wheels_slip_on_ice() -> None:
    world = world_of({"mujoco.floor_friction": 0.005})
    driven(world, 0.2, 0.5)
    assert world.advance < 0.5 * 0.2 * 0.5
    assert min(world.measured.wheel_slip) > 0.05


def test_robots_on_a_slope_neither_roll_nor_lag() -> None:
    world = world_of({"task.slope_deg": 5.0})
    before = world.advance
    for _ in range(200):
        world.move((0.0, 0.0), STEEP)
    assert world.advance - before == pytest.approx(0.0, abs=2e-4)


def test_ridge_pitches_each_robot_once_per_wheel() -> None:
    world = world_of({"mujoco.ridges": [{"at_m": 0.4, "height_m": 0.003, "length_m": 0.05}]})
    pitches = []
    for _ in range(850):
        world.move((0.1, 0.1), STEEP)
        world.sight()
        pitches.append(world.measured.pitch)
    for k in (0, 1):
        tilt = [p[k] for p in pitches]
        # 3 mm over the 12 cm between wheels and caster, one way and then the other.
        assert max(tilt) == pytest.approx(0.003 / 0.12, rel=0.15)
        assert min(tilt) == pytest.approx(-0.003 / 0.12, rel=0.15)


def test_unstable_simulation_is_refused_and_leaves_no_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    world = world_of()
    world.data.qvel[0] = 1e12
    with pytest.raises(pb.PalmbotsError, match=r"unstable at 0.01 s; allowed: a smaller mujoco"):
        world.move((0.0, 0.0), STEEP)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("step", [0.0005, 0.001, 0.002, 0.005])
def test_no_grip_and_no_load_do_not_let_motors_run_away(step: float) -> None:
    """Explicit servos: on ice, and with the object far away, everything stays calm at any step."""
    world = world_of({"mujoco.step_s": step, "mujoco.floor_friction": 0.001})
    at = world.model.joint("object").qposadr[0]
    world.data.qpos[at + 2] += 1.0
    for tick in range(20):
        world.move((0.2, 0.2), (STEEP[0] - 0.002 * tick, STEEP[1]))
    assert abs(world.data.qvel[:6]).max() < 0.3
    wheels = [
        world.data.joint(f"{s}_{w}").qvel[0]
        for s in ("left", "right")
        for w in ("port", "starboard")
    ]
    assert max(map(abs, wheels)) < 1.5 * 0.2 / 0.04
    assert world.wrists()[0] == pytest.approx(STEEP[0] - 0.038, abs=0.01)


def test_released_object_is_reported() -> None:
    apart = world_of()
    ends = []
    for _ in range(300):
        apart.move((-0.2, 0.2), STEEP)
        ends.append(apart._end(apart.contacts, (True, True)))
    assert "off-palm" in ends
    gone = world_of()
    reasons = [gone._end((0.0, 0.0), (True, False)) for _ in range(30)]
    assert reasons[20] == "" and reasons[29] == "lifting"


def test_light_pressure_closes_no_switch() -> None:
    assert signs({"start.left_m": 0.03, "mujoco.switch_force_n": 0.1}) == {1}
    assert signs({"start.left_m": 0.03, "mujoco.switch_force_n": 100.0}) == {0}


def test_force_below_the_switch_limit_gives_a_warning_and_no_drop() -> None:
    keys = {"mujoco.switch_force_n": 100.0, "task.distance_m": 0.1}
    done = pb.carry("paper", world="mujoco", record=False, overrides=keys)
    assert (done.outcome, done.corrections) == ("delivered", ())
    assert [w.split(";")[0] for w in done.warnings] == [
        f"the {side} palm carries 2.4 N at the start, less than mujoco.switch_force_n = 100: its "
        "switches stay open and report 0"
        for side in SIDES
    ]


def signs(changes: dict[str, object]) -> set[int]:
    scene = load_scene("paper", {"robot.noise_m_s": 0.0, "task.timeout_s": 0.2} | changes)
    done = pb.carry(scene, "none", world="mujoco")
    assert done.trace is not None
    return set(done.trace["sign"].sel(side="left").to_numpy().tolist())


def test_the_world_is_the_same_seen_from_the_other_side() -> None:
    """A mirrored start gives the mirrored motion, up to the solver's tolerance."""
    scene = Scene()
    one = MujocoWorld(load_scene(scene, {"start.left_m": 0.02, "start.right_m": -0.01}))
    two = MujocoWorld(load_scene(scene, {"start.left_m": -0.01, "start.right_m": 0.02}))
    for _ in range(60):
        one.move((0.02, -0.03), (STEEP[0], math.radians(10)))
        two.move((0.03, -0.02), (math.radians(10), STEEP[1]))
    assert one.contacts == pytest.approx(two.contacts[::-1], abs=2e-5)
    assert abs(one.contacts[1] + 0.01) > 0.02  # it has moved

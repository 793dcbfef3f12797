# SPDX-License-Identifier: Apache-2.0
"""Which side, which sign, which number: what symmetric scenes cannot distinguish.

Every state here is put together by hand, so that its answer is known without the dynamic world.
"""

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from palmbots._types import SIDES
from palmbots.mujoco import film
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.mjcf import mjcf
from palmbots.mujoco.trace_columns import COLUMNS
from palmbots.mujoco.world import MujocoWorld
from palmbots.scene.robot_dimensions import BODY_SIZE, PALM_THICKNESS
from palmbots.scene.scene import Scene, load_scene

mj = mujoco()
STEEP = (math.radians(15), math.radians(15))


def compiled(changes: dict[str, Any]) -> Any:
    return mj.MjModel.from_xml_string(mjcf(load_scene("paper", changes)))


def world_of(changes: dict[str, Any] | None = None) -> MujocoWorld:
    return MujocoWorld(load_scene("paper", changes))


# --- the model ----------------------------------------------------------------------------------


def test_every_contact_has_its_own_palm_s_friction() -> None:
    """Palms, palm ends and both lips; wheels have the floor's, casters none."""
    keys = {
        "palm.left.friction": 0.25,
        "palm.right.friction": 0.45,
        "palm.lip_height_m": 0.03,
        "mujoco.floor_friction": 0.7,
    }
    m = compiled(keys)
    seen: dict[str, set[float]] = {}
    for pair in range(m.npair):
        names = [m.geom(int(g[pair])).name for g in (m.pair_geom1, m.pair_geom2)]
        own = next(name for name in names if name.startswith(SIDES))
        friction = float(m.pair_friction[pair, 0]) if m.pair_dim[pair] > 1 else 0.0
        seen.setdefault(own, set()).add(friction)
    wanted = {}
    for side, friction in (("left", 0.25), ("right", 0.45)):
        ends = [f"{end}_{y}" for end in ("inner", "outer") for y in ("near", "far")]
        for name in ("palm", *ends, "lip_port", "lip_starboard"):
            wanted[f"{side}_{name}"] = {friction}
        wanted |= {f"{side}_port": {0.7}, f"{side}_starboard": {0.7}, f"{side}_caster": {0.0}}
    assert seen == wanted


def test_contacts_are_as_soft_as_documented() -> None:
    """docs/reference/mujoco-agreement.md, Contacts that hold."""
    m = compiled({})
    assert m.opt.impratio == 150 and m.opt.cone == mj.mjtCone.mjCONE_ELLIPTIC
    assert m.opt.timestep == pytest.approx(0.002)
    for pair in range(m.npair):
        names = {m.geom(int(g[pair])).name for g in (m.pair_geom1, m.pair_geom2)}
        assert m.pair_solref[pair].tolist() == [0.02, 1.0]
        if "floor" not in names:
            assert m.pair_solimp[pair, :2].tolist() == [0.8, 0.8]


def test_robots_weigh_like_the_boxes_and_discs_they_are() -> None:
    """MuJoCo's own inertia of a box and of a cylinder, of the scene's masses."""
    keys = {"mujoco.body_kg": 2.5, "mujoco.palm_kg": 0.07, "mujoco.wheel_radius_m": 0.05}
    m = compiled(keys)
    palm = Scene().palm_of("left")
    half = BODY_SIZE / 2
    plate = (palm.length_m / 2, palm.width_m / 2, PALM_THICKNESS / 2)
    known: Any = mj.MjModel.from_xml_string(
        f"""<mujoco><worldbody>
        <body><geom type="box" size="{half} {half} {half}" mass="2.5"/></body>
        <body><geom type="box" size="{plate[0]} {plate[1]} {plate[2]}" mass="0.07"/></body>
        <body><geom type="cylinder" size="0.05 0.01" mass="0.05"/></body>
        </worldbody></mujoco>"""
    )
    for side in SIDES:
        for row, name in enumerate(("body", "palm", "port"), start=1):
            found = sorted(m.body(f"{side}_{name}").inertia)
            assert found == pytest.approx(sorted(known.body_inertia[row]), rel=1e-6), name


@pytest.mark.parametrize(("direction", "sense"), [("forward", 1), ("backward", -1)])
def test_ridges_lie_ahead_in_the_direction_of_travel(direction: str, sense: int) -> None:
    ridge = {"at_m": 0.4, "height_m": 0.004, "length_m": 0.06}
    m = compiled({"mujoco.ridges": [ridge], "task.direction": direction})
    assert m.geom("ridge_1").pos[0] == pytest.approx(sense * 0.4)


def test_left_wheel_of_each_robot_is_the_larger_one() -> None:
    m = compiled({"mujoco.wheel_radius_mismatch": 0.02})
    for side in SIDES:
        port, starboard = (m.geom(f"{side}_{w}").size[0] for w in ("port", "starboard"))
        assert port / starboard == pytest.approx(1.01 / 0.99)
        assert m.body(f"{side}_port").pos[1] > 0 > m.body(f"{side}_starboard").pos[1]


# --- the world ----------------------------------------------------------------------------------


def test_the_palm_nearer_to_the_centre_of_mass_bears_more() -> None:
    """Moments about the contacts, 0.25 m apart, with the object at rest and level."""
    world = world_of({"object.com_m": [0.1, 0.04]})
    world.sight()
    measured = world.measured
    up = [
        f * math.cos(a) - d * math.sin(a)
        for f, d, a in zip(measured.force, measured.friction_force, STEEP, strict=True)
    ]
    weight = 0.5 * 9.80665
    assert up == pytest.approx([0.6 * weight, 0.4 * weight], rel=0.02)
    # Sideways only the squeeze is left: what the left palm takes, the right one gives.
    left, right = (
        f * math.sin(a) + d * math.cos(a)
        for f, d, a in zip(measured.force, measured.friction_force, STEEP, strict=True)
    )
    assert left == pytest.approx(right, abs=0.02 * weight)


def turned(world: MujocoWorld, joint: str, axis: tuple[int, int, int], degrees: float) -> None:
    """Turn a free body where it is."""
    quat = world.data.joint(joint).qpos[3:7]
    mj.mju_axisAngle2Quat(quat, np.array(axis, dtype=float), math.radians(degrees))
    mj.mj_kinematics(world.model, world.data)


@pytest.mark.parametrize(("degrees", "end"), [(59, ""), (61, "tipping"), (-61, "tipping")])
@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0)])
def test_it_has_tipped_beyond_60_degrees(
    degrees: float, end: str, axis: tuple[int, int, int]
) -> None:
    world = world_of()
    turned(world, "object", axis, degrees)
    assert world._end((0.0, 0.0), (True, True)) == end


def test_repeated_short_unloading_is_no_drop() -> None:
    world = world_of()
    for tick in range(201):
        assert world._end((0.0, 0.0), (True, tick % 20 == 0)) == ""
    ends = [world._end((0.0, 0.0), (True, False)) for _ in range(30)]
    assert ends[23] == "" and ends[26] == "lifting"


def test_lateral_is_to_the_left_on_straight_paths_too() -> None:
    for aside in (0.005, -0.004):
        world = world_of()
        world.data.joint("object").qpos[1] += aside
        mj.mj_kinematics(world.model, world.data)
        assert world.lateral == pytest.approx((aside, aside), abs=1e-6)
        world.sight()
        assert world.lateral_peak == pytest.approx((aside, aside), abs=1e-6)
        assert world.measured.vertex_y == pytest.approx((aside, aside), abs=1e-6)
        assert world.measured.pivot_y == pytest.approx((0.0, 0.0), abs=1e-6)


def test_pitch_is_outward_end_up_and_yaw_anticlockwise() -> None:
    """About +y the end at −x rises, which is the outward one of the left robot."""
    world = world_of()
    turned(world, "left_body", (0, 1, 0), 2.0)
    turned(world, "right_body", (0, 1, 0), 3.0)
    assert np.degrees(world._pitches()) == pytest.approx([2.0, -3.0], abs=1e-6)
    turned(world, "left_body", (0, 0, 1), 4.0)
    turned(world, "right_body", (0, 0, 1), -5.0)
    world.sight()
    assert np.degrees(world.measured.yaw) == pytest.approx([4.0, -5.0], abs=1e-6)


def test_object_with_its_right_end_up_has_a_positive_rise() -> None:
    world = world_of()
    turned(world, "object", (0, 1, 0), -3.0)
    sight = world.sight()
    assert sight.rise == pytest.approx(0.25 * math.sin(math.radians(3.0)), abs=1e-4)
    assert sight.lift[1] > 5e-3 > abs(sight.lift[0])


def test_sliding_outward_increases_the_contact_coordinate() -> None:
    """Palms driven together slide outward below the object, and inward when driven apart."""
    world = world_of()
    moved = {-1: 0, 1: 0}
    for closing in (1, -1):
        for _ in range(60):
            before = world.contacts
            world.move((0.02 * closing, -0.02 * closing), STEEP)
            sight = world.sight()
            for k in (0, 1):
                way = world.contacts[k] - before[k]
                if sight.motion[k]:
                    assert sight.motion[k] * way > 0
                    moved[sight.motion[k]] += 1
    assert min(moved.values()) > 10


def test_slip_is_of_both_wheels_of_that_robot() -> None:
    world = world_of()
    for side, speeds in (("left", (3.0, 1.0)), ("right", (0.5, 1.5))):
        for wheel, speed in zip(("port", "starboard"), speeds, strict=True):
            world.data.joint(f"{side}_{wheel}").qvel[0] = speed
    radius = world.scene.mujoco.wheel_radius_m
    assert world._wheel_slips((0.01, 0.02)) == pytest.approx((2 * radius - 0.01, radius - 0.02))


# --- what is logged -----------------------------------------------------------------------------


def test_log_fields_are_named_after_variable_and_unit() -> None:
    units = {"N": "n", "m/s": "m_s", "rad": "rad", "m": "m"}
    for name, attrs in COLUMNS.items():
        channel = "" if name == "speed" else "dynamics/"
        assert attrs["log_field"] == f"{channel}{name}_{units[attrs['units']]}"


@pytest.mark.parametrize(
    ("mean", "most", "lips", "verdict"),
    [
        (34.9, 60.0, False, "near"),
        (35.1, 36.0, False, "beyond"),
        (20.0, 27.9, False, "kept"),
        (20.0, 28.1, False, "near"),
        (50.0, 60.0, True, "kept"),
    ],
)
def test_verdicts_change_at_the_budget(mean: float, most: float, lips: bool, verdict: str) -> None:
    """Beyond it in the mean; near it from 80 % for the worst seed; lips stop the drift."""
    budget = DriftBudget(0.035, 1e-3 * mean, 1e-3 * most, 16, 0, 7.2, lips)
    assert budget.verdict == verdict


@pytest.mark.parametrize(("lasts", "faster"), [(3.0, 1), (90.0, 2)])
def test_each_frame_shows_the_moment_of_its_time(lasts: float, faster: int) -> None:
    """Twenty frames a second; a carry of more than a minute is shown faster, and says so."""
    times = np.arange(round(lasts / 0.01) + 1) * 0.01
    carry = SimpleNamespace(trace={"time": SimpleNamespace(to_numpy=lambda: times)})
    shown: list[tuple[float, str]] = []
    studio = SimpleNamespace(picture=lambda row, note: shown.append((float(times[row]), note)))
    rows, speedup = film._rows(cast(Any, carry), 20.0)
    frames = list(film._frames(rows, speedup, cast(Any, studio), None))
    assert len(frames) == len(shown)
    wanted = np.arange(len(shown)) * faster / 20.0
    assert [at for at, _ in shown] == pytest.approx(np.minimum(wanted, lasts), abs=1e-9)
    assert shown[-1][0] == pytest.approx(lasts)
    assert {note for _, note in shown} == {"" if faster == 1 else f", {faster} × real time"}

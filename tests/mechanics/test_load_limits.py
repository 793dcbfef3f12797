# SPDX-License-Identifier: Apache-2.0
"""What the robots can hold, against linear programs and virtual work, and against MuJoCo."""

import math
from itertools import pairwise, product
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import SIDES
from palmbots.errors import SceneError
from palmbots.mechanics.load_limits import LoadLimits
from palmbots.scene.chassis import axle_out, chassis, wheel_kg
from palmbots.scene.placement import floor_level
from palmbots.scene.robot_dimensions import PALM_THICKNESS
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import on_every_side
from palmbots.scene.spec import contact_radii, to_spec
from sampled import sampled

G = 9.80665
CRATE = {
    "object.vertices_m": [[0, 0], [0.4, 0], [0.4, 0.12], [0, 0.12]],
    "object.com_m": [0.22, 0.10],
    "object.depth_m": 0.2,
    "palm.friction": 0.35,
    "palm.length_m": 0.08,
}
SCENES = [
    {},
    CRATE,
    {"task.slope_deg": 3.0, "palm.left.steep_deg": 20.0, "start.right_m": 0.03},
    {"mujoco.body_kg": 8.0, "mujoco.axle_m": 0.25, "palm.pivot_offset_m": 0.01},
    {"mujoco.axle_m": 0.05, "task.inertia": False, "palm.right.friction": 0.5},
    {"object.edge_radius_m": [0.02, 0.01, 0, 0], "palm.left.steep_deg": 20.0},
]


def unit_forces(
    scene: Scene, angles: tuple[float, float], slope: float
) -> list[tuple[bool, np.ndarray]]:
    """Forces on the object of weight 1, from linear programs: those of the extreme squeezes, and
    (True) those of the squeeze nearest to none."""
    from scipy.optimize import linprog

    spec = to_spec(scene)
    radii = contact_radii(spec)
    lines, places, centres = [], [], []
    for i, sense in ((0, -1.0), (1, 1.0)):
        p, o, t = spec.start[i], spec.palms[i].offset, angles[i]
        out = np.array([sense * math.cos(t), math.sin(t)])
        normal = np.array([-sense * math.sin(t), math.cos(t)])
        places.append(p * out + o * normal)
        centres.append(places[-1] + radii[i] * normal)
        lines += [normal + s * spec.palms[i].friction * out for s in (-1.0, 1.0)]
    # From the centre of the left arc; the radius of a sharp vertex is 0.
    rise = centres[1][1] - centres[0][1]
    apart = np.array([math.sqrt(spec.width**2 - rise**2), rise])
    along = apart / spec.width
    com = spec.com_left * along + spec.com_height * np.array([-along[1], along[0]])
    left, right = places[0] - centres[0], apart + places[1] - centres[1]
    at = [left, left, right, right]
    balance = np.array([
        [f[0] for f in lines],
        [f[1] for f in lines],
        [a[0] * f[1] - a[1] * f[0] for a, f in zip(at, lines, strict=True)],
    ])  # fmt: skip
    # weight 1 down, and `slope` towards −x, at the COM
    load = np.array([slope, 1.0, com[0] - com[1] * slope])
    found = []
    # The squeeze is the mean of the inward forces; the fifth variable is at least its size.
    squeeze = np.array([0.5 * (f[0] if k < 2 else -f[0]) for k, f in enumerate(lines)] + [0.0])
    size = np.array([0.0] * 4 + [1.0])
    for is_least, cost in ((False, -squeeze), (False, squeeze), (True, size)):
        answer = linprog(
            cost, A_eq=np.column_stack([balance, np.zeros(3)]), b_eq=load,
            A_ub=[squeeze - size, -squeeze - size] if is_least else None,
            b_ub=[0.0, 0.0] if is_least else None,
        )  # fmt: skip
        if answer.status != 0:  # not held, or wedged
            continue
        forces = [sum(answer.x[2 * i + k] * lines[2 * i + k] for k in (0, 1)) for i in (0, 1)]
        found.append((is_least, np.array(forces)))
    return found


def stays_upright(scene: Scene, mass: float) -> bool:
    """Whether no robot gains energy by turning about one of its supports, at the start."""
    spec = to_spec(scene)
    at = chassis(-floor_level(spec), axle_out(scene))
    keys = scene.mujoco
    one, two = ((palm.shallow, palm.steep) for palm in spec.palms)
    slope = spec.slope
    for angles in product(one, two):
        for is_least, forces in unit_forces(scene, angles, slope):
            for i, out in ((0, -1.0), (1, 1.0)):
                p, o, t = spec.start[i], spec.palms[i].offset, angles[i]
                wrist = np.array(at.pivot)
                middle = o - PALM_THICKNESS / 2
                wheel = wheel_kg(scene)
                pull = np.array([-slope * out, -1.0]) * G  # outward and up
                parts = [
                    (keys.body_kg - 2 * wheel, np.array(at.com)),
                    (2 * wheel, np.array([at.axle, keys.wheel_radius_m])),
                    (keys.arm_kg, np.array(at.shoulder) + np.array(at.arm) / 2),
                    (keys.palm_kg, wrist + middle * np.array([-math.sin(t), math.cos(t)])),
                ]
                contact = wrist + np.array(
                    [p * math.cos(t) - o * math.sin(t), p * math.sin(t) + o * math.cos(t)]
                )
                load = -mass * G * forces[i] * np.array([out, 1.0])
                applied = [(m * pull, x) for m, x in parts] + [(load, contact)]
                supports = ((at.caster, at.axle), (at.axle, at.caster))
                for support, other in supports[:1] if is_least else supports[1:]:
                    # A small turn about `support` that lifts the other one off the floor.
                    turn = 1e-3 * math.copysign(1, other - support)
                    work = sum(
                        force @ (turn * np.array([-x[1], x[0] - support])) for force, x in applied
                    )
                    if work > 0:
                        return False
    return True


def test_tipping_at_the_start_is_where_a_turn_about_a_support_gains_energy() -> None:
    for changes in SCENES:
        scene = load_scene("paper", changes)
        limit = next(x for x in pb.load_limits(scene).limits if x.kind == "tipping")
        assert limit.at_start_kg is not None
        assert limit.heaviest_kg <= limit.at_start_kg
        assert stays_upright(scene, 0.999 * limit.at_start_kg)
        assert not stays_upright(scene, 1.001 * limit.at_start_kg)


def test_servo_at_the_end_of_a_palm_holds_the_moment_of_its_load() -> None:
    keys = {
        "palm.usable_m": 0.1,
        "palm.friction": 0.001,
        "task.inertia": False,
        "mujoco.palm_kg": 0.001,
    }
    keys |= {"palm.shallow_deg": 0.001, "palm.steep_deg": 0.002, "mujoco.palm_torque_n_m": 0.7}
    limit = pb.load_limits("paper", overrides=keys).limits[0]
    # Flat palms: half of the weight, more by the share that the contacts shift, times the lever.
    assert limit.kind == "servo" and limit.at_start_kg is None
    assert limit.heaviest_kg * G * 0.5 * 0.05 == pytest.approx(0.7, rel=2e-3)


TIPPING = {
    "object.box_m": [0.25, 0.125], "palm.shallow_deg": -1.3, "palm.steep_deg": 17.5,
    "palm.length_m": 0.087, "mujoco.palm_torque_n_m": 10.0, "mujoco.floor_friction": 5.0,
}  # fmt: skip
"""A robot tips most with a friction at which some contacts are just held."""


@pytest.mark.parametrize("changes", [*SCENES, TIPPING])
def test_more_friction_never_allows_a_heavier_object(changes: dict[str, Any]) -> None:
    scene = load_scene("paper", changes)
    heaviest = []
    for mu in np.linspace(0.03, 0.8, 15):
        found = pb.load_limits(scene, overrides=on_every_side(scene, {"palm.friction": float(mu)}))
        heaviest.append(found.heaviest_kg or math.inf)
    assert all(b <= a * (1 + 1e-9) for a, b in pairwise(heaviest))
    assert heaviest[-1] < heaviest[0]


def test_mirrored_scene_has_mirrored_limits() -> None:
    scene = load_scene("paper", SCENES[2])
    ours, theirs = pb.load_limits(scene), pb.load_limits(scene.mirrored())
    for one, two in zip(ours.limits, theirs.limits, strict=True):
        assert (one.kind, one.heaviest_kg) == (two.kind, pytest.approx(two.heaviest_kg, rel=1e-9))
        assert one.side != two.side


def test_heavy_objects_are_refused_in_both_worlds_before_anything_moves() -> None:
    limit = pb.load_limits().at_start_kg
    assert limit is not None
    for world in ("quasistatic", "mujoco"):
        for mass in (1.01 * limit, 50, 500):
            for radius in (0.0, 0.01):
                keys = {"object.mass_kg": mass, "object.edge_radius_m": radius}
                with pytest.raises(SceneError, match=r"object\.mass_kg: .*tips over.*allowed: at"):
                    pb.carry(world=world, overrides=keys)
    assert "object.mass_kg is 5" in pb.stability.self_check(overrides={"object.mass_kg": 5})[-1]
    assert not pb.stability.self_check()


def test_warning_and_refusal_name_masses_that_are_allowed() -> None:
    found = pb.load_limits(overrides={"object.mass_kg": 500})
    text = found.refusal()
    assert isinstance(found, LoadLimits) and text is not None
    allowed = float(text.split("at most ")[1].split()[0])
    assert pb.load_limits(overrides={"object.mass_kg": allowed}).refusal() is None


TOTE: dict[str, Any] = {
    "object.box_m": [0.4, 0.22], "object.depth_m": 0.26, "object.mass_kg": 3.2,
    "object.com_m": [0.185, 0.08], "object.edge_radius_m": 0.004, "palm.length_m": 0.14,
    "palm.friction": 0.45, "robot.motor_force_n": 30.0, "mujoco.body_kg": 12.0,
    "mujoco.palm_torque_n_m": 0.6,
}  # fmt: skip
"""The motors are weakest with a contact between those of a coarse grid: 5.64 kg anywhere on the
palms, but 5.61 kg in their inner half."""


@pytest.mark.parametrize("changes", sampled([TOTE, *SCENES, TIPPING], 3))
def test_no_contacts_allow_less_than_the_heaviest_object(changes: dict[str, Any]) -> None:
    """Each limit of a region is at most that of every state in it, and not far from the least of
    many states."""
    scene = load_scene("paper", changes | {"task.inertia": False})
    rng = np.random.default_rng(1)
    reach = [scene.palm_of(side).reach_m for side in SIDES]
    least: dict[str, float] = {}
    for share in [*product((-1, -0.5, 0, 0.5, 1), repeat=2), *rng.uniform(-1, 1, (1500, 2))]:
        places = (float(part * half) for part, half in zip(share, reach, strict=True))
        start = dict(zip(("start.left_m", "start.right_m"), places, strict=True))
        for one in pb.load_limits(scene, overrides=start).limits:
            if one.at_start_kg is not None:
                least[one.kind] = min(one.at_start_kg, least.get(one.kind, math.inf))
    found = {one.kind: one.heaviest_kg for one in pb.load_limits(scene).limits}
    assert found.keys() >= least.keys()
    for kind, mass in least.items():
        assert 0.97 * mass <= found[kind] <= mass * (1 + 1e-4), kind


@pytest.mark.parametrize("changes", [{}, CRATE, TOTE])
def test_a_larger_region_never_allows_a_heavier_object(changes: dict[str, Any]) -> None:
    limits = pb.load_limits("paper", overrides=changes)
    assert limits.limits_within(math.inf) == limits.limits_within(limits.reach_m)
    by_reach = [
        {kind: mass for mass, kind in limits.limits_within(float(reach))}
        for reach in np.linspace(1e-3, limits.reach_m, 25)
    ]
    for near, far in pairwise(by_reach):
        assert near.keys() <= far.keys()
        assert all(far[kind] <= mass * (1 + 1e-4) for kind, mass in near.items())

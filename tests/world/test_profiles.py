# SPDX-License-Identifier: Apache-2.0
"""Palms with a thickness, a bevel and a heel."""

import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import contact_radii, to_spec
from palmbots.simulation import FloorWorld, run_seeds
from palmbots.simulation.batch import DROPPED

HEEL = {"palm.thickness_m": 0.0015, "palm.nose_m": 0.0003, "palm.bevel_m": 0.008,
        "palm.heel_m": 0.012}  # fmt: skip
LEANING = {"object.vertices_m": [[0, 0], [0.25, 0], [0.28, 0.1], [-0.03, 0.1]]}
"""A trough: its sides lean outward, by 30 mm at a height of 100 mm."""


def world_of(keys: dict[str, Any]) -> _core.World:
    return _core.World(to_spec(load_scene("paper", keys)))


def opened(world: _core.World, by_m: float) -> tuple[str, float]:
    """The end of an opening at level palms in small steps, and the separation there."""
    before = world.separation
    while world.separation < before + by_m - 1e-9:
        end = world.advance(0.001, world.palms)[0]
        if end:
            return end, world.separation
    return "", world.separation


@pytest.mark.parametrize("keys", [{}, {"object.edge_radius_m": 0.005}, LEANING])
def test_without_contact_with_nose_and_heel_they_change_nothing(keys: dict[str, Any]) -> None:
    plain, shaped = (
        pb.carry("paper", "distributed", seed=1, overrides=keys | profile) for profile in ({}, HEEL)
    )
    assert plain.outcome == shaped.outcome == "delivered"
    assert plain.trace_hash == shaped.trace_hash


@pytest.mark.parametrize("keys", [{}, LEANING])
@pytest.mark.parametrize("steep_deg", [10.0, 15.0])
def test_a_heel_stops_the_contact_where_it_touches(keys: dict[str, Any], steep_deg: float) -> None:
    """Closing pushes both contacts outward until the object is between the heels."""
    world = world_of(HEEL | keys | {"palm.steep_deg": steep_deg})
    end = ""
    while not end:
        end = world.advance(-0.0005, world.palms)[0]
    assert end == "jammed"
    # A vertical side is at the heel's top as far outward as that is over the contact: the height
    # of the heel times the tangent of the palm angle; a side that leans by λ more than that.
    theta = math.radians(steep_deg)
    leans = math.atan(0.3) if keys else 0.0
    ahead = 0.012 * math.tan(max(0.0, theta + leans))
    assert world.contacts == pytest.approx((0.075 - ahead,) * 2, abs=1e-9)


@pytest.mark.parametrize("keys", [{}, {"palm.heel_m": 0.012}])
def test_inward_a_contact_may_be_on_the_whole_palm(keys: dict[str, Any]) -> None:
    ends = [
        world_of(keys | {"start.left_m": p, "start.right_m": p}).check() for p in (-0.0749, 0.02)
    ]
    assert ends == ["", ""]
    world = world_of(keys)
    assert opened(world, 0.2)[0] == "off-palm"
    assert min(world.contacts) == pytest.approx(-0.075, abs=1e-9)


def test_a_heel_inside_the_object_is_no_start() -> None:
    wide = {"object.vertices_m": [[0, 0], [0.25, 0], [0.25, 0.02], [0.4, 0.02], [0.4, 0.1],
                                  [-0.15, 0.1], [-0.15, 0.02], [0, 0.02]]}  # fmt: skip
    for high, reason in ((0.012, ""), (0.03, "flush")):
        assert world_of(wide | {"palm.heel_m": high, "palm.steep_deg": 6.0}).check() == reason


def test_a_carry_with_heels_survives_where_a_contact_would_leave_the_palm() -> None:
    noisy = {"robot.noise_m_s": 0.1, "task.distance_m": 1.0}
    without, with_heels = (
        run_seeds(to_spec(load_scene("paper", noisy | keys)), "distributed", 0, 200)
        for keys in ({}, {"palm.heel_m": 0.012})
    )
    dropped = [int(np.sum(found["outcome"] == DROPPED)) for found in (without, with_heels)]
    assert dropped[1] < dropped[0]


def test_carries_between_heels_are_those_of_the_general_step() -> None:
    """A palm that may go limp, even if it never does, makes every step the general one."""
    noisy = HEEL | {"robot.noise_m_s": 0.1, "task.distance_m": 1.0}
    limp = {"kind": "reboot", "robot": "left", "at_s": 900, "duration_s": 1, "limp_deg": 0}
    specs = [to_spec(load_scene("paper", noisy | key)) for key in ({}, {"faults.script": [limp]})]
    assert [_core.takes_single_steps(spec) for spec in specs] == [False, True]
    beyond = 0
    for seed in range(12):
        usual, general = (
            pb.carry("paper", "distributed", seed=seed, overrides=noisy | key)
            for key in ({}, {"faults.script": [limp]})
        )
        assert (usual.outcome, usual.reason) == (general.outcome, general.reason)
        assert usual.trace is not None and general.trace is not None
        places = usual.trace["contact"].values
        assert places == pytest.approx(general.trace["contact"].values, abs=1e-9)
        beyond += bool((places > specs[0].palms[0].usable / 2).any())
    assert beyond > 3


def test_lanes_agree_with_single_carries() -> None:
    scene = load_scene("paper", HEEL | {"robot.noise_m_s": 0.06, "task.distance_m": 0.5})
    lanes = run_seeds(to_spec(scene), "distributed", 0, 32, threads=1)
    for seed in range(0, 32, 5):
        single = pb.carry(scene, "distributed", seed=seed)
        assert single.time_s == lanes["time_s"][seed]


def test_the_usable_part_is_that_on_which_the_heel_touches_nothing() -> None:
    """Where both contacts are on it, no pose of the object at the scene's angles is touched."""
    draw = np.random.default_rng(4)
    uneven = {"palm.left.heel_m": 0.03, "palm.pivot_offset_m": 0.01}
    rounded = {"object.edge_radius_m": [0.03, 0.002, 0, 0]}
    for keys in ({}, LEANING, uneven, rounded):
        spec = to_spec(load_scene("paper", HEEL | keys))
        radii = contact_radii(spec)
        halves = [palm.usable / 2 for palm in spec.palms]
        assert all(0.01 < half < 0.075 for half in halves)
        points = np.array(spec.silhouette)
        for _ in range(300):
            p = [draw.choice([-1, 1, draw.uniform(-1, 1)]) * half for half in halves]
            angles = [draw.uniform(palm.shallow, palm.steep) for palm in spec.palms]
            rise = [
                x * math.sin(a) + (palm.offset + radius) * math.cos(a)
                for x, a, palm, radius in zip(p, angles, spec.palms, radii, strict=True)
            ]
            turn = math.asin((rise[1] - rise[0]) / spec.width)
            for k, palm in enumerate(spec.palms):
                sense = (-1, 1)[k]
                origin = (0.0, spec.width)[k]
                lean = turn - sense * angles[k]
                x, y = (points[:, 0] - origin), points[:, 1]
                along = sense * (x * math.cos(lean) - y * math.sin(lean)) + p[k]
                height = x * math.sin(lean) + y * math.cos(lean) + radii[k]
                dense = np.linspace(0, 1, 50)[:, None]
                edge_along = (along * (1 - dense) + np.roll(along, -1) * dense).ravel()
                edge_height = (height * (1 - dense) + np.roll(height, -1) * dense).ravel()
                below = edge_height <= palm.heel
                assert edge_along[below].max() < palm.length / 2 + 1e-12


@pytest.mark.parametrize("theta_deg", [2.0, 5.0, 8.0, 9.0, 15.0])
def test_the_lowest_point_of_a_bevelled_plate_is_on_the_floor(theta_deg: float) -> None:
    """Up to tan θ = (thickness − nose) / bevel, 8.5°, it is where the bevel begins."""
    world = FloorWorld(palms_deg=(theta_deg, theta_deg), overrides=HEEL)
    theta = math.radians(theta_deg)
    lower = [(-0.075, -0.0003), (-0.067, -0.0015), (0.075, -0.0015)]
    lowest = min(x * math.sin(theta) + y * math.cos(theta) for x, y in lower)
    assert world.state.pivots_m.left[1] == pytest.approx(-lowest, abs=1e-15)
    assert (lowest == lower[0][0] * math.sin(theta) + lower[0][1] * math.cos(theta)) == (
        theta_deg > 8.6
    )


def test_a_nose_as_thick_as_the_plate_is_the_default() -> None:
    one, other = (
        to_spec(load_scene("paper", {"palm.thickness_m": 0.002} | keys)).palms[0].lowest_pivot(0.1)
        for keys in ({}, {"palm.nose_m": 0.002})
    )
    assert one == other

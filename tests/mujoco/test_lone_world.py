# SPDX-License-Identifier: Apache-2.0
"""Jobs that one robot does alone, in MuJoCo: pick up, carry, put down, against the quasistatic
world."""

import math
from typing import Any

import numpy as np
import pytest
from tests.conftest import is_soak

import palmbots as pb
from palmbots.mechanics.lone_refusals import lone_lift
from palmbots.scene.placement import floor_level, placements
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import Carry
from palmbots.simulation.floor_job import FloorJob

LONE = load_scene("lone")
JOBS = 100 if is_soak() else 6


def job(carry: Carry) -> FloorJob:
    assert carry.floor_job is not None
    return carry.floor_job


@pytest.fixture(scope="module")
def carried() -> Carry:
    return pb.carry("lone", "shared-sign", world="mujoco")


def test_the_robot_passes_the_phases_of_the_quasistatic_world(carried: Carry) -> None:
    exact = pb.carry("lone", "shared-sign")
    assert (carried.outcome, carried.reason, job(carried).failure) == ("delivered", None, None)
    ours, theirs = ({p.phase: p.start_s for p in job(c).phases} for c in (carried, exact))
    assert list(ours) == list(theirs)
    for phase, start in ours.items():
        assert start == pytest.approx(theirs[phase], abs=2.0), phase
    assert job(carried).missed_m == pytest.approx(job(exact).missed_m, abs=0.02)


def test_the_object_ends_flat_on_the_floor_and_alone(carried: Carry) -> None:
    assert carried.trace is not None
    last = carried.trace.sizes["time"] - 1
    place = placements(to_spec(LONE), carried.trace, np.array([0, last]))
    floor = floor_level(to_spec(LONE))
    for row in (0, 1):
        assert min(place.outline[row, :, 1]) == pytest.approx(floor, abs=3e-4)
        assert place.turn[row] == pytest.approx(0, abs=1e-3)
    assert (carried.trace.force.isel(time=last) == 0).all()


@pytest.mark.slow
def test_outcomes_agree_from_random_starts() -> None:
    """Objects, friction and angles at random, where the closed forms neither refuse nor warn."""
    rng = np.random.default_rng(5)
    tried = 0
    while tried < JOBS:
        width, high = rng.uniform(0.07, 0.12), rng.uniform(0.03, 0.06)
        keys: dict[str, Any] = {
            "object.vertices_m": [[0, 0], [width, 0], [width, high], [0, high]],
            "object.com_m": [rng.uniform(0.4, 0.6) * width, rng.uniform(0.3, 0.6) * high],
            "object.edge_radius_m": 0.003,
            "object.mass_kg": rng.uniform(0.1, 0.3),
            "palm.friction": rng.uniform(0.25, 0.4),
            "palm.shallow_deg": rng.uniform(6.0, 9.0),
            "floor.friction": rng.uniform(0.2, 0.6),
            "floor.walls": [{"at_m": -width, "friction": rng.uniform(0.1, 0.5)}],
            "task.distance_m": 0.2,
        }
        keys["palm.steep_deg"] = math.degrees(math.atan(keys["palm.friction"])) + 8.0
        closed = lone_lift(load_scene("lone", keys))
        assert closed is not None
        if closed.refusals or closed.warnings:
            continue
        tried += 1
        for world in ("quasistatic", "mujoco"):
            carry = pb.carry("lone", "shared-sign", seed=tried, world=world, overrides=keys)
            assert (carry.outcome, job(carry).failure) == ("delivered", None), (world, keys)

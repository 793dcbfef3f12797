# SPDX-License-Identifier: Apache-2.0
"""Jobs in which one robot hands the object to the other one, in MuJoCo, against the quasistatic
world."""

import numpy as np
import pytest

import palmbots as pb
from palmbots.scene.placement import floor_level, placements
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import Carry
from palmbots.simulation.floor_job import FloorJob

SCENE = load_scene("handover")


def job(carry: Carry) -> FloorJob:
    assert carry.floor_job is not None
    return carry.floor_job


@pytest.fixture(scope="module")
def carried() -> Carry:
    return pb.carry("handover", "shared-sign", world="mujoco")


def test_both_robots_pass_the_phases_of_the_quasistatic_world(carried: Carry) -> None:
    exact = pb.carry("handover", "shared-sign")
    assert (carried.outcome, carried.reason, job(carried).failure) == ("delivered", None, None)
    for robot in ("left", "right"):
        ours, theirs = (
            [p.phase for p in job(c).phases if p.robot == robot] for c in (carried, exact)
        )
        assert ours == theirs
    assert job(carried).missed_m == pytest.approx(job(exact).missed_m, abs=0.06)


def test_the_object_ends_flat_on_the_floor_and_alone(carried: Carry) -> None:
    assert carried.trace is not None
    last = carried.trace.sizes["time"] - 1
    place = placements(to_spec(SCENE), carried.trace, np.array([0, last]))
    floor = floor_level(to_spec(SCENE))
    for row in (0, 1):
        assert min(place.outline[row, :, 1]) == pytest.approx(floor, abs=3e-4)
        assert place.turn[row] == pytest.approx(0, abs=1e-3)
    assert (carried.trace.force.isel(time=last) == 0).all()


@pytest.mark.parametrize("seed", (4, 8))
def test_switches_that_open_while_the_object_slides_off_do_not_stop_the_giver(seed: int) -> None:
    assert pb.carry("handover", "shared-sign", world="mujoco", seed=seed).outcome == "delivered"

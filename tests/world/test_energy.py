# SPDX-License-Identifier: Apache-2.0
"""Work of the surfaces = change of the potential energy + heat of friction, in random scripts and
across small falls."""

import copy
import math
from collections.abc import Callable

import pytest

import palmbots as pb
import palmbots._core as _core
from energy_oracle import Account, account_for, potential
from motion_oracle import Moment, Oracle, slipperier
from palmbots.scene.spec import to_spec
from random_lifts import random_lift

SCRIPTS = 12
FALLS = (1, 24)  # seeds of jobs in which the object falls off a nose


def test_work_lifts_the_object_or_becomes_heat() -> None:
    total = Account()
    for seed in range(SCRIPTS):
        account_for(seed, total)
    assert total.faults == []
    assert total.motions > 200 * SCRIPTS and total.events > SCRIPTS
    # Nothing gets lost over many motions either.
    assert total.work == pytest.approx(total.gained + total.heat, rel=1e-4)
    assert total.heat > 0.5 * total.work > 0.1


def steeper(oracle: Oracle, by: float) -> Oracle:
    """The same with more slope."""
    other = copy.copy(oracle)
    other.slope += by
    return other


@pytest.mark.parametrize(
    "judge",
    [lambda o: slipperier(o, 0.9), lambda o: slipperier(o, 1.1), lambda o: steeper(o, 0.01)],
)
def test_the_oracle_notices_wrong_friction_and_wrong_weight(
    judge: Callable[[Oracle], Oracle],
) -> None:
    """Where a contact is about to slide, the forces that balance no longer fit its motion."""
    total = Account()
    for seed in range(3):
        account_for(seed, total, judge, halvings=2)
    assert len(total.faults) > 0.05 * total.motions > 25


@pytest.mark.parametrize("seed", FALLS)
def test_a_small_fall_releases_the_energy_that_it_states(seed: int) -> None:
    """From the pose before that period the palms move as they did, in a world without falls. Where
    it ends, they are where they stood during the fall, and the object is higher by its energy."""
    keys = random_lift(seed) | {"task.inertia": False}
    carry = pb.carry("lift", "shared-sign", seed=seed, overrides=keys)
    assert carry.floor_job is not None and carry.floor_job.falls and carry.trace is not None
    spec, trace = to_spec(carry.scene), carry.trace
    oracle = Oracle(spec, spec.floor_friction)

    def at(k: int) -> Moment:
        x, half = float(trace.midpoint[k]), 0.5 * float(trace.separation[k])
        low, high = (float(height) for height in trace.pivot_height[k])
        left, right = (float(angle) for angle in trace.palm[k])
        pose = float(trace.object_x[k]), float(trace.object_height[k]), float(trace.object[k])
        return Moment(((x - half, low), (x + half, high)), (left, right), pose)

    for fall in carry.floor_job.falls:
        k = round(fall.time_s / spec.period)
        before, after = at(k), at(k + 1)
        world = _core.World(spec, True)
        world.set_phase("by_hand")
        world.put(before.pivots, before.palms, before.pose[:2], before.pose[2])
        left, right = (
            (2 * (q[0] - p[0]), 2 * (q[1] - p[1]))
            for p, q in zip(before.pivots, after.pivots, strict=True)
        )
        angles = [2 * q - p for p, q in zip(before.palms, after.palms, strict=True)]
        reason, fraction, *_ = world.move((left, right), (angles[0], angles[1]))
        here = Moment.of(world)
        assert reason and fraction == pytest.approx(0.5, abs=1e-6)
        released = potential(oracle, here.pose) - potential(oracle, after.pose)
        weight = carry.scene.object.mass_kg * _core.standard_gravity
        assert fall.energy_j == pytest.approx(weight * released, rel=1e-6) and released > 0
        assert max(oracle.deepest([here, after])) < 1e-6
        assert math.dist(here.pose[:2], after.pose[:2]) < 3 * fall.height_m

# SPDX-License-Identifier: Apache-2.0
"""Jobs that begin or end on a stand: against closed forms, symmetry, and what the guide says."""

import math
from itertools import product
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import SIDES
from palmbots.errors import SceneError
from palmbots.mechanics.lifting import lifting
from palmbots.scene.placement import floor_level, placements
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import Carry, run_seeds
from palmbots.simulation.floor_job import FloorJob
from palmbots.simulation.prepare import prepare
from random_stands import random_stand, stands
from sampled import amounts

TOP_M = 0.1
RADIUS_M = 0.003
HALF_M = 0.075
STEEP = math.radians(15)
RATE_M_S = 0.05
TICK_S = 0.01

ENDS = [pair for pair in product(("palms", "floor", "stand"), repeat=2) if "stand" in pair]


def job(carry: Carry) -> FloorJob:
    assert carry.floor_job is not None
    return carry.floor_job


def first(carry: Carry, phase: str) -> list[float]:
    """When each robot first began a phase [s]."""
    return [
        next(one.start_s for one in job(carry).phases if (one.robot, one.phase) == (side, phase))
        for side in SIDES
    ]


def on(begins: str, ends: str, **more: Any) -> dict[str, Any]:
    heights = [TOP_M if end == "stand" else None for end in (begins, ends)]
    keys = {"task.from": begins, "task.to": ends, "task.distance_m": 0.6}
    return keys | {"floor.stands": stands(heights[0], heights[1], 0.6)} | more


@pytest.fixture(scope="module")
def carried() -> Carry:
    return pb.carry("stand", "shared-sign")


@pytest.mark.parametrize("controller", ["shared-sign", "distributed", "resilient", "centralized"])
@pytest.mark.parametrize("ends", ENDS)
def test_the_whole_job_succeeds(controller: str, ends: tuple[str, str]) -> None:
    spec = prepare(load_scene("stand", on(*ends)), controller).spec
    outcomes = run_seeds(spec, controller, 0, 10)["outcome"]
    assert (outcomes == 1).all()


@pytest.mark.parametrize("dock", ["together", "one-first"])
@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_either_direction_and_either_robot_first(dock: str, direction: str) -> None:
    keys = {"task.dock": dock, "task.direction": direction}
    carry = pb.carry("stand", "resilient", overrides=keys, record=False)
    assert (carry.outcome, job(carry).failure) == ("delivered", None)
    assert abs(job(carry).missed_m) < 0.1


def test_it_lies_flat_on_both_stands(carried: Carry) -> None:
    assert carried.trace is not None
    rows = np.array([0, carried.trace.sizes["time"] - 1])
    spec = to_spec(carried.scene)
    place = placements(spec, carried.trace, rows)
    assert np.abs(place.turn).max() < 1e-12
    lowest = place.outline[..., 1].min(axis=1) - floor_level(spec)
    assert lowest == pytest.approx(TOP_M, abs=1e-9)
    pivots = place.pivot[-1, :, 0]
    assert (np.abs(pivots - place.com[-1, 0]) > 0.125 + 0.05).all()  # both robots have left


def test_palms_touch_where_they_should() -> None:
    """A pivot is h + r − r cos θ − p sin θ high when its palm touches, within a tick of the arm."""
    for p in (-0.03, 0.0, 0.02):
        keys = {"start.left_m": p, "start.right_m": p, "robot.noise_m_s": 0.0}
        carry = pb.carry("stand", "shared-sign", overrides=keys)
        assert carry.trace is not None and carry.outcome == "delivered"
        for side, at_s in zip(SIDES, first(carry, "meet"), strict=True):
            then = carry.trace.sel(time=at_s, method="nearest")
            height = float(then.pivot_height.sel(side=side))
            closed = TOP_M + RADIUS_M * (1 - math.cos(STEEP)) - p * math.sin(STEEP)
            slack = RATE_M_S * TICK_S + 0.06 * TICK_S * math.sin(STEEP)
            assert height == pytest.approx(closed, abs=slack)
        raised = min(first(carry, "raise"))
        contact = carry.trace.contact.sel(time=raised, method="nearest").values
        assert contact == pytest.approx(p, abs=2 * 0.06 * TICK_S)


def test_the_object_stands_still_unless_both_palms_carry_it(carried: Carry) -> None:
    """Neither robot moves it while they dock; nothing drags it when they leave."""
    moved = {
        phase: [one.moved_m for one in job(carried).phases if one.phase == phase]
        for phase in ("raise", "down", "done")
    }
    assert np.abs(moved["raise"]).max() < 0.003  # one corner rises by a tick, and sinks
    assert job(carried).moved_m == pytest.approx(max(moved["down"]), abs=1e-6)
    assert abs(job(carried).missed_m) < 0.03


@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_arms_keep_company_from_where_they_touched(loss: float) -> None:
    keys = {"radio.loss": loss, "start.left_m": 0.02, "start.right_m": -0.02, "task.timeout_s": 400}
    carry = pb.carry("stand", "shared-sign", overrides=keys, seed=3)
    assert carry.trace is not None
    begin, end = max(first(carry, "meet")), min(first(carry, "up"))
    height = carry.trace.pivot_height.sel(time=slice(begin, end)).values
    rise = height - height[0]
    found = lifting(carry.scene)
    assert found is not None
    lease_s = 2 * (0.05 + 0.05 + 0.01) + 3 * 0.05
    assert np.ptp(rise, axis=1).max() <= RATE_M_S * (lease_s + 0.05 + TICK_S) + 1e-9
    assert np.abs(height @ [-1, 1]).max() <= found.arms_differ_m


def test_no_arm_raises_the_object_without_the_partners_word() -> None:
    keys = {"radio.loss": 1.0, "task.timeout_s": 300}
    carry = pb.carry("stand", "shared-sign", overrides=keys)
    assert carry.outcome == "stalled" and carry.trace is not None
    assert job(carry).failure == "did not get under the object"
    tall = carry.trace.pivot_height.values.max()
    assert tall <= TOP_M + RADIUS_M * (1 - math.cos(STEEP)) + RATE_M_S * TICK_S


@pytest.mark.parametrize("robot", SIDES)
@pytest.mark.parametrize("phase", ["dock", "touch", "meet", "raise", "carry", "lower", "down"])
def test_a_robot_restarts_in_any_phase(carried: Carry, phase: str, robot: str) -> None:
    at_s = next(
        one.start_s for one in job(carried).phases if (one.robot, one.phase) == (robot, phase)
    )
    fault = {"kind": "reboot", "robot": robot, "at_s": at_s + 0.02, "duration_s": 0.5}
    keys = {"faults.script": [fault]}
    carry = pb.carry("stand", "shared-sign", overrides=keys, record=False)
    assert (carry.outcome, job(carry).failure) == ("delivered", None)


@pytest.mark.parametrize("count", amounts(60, 2000))
def test_random_jobs_succeed_or_are_refused(count: int) -> None:
    refused = 0
    for seed in range(count):
        try:
            ready = prepare(load_scene("stand", random_stand(seed)), "shared-sign")
        except SceneError:
            refused += 1
            continue
        delivered = run_seeds(ready.spec, "shared-sign", seed, 1)["outcome"] == 1
        assert delivered or ready.warnings, seed
    assert refused < count / 2

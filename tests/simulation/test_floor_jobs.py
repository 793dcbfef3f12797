# SPDX-License-Identifier: Apache-2.0
"""Jobs that begin or end on the floor: pick up, carry, put down, against closed forms, the world
without robots, and symmetry."""

import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import SIDES
from palmbots.mechanics.lifting import lifting
from palmbots.scene.placement import placements
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import Carry, FloorWorld, run_seeds
from palmbots.simulation.floor_job import MEANINGS, MISSED, FloorJob
from random_lifts import random_lift

LIFT = load_scene("lift")
RADIUS_M = 0.003
HALF_M = 0.075
GAP_M = 0.03


def job(carry: Carry) -> FloorJob:
    assert carry.floor_job is not None
    return carry.floor_job


def starts(carry: Carry, phase: str) -> list[float]:
    """When each robot first began a phase [s]."""
    first: dict[str, float] = {}
    for one in job(carry).phases:
        if one.phase == phase:
            first.setdefault(one.robot, one.start_s)
    return [first[side] for side in SIDES]


def rows(carry: Carry, name: str, since_s: float, until_s: float) -> np.ndarray:
    assert carry.trace is not None
    return carry.trace[name].sel(time=slice(since_s, until_s)).values


@pytest.fixture(scope="module")
def lifted() -> Carry:
    return pb.carry("lift", "shared-sign")


@pytest.mark.slow
@pytest.mark.parametrize("controller", ["shared-sign", "silent", "resilient", "distributed"])
def test_the_whole_job_succeeds(controller: str) -> None:
    outcomes = run_seeds(to_spec(LIFT), controller, 0, 60, threads=2)["outcome"]
    assert (outcomes == 1).all()


@pytest.mark.parametrize("overrides", [{"task.from": "palms"}, {"task.to": "palms"}])
def test_half_a_job_succeeds(overrides: dict[str, str]) -> None:
    carry = pb.carry("lift", "shared-sign", overrides=overrides)
    names = {phase.phase for phase in job(carry).phases}
    assert carry.outcome == "delivered" and job(carry).failure is None
    assert ("dock" in names) == ("task.to" in overrides)
    assert ("leave_steep" in names) == ("task.from" in overrides)


def test_it_ends_on_the_floor_flat_and_alone(lifted: Carry) -> None:
    assert lifted.trace is not None
    end = lifted.trace.isel(time=-1)
    assert float(end["object"]) == pytest.approx(0, abs=1e-12)
    # Each vertex is at the height of its arc's centre: p and lift are seen from a palm at θ.
    for k in range(2):
        theta, p = float(end.palm[k]), float(end.contact[k])
        high = float(end.pivot_height[k]) + p * math.sin(theta)
        high += (float(end.vertex_height[k]) + RADIUS_M) * math.cos(theta)
        assert high == pytest.approx(RADIUS_M, abs=1e-12)
        assert p < -HALF_M


def test_where_the_object_ends(lifted: Carry) -> None:
    """The displacement of the COM in the trace is that which is reported."""
    assert lifted.trace is not None
    place = placements(to_spec(LIFT), lifted.trace, np.array([0, lifted.trace.sizes["time"] - 1]))
    moved = place.com[1, 0] - place.com[0, 0]
    assert job(lifted).moved_m == pytest.approx(moved, abs=1e-12)
    assert job(lifted).missed_m == pytest.approx(moved - 1.5, abs=1e-12)


def test_noses_follow_the_floor_until_both_are_ready(lifted: Carry) -> None:
    """The pivot is at the height ℓ sin θ + n cos θ while its nose, n thick, is on the floor."""
    raised = min(starts(lifted, "raise"))
    angle = rows(lifted, "palm", 0, raised)
    height = rows(lifted, "pivot_height", 0, raised)
    level = HALF_M * np.sin(angle) + np.maximum(
        0.0003 * np.cos(angle), 0.0015 * np.cos(angle) - 0.008 * np.sin(angle)
    )
    assert np.abs(height - level).max() < 1e-12
    assert len(np.unique(angle)) > 10  # they turn meanwhile


def test_arms_keep_rate_height_and_company(lifted: Carry) -> None:
    """In the air the arms differ by at most what one moves while the other does not know it, and
    by what the palms differed on the floor."""
    begin, end = min(starts(lifted, "raise")), max(starts(lifted, "down"))
    height = rows(lifted, "pivot_height", begin, end)
    assert np.abs(np.diff(height, axis=0)).max() <= 0.05 * 0.01 + 1e-12
    carried = rows(lifted, "pivot_height", max(starts(lifted, "carry")) + 0.1, begin + 20)
    assert np.ptp(carried, axis=0).max() == 0
    assert np.abs(carried - 0.15).max() <= 0.002
    spread = HALF_M * (math.sin(math.radians(15)) - math.sin(math.radians(5)))
    lease_s = 2 * (0.05 + 0.05 + 0.01) + 3 * 0.05
    apart = np.abs(height[:, 0] - height[:, 1]).max()
    assert apart <= spread + 0.05 * (lease_s + 0.05 + 0.01) + 2 * 0.002


@pytest.mark.parametrize("controller", ["shared-sign", "resilient"])
def test_arms_that_differ_while_they_move_lose_nothing(controller: str) -> None:
    """Property 1 fails meanwhile; property 0 holds."""
    keys: dict[str, Any] = {"object": "bottle", "radio.loss": 0.4, "task.distance_m": 0.1}
    found = lifting(load_scene("lift", keys))
    apart = 0.0
    for seed in range(12):
        carry = pb.carry("lift", controller, seed=seed, overrides=keys | {"task.timeout_s": 300})
        assert carry.outcome == "delivered"
        height = rows(
            carry, "pivot_height", min(starts(carry, "raise")), max(starts(carry, "down"))
        )
        apart = max(apart, float(np.abs(height[:, 0] - height[:, 1]).max()))
    assert found is not None and found.permitted_rise_m < apart <= found.arms_differ_m


@pytest.mark.parametrize(
    "keys", [{"object": "bottle"}, {"arm.rate_m_per_s": 0.2}, {"arm.left.rate_m_per_s": 0.15}]
)
def test_a_pair_that_corrects_at_level_pivots_only(keys: dict[str, Any]) -> None:
    """It raises the object before it centres the contacts, and its wheels stand while its arms
    move."""
    carry = pb.carry("lift", "shared-sign", overrides=keys)
    assert carry.outcome == "delivered"
    assert not {"centre", "ready", "recentre"} & {one.phase for one in job(carry).phases}
    for first, last in (("poised", "up"), ("arrived", "down")):
        since, until = max(starts(carry, first)) + 0.02, min(starts(carry, last)) - 0.02
        assert until - since > 0.5
        assert np.abs(rows(carry, "commanded", since, until)).max() == 0


def test_no_arm_rises_without_the_partners_word() -> None:
    carry = pb.carry("lift", "shared-sign", overrides={"radio.loss": 1.0, "task.timeout_s": 300})
    assert carry.outcome == "stalled"
    assert job(carry).failure == "did not get under the object"
    assert carry.time_s < 200 and "time limit" not in str(carry)  # they give up by themselves
    height = rows(carry, "pivot_height", 0, 200)
    assert height.max() <= HALF_M * math.sin(math.radians(15)) + 0.0003


@pytest.mark.parametrize("at_s", [3.0, 9.0, 20.0, 38.0, 40.5])
@pytest.mark.parametrize("robot", SIDES)
def test_a_robot_restarts_in_any_phase(at_s: float, robot: str) -> None:
    fault = {"kind": "reboot", "robot": robot, "at_s": at_s, "duration_s": 0.5}
    carry = pb.carry("lift", "shared-sign", overrides={"faults.script": [fault]})
    assert carry.outcome == "delivered", (job(carry).failure, carry.reason)


def test_a_retreat_drags_the_object_no_farther_than_a_robot_drives() -> None:
    """A robot waits below one corner for a partner that is off, and then retreats."""
    rng = np.random.default_rng(20)
    farthest = 0.0
    for seed in range(20):
        off = {"kind": "reboot", "robot": str(rng.choice(SIDES)), "at_s": float(rng.uniform(0, 6))}
        keys: dict[str, Any] = {
            "palm.friction": float(rng.uniform(0.29, 0.45)),
            "floor.friction": float(rng.uniform(0.1, 0.6)),
            "robot.noise_m_s": 0.0,
            "faults.script": [off | {"duration_s": 60}],
            "task.timeout_s": 70.0,
        } | ({"object": "bottle"} if rng.random() < 0.5 else {})
        drives = 1.5 * to_spec(load_scene("lift", keys)).palms[0].usable
        phases = job(pb.carry("lift", "shared-sign", seed=seed, overrides=keys)).phases
        for begun in (one for one in phases if one.phase == "back_off"):
            ended = next(
                one for one in phases if (one.robot, one.start_s) == (begun.robot, begun.end_s)
            )
            farthest = max(farthest, abs(ended.moved_m - begun.moved_m) / drives)
    assert 0.2 < farthest < 1  # 0.44


def test_a_robot_that_stays_off_leaves_the_object_in_the_air() -> None:
    """Its partner stops and holds; it does not lower alone."""
    fault = {"kind": "reboot", "robot": "left", "at_s": 9.0, "duration_s": 100}
    carry = pb.carry(
        "lift", "shared-sign", overrides={"faults.script": [fault], "task.timeout_s": 60}
    )
    assert (carry.outcome, job(carry).failure) == ("stalled", "did not raise the object")
    later = rows(carry, "pivot_height", 11, 60)
    assert np.ptp(later, axis=0).max() == 0 and later[0].min() > 0.03


def test_without_a_heel_it_is_refused() -> None:
    with pytest.raises(pb.SceneError, match=r"palm.heel_m: value is 0 .* the robots jam"):
        pb.carry("lift", "shared-sign", overrides={"palm.heel_m": 0.0})


@pytest.mark.parametrize("nose_m", [0.0005, 0.001, 0.0015])
def test_noses_of_any_thickness_lift(nose_m: float) -> None:
    """The object falls off them as the robots leave, and may fall while they dock. It is so light
    that the robots push hard enough under the thickest one; the world does not know forces."""
    keys = {"palm.nose_m": nose_m, "palm.thickness_m": 0.0015, "object.mass_kg": 0.15}
    carry = pb.carry("lift", "shared-sign", overrides=keys)
    assert (carry.outcome, job(carry).failure) == ("delivered", None)


@pytest.mark.parametrize("seed", [42, 284, 838])
def test_contacts_that_cannot_be_centred_on_the_floor_are_centred_in_the_air(seed: int) -> None:
    """There one robot would centre again and again, and its partner could not."""
    carry = pb.carry("lift", "shared-sign", overrides=random_lift(seed))
    assert "centre" not in {phase.phase for phase in job(carry).phases}
    assert (carry.outcome, job(carry).failure) == ("delivered", None)


@pytest.mark.parametrize("floor", [0.3, 0.5])
def test_small_falls_have_the_height_of_the_closed_form(floor: float) -> None:
    """The last corner comes down on its nose as long as its contact, which leans by ψ, and the
    floor under the other corner hold the object: ψ − φ ≤ φ_floor. The rest of the height is a fall.

    An edge radius above the height of the nose is therefore not enough to come down without one.
    """
    quiet = {"robot.noise_m_s": 0.0, "floor.friction": floor}
    spec = to_spec(load_scene("lift"))
    nose = spec.palms[0].nose * math.cos(spec.palms[0].steep)  # its upper edge above the floor
    lean = 1 - math.cos(math.atan(spec.palms[0].friction) + math.atan(floor))
    enough = nose / lean
    assert enough > 3 * nose
    for share in (0.8, 0.9, 1.05, 1.5):
        radius = share * enough
        found = pb.carry("lift", overrides=quiet | {"object.edge_radius_m": radius}, record=False)
        assert found.floor_job is not None
        down = max(one.start_s for one in found.floor_job.phases if one.phase == "empty")
        falls = [fall for fall in found.floor_job.falls if fall.time_s > down - 0.5]
        if share > 1:
            assert falls == []
            continue
        (fall,) = falls
        assert fall.height_m == pytest.approx(nose - radius * lean, abs=0.03 * nose)
        # The object turns about its other corner: its middle comes down by half of that.
        weight = found.scene.object.mass_kg * 9.81
        assert fall.energy_j == pytest.approx(0.5 * weight * fall.height_m, rel=0.03)


def test_every_phase_says_what_was_missed() -> None:
    assert set(MISSED) == set(MEANINGS)


def test_the_same_motions_without_robots_lead_to_the_same_place() -> None:
    """The palms of `FloorWorld`, moved as the trace says, until both are up, without inertia."""
    carry = pb.carry("lift", "shared-sign", overrides={"task.inertia": False})
    assert carry.trace is not None
    until = round(max(starts(carry, "up")) / 0.01)
    trace = carry.trace
    angle = np.degrees(trace.palm.values[: until + 1])
    height = trace.pivot_height.values[: until + 1]
    side = np.array([-0.5, 0.5])
    pivot = trace.midpoint.values[:, None] + side * trace.separation.values[:, None]
    world = FloorWorld("lift", gaps_m=(GAP_M, GAP_M))
    state = world.state
    for k in range(until):
        left, right = (pivot[k + 1] - pivot[k]).tolist()
        rise = (height[k + 1] - height[k]).tolist()
        state = world.move(
            left, right, up_m=(rise[0], rise[1]), palms_deg=(angle[k + 1, 0], angle[k + 1, 1])
        )
        assert not state.end, k
    for k, one in enumerate(SIDES):
        assert getattr(state.touched_m, one) == pytest.approx(
            float(trace.contact[until, k]), abs=1e-9
        )
    assert state.tilt_deg == pytest.approx(math.degrees(float(trace.object[until])), abs=1e-9)


@pytest.mark.parametrize(
    ("controller", "seed"), [("resilient", 44), ("resilient", 111), ("resilient", 434)]
)
def test_contacts_move_in_the_air_only_as_far_as_palms_drive_them(
    controller: str, seed: int
) -> None:
    """In each of these jobs both contacts slide at once when the inertia of the object changes.

    Contacts that slide on palms of an angle θ move by 1 / cos(θ + tilt) of what the pivots move
    relative to each other, and the palms do at least the work that lifts the object.
    """
    carry = pb.carry("lift", controller, seed=seed)
    assert carry.trace is not None and carry.outcome == "delivered"
    begin, end = max(starts(carry, "up")), min(starts(carry, "lower"))
    trace = carry.trace.sel(time=slice(begin, end))
    steps = np.diff(trace.separation.values)
    turns = np.abs(np.diff(trace.palm.values, axis=0))
    lever = np.abs(trace.contact.values[:-1]) + RADIUS_M
    apart = np.abs(np.diff(trace.pivot_height.values @ [-1, 1]))
    turned = (turns * lever).sum(axis=1)
    slid = np.abs(np.diff(trace.contact.values, axis=0)).max(axis=1)
    steepest = math.radians(15 + 5)  # of a palm, seen from the object, which tilts by less than 5°
    assert np.abs(trace.object.values).max() < math.radians(5)
    assert (slid <= (np.abs(steps) + apart + turned) / math.cos(steepest) + 1e-9).all()
    height = placements(to_spec(LIFT), trace, np.arange(trace.sizes["time"])).com[:, 1]
    lifts = np.abs(np.diff(trace.pivot_height.values, axis=0)).max(axis=1) + turned
    squeeze = math.tan(steepest + math.atan(0.3))  # in weights, at most
    assert (np.diff(height) <= squeeze * np.maximum(0, -steps) + lifts + 1e-9).all()


@pytest.mark.slow
def test_any_number_of_threads_gives_the_same_bits() -> None:
    one, three = (run_seeds(to_spec(LIFT), "resilient", 0, 70, threads=n) for n in (1, 3))
    assert all((one[name] == three[name]).all() for name in one)


def test_a_carry_from_palms_to_palms_has_no_floor() -> None:
    """Keys of arms and floor change nothing of a carry from palms to palms."""
    changed: dict[str, Any] = {"arm.rate_m_per_s": 0.2, "floor.friction": 1.0}
    one, two = (pb.carry("plate", overrides=keys) for keys in ({}, changed))
    assert one.trace_hash == two.trace_hash and one.floor_job is None

# SPDX-License-Identifier: Apache-2.0
"""Jobs that one robot does alone against a wall: pick up, carry, put down, against closed forms,
the world without robots, and symmetry."""

import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import Carry, FloorState, FloorWorld, run_seeds
from palmbots.simulation.floor_job import FloorJob

LONE = load_scene("lone")
PHASES = [
    "scoop", "seat", "ease", "lift", "haul", "set_down", "tip_out", "leave_steep", "retreat",
    "done",
]  # fmt: skip


def job(carry: Carry) -> FloorJob:
    assert carry.floor_job is not None
    return carry.floor_job


@pytest.fixture(scope="module")
def carried() -> Carry:
    return pb.carry("lone", "shared-sign")


@pytest.mark.slow
def test_jobs_succeed_and_end_near_the_wanted_place() -> None:
    place = pb.final_place("lone", "shared-sign", jobs=200)
    assert place.failed == 0
    assert place.half_width_m < 0.02


def test_the_robot_that_leads_passes_all_phases_and_the_other_one_stands(carried: Carry) -> None:
    assert [one.phase for one in job(carried).phases] == PHASES
    assert {one.robot for one in job(carried).phases} == {"right"}
    assert (carried.outcome, job(carried).failure) == ("delivered", None)
    assert carried.trace is not None
    assert (carried.trace.speed.sel(side="left") == 0).all()
    assert carried.distance_m == pytest.approx(1.5, abs=0.01)


def test_the_report_states_the_way_of_the_object_and_no_contacts_of_two_palms(
    carried: Carry,
) -> None:
    moved = f"{job(carried).moved_m:.2f}"
    assert moved != f"{carried.distance_m:.2f}"
    assert str(carried).startswith(f"DELIVERED  {moved} of 1.50 m in ")
    assert "contact rms" not in str(carried)
    title = carried.plot("carry")._suptitle or ""
    texts = [str(title), *(text.get_text() for text in carried.plot("carry").texts)]
    assert any(text.endswith(f" and {moved} m") for text in texts)
    assert not any("rms" in text for text in texts)


def test_the_object_ends_flat_on_the_floor_and_alone(carried: Carry) -> None:
    assert carried.trace is not None
    end = carried.trace.isel(time=-1)
    assert float(end["object"]) == pytest.approx(0, abs=1e-9)
    assert float(end.object_height) == pytest.approx(float(carried.trace.object_height[0]))
    assert float(end.contact.sel(side="right")) < -0.075


def test_the_robot_that_stands_aside_stays_in_place_in_the_trace(carried: Carry) -> None:
    """Its place follows from midpoint and separation, also while the other one stalls at the
    wall."""
    assert carried.trace is not None
    left = carried.trace.midpoint - carried.trace.separation / 2
    assert float(left.max() - left.min()) < 1e-3


def test_the_mirrored_job_is_the_mirrored_one(carried: Carry) -> None:
    other = pb.carry("lone", "shared-sign", overrides={"task.direction": "backward"})
    assert job(other).moved_m == job(carried).moved_m
    assert [(p.phase, p.start_s) for p in job(other).phases] == [
        (p.phase, p.start_s) for p in job(carried).phases
    ]


def test_the_controller_has_nothing_to_do(carried: Carry) -> None:
    other = pb.carry("lone", "distributed")
    assert job(other) == job(carried)


def test_the_object_falls_as_far_as_the_closed_form_says(carried: Carry) -> None:
    closed = pb.analyze("lone").lone
    assert closed is not None
    falls = [fall for fall in job(carried).falls if fall.height_m > 5e-4]
    assert [fall.height_m for fall in falls] == [pytest.approx(closed.fall_m, rel=0.15)]


def test_a_slide_at_the_friction_angle_counts_for_nearly_nothing() -> None:
    """The object slides down by 2.4 mm, slowly, however little of a fall is permitted."""
    carry = pb.carry("lone", "shared-sign", overrides={"world.fall_m": 2e-4})
    assert carry.outcome == "delivered"
    assert max(fall.height_m for fall in job(carry).falls) > 2e-3


def test_a_restart_with_the_object_in_the_air_ends_on_the_floor() -> None:
    fault = {"robot": "right", "kind": "reboot", "at_s": 20.0, "duration_s": 0.1}
    carry = pb.carry("lone", "shared-sign", overrides={"faults.script": [fault]})
    assert carry.outcome == "stalled"
    failure = job(carry).failure
    assert failure is not None and failure.startswith("a robot restarted")
    assert carry.trace is not None
    low = to_spec(LONE).palms[1].lowest_pivot(math.radians(6))
    end = carry.trace.isel(time=-1)
    assert float(end.pivot_height.sel(side="right")) == pytest.approx(low)
    assert np.isfinite(float(end["object"]))


def test_a_restart_before_the_lift_begins_again() -> None:
    fault = {"robot": "right", "kind": "reboot", "at_s": 5.0, "duration_s": 0.1}
    carry = pb.carry("lone", "shared-sign", overrides={"faults.script": [fault]})
    assert (carry.outcome, job(carry).failure) == ("delivered", None)


def put_down(steep_deg: float, keys: dict[str, Any] | None = None) -> tuple[FloorState, float]:
    """By hand: where the object is after the palm has left, and how far it moved meanwhile."""
    world = FloorWorld(
        "lone", palms_deg=(25.0, 6.0), gaps_m=(None, 0.005), overrides=dict(keys or {})
    )
    state = world.state
    while state.pivots_m.right[0] > -0.004:  # the nose is in front of the wall
        state = world.move(right_m=-0.001)
        assert not state.end
    state = world.move(right_m=0.3)
    before = state.com_m[0]
    for angle in np.arange(7.0, steep_deg + 0.5):
        state = world.move(palms_deg=(25.0, float(angle)), follow_floor=True)
        assert not state.end
    for _ in range(100):
        state = world.move(right_m=0.003)
        if state.touched_m.right is None:
            break
    return state, state.com_m[0] - before


def test_a_palm_below_the_friction_angle_takes_the_object_along() -> None:
    """Closed form: it slides off only if θ > φ = 16.7°."""
    kept, way = put_down(15.0)
    assert kept.touched_m.right is not None and way > 0.29
    put, way = put_down(20.0)
    assert put.touched_m.right is None and put.on_floor
    assert put.tilt_deg == pytest.approx(0, abs=1e-6)
    assert abs(way) < 0.02


@pytest.mark.slow
def test_many_jobs_succeed_with_the_noise_of_the_scene() -> None:
    outcomes = run_seeds(to_spec(LONE), "shared-sign", 0, 60, threads=2)["outcome"]
    assert (outcomes == 1).all()

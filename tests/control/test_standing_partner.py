# SPDX-License-Identifier: Apache-2.0
"""A robot whose partner stops dead notices it by touch, where its own contact slides."""

from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_seeds

STOP_S, LASTS_S = 5.0, 10.0


def stop_of(side: str, lasts_s: float = LASTS_S) -> dict[str, Any]:
    fault = {"kind": "reboot", "robot": side, "at_s": STOP_S, "duration_s": lasts_s}
    return {"faults.script": [fault], "task.timeout_s": 100.0}


def other(side: str) -> str:
    return "right" if side == "left" else "left"


def slippery(side: str) -> dict[str, Any]:
    """Between equal palms the contact on this palm slides."""
    return {f"palm.{side}.friction": 0.2, f"palm.{other(side)}.friction": 0.4}


CASES = [
    (controller, stops, direction)
    for controller in ("silent", "shared-sign")
    for stops in ("left", "right")
    for direction in ("forward", "backward")
]


@pytest.mark.parametrize(("controller", "stops", "direction"), CASES)
def test_robot_whose_contact_slides_stops_too_and_travels_again_with_its_partner(
    controller: str, stops: str, direction: str
) -> None:
    goes = other(stops)
    keys = {"robot.noise_m_s": 0.0, "task.direction": direction} | stop_of(stops) | slippery(goes)
    carry = pb.carry("paper", controller, overrides=keys)
    assert carry.outcome == "delivered"
    assert carry.trace is not None
    speed = abs(carry.trace["commanded"].sel(side=goes))
    standing = speed.sel(time=slice(STOP_S + 1.0, STOP_S + LASTS_S))
    # It stands, but for the moments in which a leader backs and tries again.
    assert float((standing == 0).mean()) > 0.6
    # Both travel again soon: in the last seconds at the nominal speed.
    ends = STOP_S + LASTS_S
    late = abs(carry.trace["commanded"].sel(time=slice(ends + 5.0, ends + 8.0)))
    assert late.sizes["time"] > 100
    assert float(late.mean()) == pytest.approx(0.06, abs=0.005)


@pytest.mark.parametrize("controller", ["silent", "shared-sign"])
@pytest.mark.parametrize("stops", ["left", "right"])
def test_without_the_brake_the_object_is_lost(controller: str, stops: str) -> None:
    keys = {"robot.noise_m_s": 0.0, "control.brake": False} | stop_of(stops)
    carry = pb.carry("paper", controller, overrides=keys | slippery(other(stops)))
    assert (carry.outcome, carry.reason) == ("dropped", "off-palm")


@pytest.mark.parametrize("controller", ["silent", "shared-sign"])
def test_neither_robot_waits_for_the_other_without_end(controller: str) -> None:
    """The follower has stopped outward and the leader inward, although both would go on."""
    jammed = [{"sender": side, "start_s": 0.0, "end_s": 200.0} for side in ("left", "right")]
    keys = {
        "robot.noise_m_s": 0.0, "start.left_m": 0.05, "start.right_m": -0.05,
        "task.distance_m": 3.0, "task.timeout_s": 200.0, "radio.outages": jammed,
    }  # fmt: skip
    carry = pb.carry("paper", controller, overrides=keys)
    assert carry.outcome == "delivered"
    assert carry.trace is not None
    commanded = carry.trace["commanded"].to_numpy()
    assert (commanded == 0).all(axis=1).any()  # both had stopped


def test_leader_starts_when_it_feels_that_the_follower_has_started() -> None:
    """Its contact leaves the zero zone outward; until then it stands."""
    for direction, follower in (("forward", "left"), ("backward", "right")):
        keys = {"robot.noise_m_s": 0.0, "control.start": "touch", "task.direction": direction}
        carry = pb.carry("paper", "silent", overrides=keys)
        assert carry.outcome == "delivered"
        assert carry.trace is not None
        leader = carry.trace.sel(side=other(follower))
        before = leader["sign"].to_numpy() == 0
        first = int(np.argmin(before))  # the tick at which the sign changes
        assert first > 5
        assert (leader["commanded"].to_numpy()[:first] == 0).all()
        assert leader["sign"].to_numpy()[first] == 1
        assert abs(leader["commanded"].to_numpy()[first]) > 0.06
        goes = np.abs(carry.trace["commanded"].sel(side=follower).to_numpy()[:first])
        assert goes == pytest.approx(0.06)


def test_where_the_leader_feels_nothing_both_robots_stand() -> None:
    """The follower's contact slides instead, so that it stops before the object is lost."""
    keys = {"control.start": "touch", "task.timeout_s": 40.0} | slippery("left")
    carry = pb.carry("paper", "silent", overrides=keys)
    assert carry.outcome == "stalled"
    assert max(carry.contact_peak_m.values()) < 0.05


def test_start_by_touch_drops_hardly_more_than_a_start_together() -> None:
    """Also with the centre of mass at the follower, whose contact then does not come back."""
    keys: dict[str, Any] = {
        "control.start": "touch", "object.com_m": (0.095, 0.04), "robot.noise_m_s": 0.02,
    }  # fmt: skip
    assert share("silent", 2, **keys) < 0.08
    assert share("silent", 1, **keys) > 0.92


def test_follower_starts_also_with_its_contact_outward() -> None:
    """It pushes until the leader must have started, and corrects afterwards."""
    keys: dict[str, Any] = {
        "control.start": "touch", "start.left_m": 0.02, "robot.noise_m_s": 0.01,
    }  # fmt: skip
    assert share("silent", 1, **keys) == 1.0


def test_follower_is_steep_at_the_start_until_the_leader_must_have_felt_it() -> None:
    """It crosses the zone of 10 mm at 6 cm/s, 0.06 s late because it accelerates."""
    keys = {"robot.noise_m_s": 0.0, "control.start": "touch", "palm.rate_deg_s": 1000.0}
    trace = pb.carry("paper", "silent", overrides=keys).trace
    assert trace is not None
    palm = np.degrees(trace["palm"].sel(side="left").to_numpy())
    first = int(np.argmax(palm < 14.0))
    assert float(trace["time"][first]) == pytest.approx(0.23, abs=0.02)


def share(controller: str, outcome: int, count: int = 400, **keys: Any) -> float:
    scene = load_scene("paper", {key.replace("__", "."): value for key, value in keys.items()})
    return float((run_seeds(to_spec(scene), controller, 0, count)["outcome"] == outcome).mean())


RANDOM: dict[str, Any] = {
    "faults.random_reboots": 1, "faults.reboot_s": LASTS_S, "robot.noise_m_s": 0.02,
    "task.timeout_s": 100.0,
}  # fmt: skip
# With 400 carries, a rate at least 0.1 below the limit exceeds it with a probability below 1e-5.


@pytest.mark.parametrize(("controller", "most"), [("silent", 0.17), ("shared-sign", 0.25)])
def test_most_stops_at_random_times_are_noticed(controller: str, most: float) -> None:
    assert share(controller, 2, **RANDOM) < most
    assert share(controller, 2, **RANDOM | {"control.brake": False}) > 0.85


def test_leader_that_tries_again_notices_that_its_partner_still_stands() -> None:
    """A stop of 30 s outlasts its wait; without a steep palm it would lose twice as many."""
    assert share("shared-sign", 2, 1000, **RANDOM | {"faults.reboot_s": 30.0}) < 0.2


def test_follower_that_stops_is_noticed_and_leader_is_not_without_noise() -> None:
    """Both palms are shallow, and the robot that brakes pushes the object forwards: the leader's
    contact slides in both cases, also when it is the leader that stands."""
    keys = {"robot.noise_m_s": 0.0}
    follower = pb.carry("paper", "silent", overrides=keys | stop_of("left"))
    leader = pb.carry("paper", "silent", overrides=keys | stop_of("right"))
    assert follower.outcome == "delivered"
    assert leader.outcome == "dropped"

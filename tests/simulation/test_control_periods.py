# SPDX-License-Identifier: Apache-2.0
"""Robots with a longer control period than the carry's tick."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.control.registry import shipped_names
from palmbots.control.resilient_timing import bounds_of

CONTROLLERS = shipped_names("robots", "station")
LONGER = {"robot.left.period_s": 0.03, "robot.right.period_s": 0.02}


def carried(controller: str, overrides: dict[str, Any], seed: int = 3, **options: Any) -> Any:
    return pb.carry(pb.load_scene("paper", overrides), controller, seed=seed, **options)


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_the_period_of_the_carry_changes_nothing(controller: str) -> None:
    own = {"robot.period_s": 0.01, "robot.right.period_s": 0.01}
    assert carried(controller, own).trace_hash == carried(controller, {}).trace_hash


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_a_robot_acts_only_at_its_own_steps(controller: str) -> None:
    """Seen from outside: a palm or a wheel that begins to move does so after a step."""
    done = carried(controller, LONGER | {"robot.noise_m_s": 0.02}, record=True)
    trace = done.trace
    for side, stride in ((0, 3), (1, 2)):
        speed, palm = (np.asarray(trace[name][:, side]) for name in ("commanded", "palm"))
        starts_to_turn = (palm[2:] != palm[1:-1]) & (palm[1:-1] == palm[:-2])
        changes = np.flatnonzero(speed[1:] != speed[:-1]) + 1
        turns = np.flatnonzero(starts_to_turn) + 1
        assert len(changes) > 10
        assert set(changes % stride) | set(turns % stride) == {0}
    for message in done.message_log:
        if message.sender != "station":
            stride = 3 if message.sender == "left" else 2
            assert round(message.sent_s / 0.01) % stride == 0


@pytest.mark.parametrize("seed", range(3))
def test_a_robot_reacts_in_its_next_step(seed: int) -> None:
    """`silent` begins a correction in the first step in which the contact reads + or -."""
    trace = carried("silent", LONGER | {"control.brake": False}, seed, record=True).trace
    for side, stride in ((0, 3), (1, 2)):
        sign, case = (np.asarray(trace[name][:, side]) for name in ("sign", "case"))
        steps = np.arange(0, len(sign), stride)
        for before, step in pairwise(steps):
            assert (case[before:step] == case[before]).all()
            if sign[step] > 0 and case[before] == " ":
                assert case[step] == "a"


def test_the_bounds_of_the_resilient_algorithm_count_the_longer_period() -> None:
    """By hand, in ticks: T = 10 ms, D = 5, B = 2 (a beacon each 20 ms), W = 10, S = 3, K = 6."""
    one = bounds_of(pb.load_scene("paper", {"radio.beacon_s": 0.02}))
    three = bounds_of(pb.load_scene("paper", {"radio.beacon_s": 0.02, **LONGER}))
    assert three.shortest_lease_s == pytest.approx(one.shortest_lease_s + 6 * 2 * 0.01)
    assert one.shortest_lease_s == pytest.approx(0.01 * (2 * (5 + 2) + 2))
    fixed = {"radio.beacon_s": 0.02, "radio.lease_s": 0.4}
    one, three = (bounds_of(pb.load_scene("paper", fixed | o)) for o in ({}, LONGER))
    assert three.hold_s == pytest.approx(one.hold_s + 0.02)


@pytest.mark.parametrize("seed", range(4))
def test_no_object_is_dropped_when_robots_reboot_and_lose_messages(seed: int) -> None:
    """On perfect wheels: skew alone, within the bounds."""
    overrides = LONGER | {
        "robot.noise_m_s": 0.0, "robot.left.bias_m_s": 0.002, "radio.loss": 0.2,
        "faults.random_reboots": 2,
    }  # fmt: skip
    done = carried("resilient", overrides, seed)
    assert done.outcome == "delivered"

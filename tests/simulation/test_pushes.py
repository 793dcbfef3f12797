# SPDX-License-Identifier: Apache-2.0
"""Pushes of robots: how far they move a robot."""

import numpy as np
import pytest

import palmbots as pb

PUSHES = [
    {"robot": "left", "at_s": 0.5, "duration_s": 0.25, "speed_m_s": 0.08},
    {"robot": "right", "at_s": 0.6, "duration_s": 0.3, "speed_m_s": -0.04},
]
SHORT = {"task.distance_m": 0.3}


def separations(**keys: object) -> np.ndarray:
    result = pb.carry("paper", "none", overrides={"robot.noise_m_s": 0.0, **SHORT, **keys})
    assert result.trace is not None
    return result.trace["separation"].to_numpy()


def test_a_push_moves_its_robot_by_speed_times_duration() -> None:
    moved = np.diff(separations(**{"bumps.pushes": PUSHES}))
    expected = np.zeros_like(moved)
    expected[50:75] += 0.01 * 0.08
    expected[60:90] -= 0.01 * 0.04
    np.testing.assert_allclose(moved, expected, atol=1e-15)
    assert np.ptp(separations()) == 0  # without a push nothing moves


def test_a_push_adds_to_a_calibration_error() -> None:
    bias = {"robot.left.bias_m_s": 0.002}
    both = separations(**{"bumps.pushes": PUSHES[:1]}, **bias)
    alone = separations(**bias)
    np.testing.assert_allclose(both[76] - alone[76], 0.08 * 0.25, atol=1e-12)


def test_a_push_of_speed_zero_changes_no_bit() -> None:
    still = [{**PUSHES[0], "speed_m_s": 0.0}]
    with_push = pb.carry("paper", seed=4, overrides={**SHORT, "bumps.pushes": still})
    assert with_push.trace_hash == pb.carry("paper", seed=4, overrides=SHORT).trace_hash


def test_brakes_hold_a_robot_against_a_push() -> None:
    off = [{"kind": "reboot", "robot": "right", "at_s": 0.1, "duration_s": 5.0}]
    late = [{"robot": "right", "at_s": 2.0, "duration_s": 0.5, "speed_m_s": 0.05}]
    keys = {"robot.noise_m_s": 0.0, "faults.script": off, "task.timeout_s": 3.0}
    hashes = {
        pb.carry("paper", "resilient", overrides={**keys, "bumps.pushes": pushes}).trace_hash
        for pushes in ([], late)
    }
    assert len(hashes) == 1


def test_a_push_moves_the_robots_of_the_mujoco_world() -> None:
    pytest.importorskip("mujoco")
    keys = {"robot.noise_m_s": 0.0, "task.distance_m": 0.08}
    push = {"robot": "left", "at_s": 0.6, "duration_s": 0.25, "speed_m_s": 0.04}
    ends = []
    for pushes in ([], [push]):
        overrides = {**keys, "bumps.pushes": pushes}
        trace = pb.carry("paper", "none", world="mujoco", overrides=overrides).trace
        assert trace is not None
        ends.append(float(trace["separation"][-1]))
    still, moved = ends
    assert moved - still == pytest.approx(0.25 * 0.04, abs=5e-4)

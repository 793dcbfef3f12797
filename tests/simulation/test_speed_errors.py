# SPDX-License-Identifier: Apache-2.0
"""Gain and white part of the robots' speeds, in whole carries, and that a robot which stands has no
error."""

import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb

QUIET: dict[str, Any] = {"robot.noise_m_s": 0.0, "task.distance_m": 0.3}
WORLDS = ("quasistatic", "mujoco")


def travelled(carry: Any, side: str) -> Any:
    """The way of one robot over the carry [m]."""
    trace = carry.trace
    half = 0.5 * (trace.separation - trace.separation[0])
    return trace.midpoint + (half if side == "right" else -half)


def test_the_same_gain_of_both_robots_scales_time() -> None:
    """Without noise the pair arrives sooner by the gain, but for the ramp at the start."""
    usual = pb.carry("paper", "none", overrides=QUIET).time_s
    fast = pb.carry("paper", "none", overrides={**QUIET, "robot.gain": 1.25}).time_s
    ramp = 0.06 / 0.5
    assert fast - ramp / 2 == pytest.approx((usual - ramp / 2) / 1.25, abs=2e-3)


@pytest.mark.parametrize("world", WORLDS)
def test_unequal_gains_drive_the_robots_apart(world: str) -> None:
    keys = {**QUIET, "task.distance_m": 0.1, "robot.right.gain": 1.1, "robot.left.gain": 0.95}
    found = pb.carry("paper", "none", world=world, overrides=keys)
    ways = [float(travelled(found, side)[-1]) for side in ("left", "right")]
    assert ways[1] / ways[0] == pytest.approx(1.1 / 0.95, rel=0.01)


def test_gains_are_drawn_for_each_carry_and_robot() -> None:
    keys = {**QUIET, "robot.gain_sd": 0.05, "robot.left.gain": 1.1, "task.distance_m": 0.05}
    speeds = np.array(
        [
            [np.diff(travelled(found, side)).max() for side in ("left", "right")]
            for found in (pb.carry("paper", "none", seed=k, overrides=keys) for k in range(150))
        ]
    )
    gains = speeds / (0.06 * 0.01)
    assert gains.mean(axis=0) == pytest.approx([1.1, 1.0], abs=4 * 0.05 / math.sqrt(150))
    assert gains.std(axis=0) == pytest.approx(0.05, rel=4 / math.sqrt(300))
    assert abs(np.corrcoef(gains.T)[0, 1]) < 4 / math.sqrt(150)


@pytest.mark.parametrize("world", WORLDS)
def test_a_robot_that_stands_has_no_error(world: str) -> None:
    """Brakes end gain, bias, noise and white part: the left robot never starts, and never moves."""

    class Stands:
        def step(self, seen: Any) -> Any:
            from palmbots.control import StepOutput

            return StepOutput(palm="steep", move="hold", stop=True)

    errors = {
        "robot.noise_m_s": 0.02, "robot.bias_m_s": 0.01, "robot.gain_sd": 0.05,
        "robot.white_noise_m_per_sqrt_s": 0.02, "task.timeout_s": 1.0,
    }  # fmt: skip
    found = pb.carry("paper", Stands, world=world, overrides=errors)
    for side in ("left", "right"):
        assert np.abs(travelled(found, side)).max() < (1e-12 if world == "quasistatic" else 1e-3)

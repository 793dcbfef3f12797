# SPDX-License-Identifier: Apache-2.0
"""The paper's algorithm as a policy is the paper's algorithm as a controller."""

from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.learn import carry_v0
from palmbots.learn.baseline_policies import Baseline, SilentBaseline, run_episode

HARD = {
    "robot.noise_m_s": 0.02,
    "object.com_m": [0.118, 0.06],
    "palm.left.friction": 0.25,
    "tactile.false_rate": 0.003,
    "radio.jitter_s": 0.05,
    "radio.duplicate": 0.1,
    "bumps.rate_per_m": 3.0,
    "task.slope_deg": 0.5,
    "task.direction": "backward",
}
OVERTAKING = {"radio.jitter_s": 0.2, "radio.reorder": True, "robot.noise_m_s": 0.015}
LOSING = {"radio.loss": 0.05}
FROZEN = {
    "faults.script": [
        {
            "kind": "freeze",
            "robot": "left",
            "at_s": 2.0,
            "duration_s": 0.3,
        },  # the watchdog restarts it,
        {"kind": "freeze", "robot": "right", "at_s": 5.0, "duration_s": 0.08},
        {"kind": "stuck", "robot": "right", "at_s": 6, "duration_s": 0.5, "stuck_at": "0"},
    ]
}
# Palms that turn within a tick: they are there when they are first looked at again.
SNAPPY = {"palm.rate_deg_s": 2000}
# Everything but `case`: a policy does not report its cases to the environment.
SAME = (
    "contact", "vertex_height", "palm", "speed", "commanded", "separation", "midpoint", "object",
    "sign",
    "motion",
)  # fmt: skip


@pytest.mark.parametrize(
    "overrides", [{}, HARD, OVERTAKING, LOSING, FROZEN, SNAPPY], ids=lambda o: str(len(o))
)
@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_baseline_reproduces_the_carry_bit_for_bit(overrides: dict[str, Any], seed: int) -> None:
    known = pb.carry("paper", "distributed", seed=seed, overrides=overrides)
    env = carry_v0.parallel_env("paper", overrides=overrides, record=True)
    played = run_episode(env, seed=seed)
    carry = env.carry("distributed")
    assert (carry.outcome, carry.reason) == (
        known.outcome,
        known.reason,
    ) and played.outcome == known.outcome
    assert carry.trace_hash == known.trace_hash and carry.time_s == known.time_s
    assert carry.message_log == known.message_log and carry.links == known.links
    assert carry.bump_count == known.bump_count and carry.contact_events == known.contact_events
    assert carry.contact_rms_m == known.contact_rms_m
    assert carry.trace is not None and known.trace is not None
    for name in SAME:
        assert np.array_equal(carry.trace[name], known.trace[name]), name


def test_compared_carries_differ_in_outcome_and_losses() -> None:
    """They hold deliveries and drops, losses, copies and bumps."""
    ends, bumps, lost = set(), 0, 0
    for overrides in (HARD, LOSING):
        for seed in range(4):
            known = pb.carry("paper", "distributed", seed=seed, overrides=overrides, record=False)
            ends.add(known.outcome)
            bumps += known.bump_count
            lost += known.messages_lost
    assert len(ends) >= 2 and bumps > 5 and lost > 1


def test_baseline_reproduces_the_carry_in_mujoco() -> None:
    short = {"task.distance_m": 0.3}
    known = pb.carry("paper", "distributed", world="mujoco", seed=2, overrides=short)
    env = carry_v0.parallel_env("paper", overrides=short, world="mujoco", record=True)
    run_episode(env, seed=2)
    carry = env.carry("distributed")
    assert carry.trace_hash == known.trace_hash and len(known.corrections) > 3
    assert carry.trace is not None and known.trace is not None
    assert np.array_equal(carry.trace["force"], known.trace["force"])
    assert carry.mujoco_record is not None and known.mujoco_record is not None
    assert np.array_equal(carry.mujoco_record.states, known.mujoco_record.states)


def test_slower_decisions_cost_reward() -> None:
    """A hundred decisions a second, four, two: the contacts wander farther."""
    rms = []
    for ticks in (1, 25, 50):
        env = carry_v0.parallel_env(ticks_per_step=ticks)
        squares = []
        for seed in range(6):
            run_episode(env, seed=seed)
            squares += [p**2 for p in env.carry().contact_rms_m.values()]
        rms.append(float(np.mean(squares)) ** 0.5)
    assert 1.2 * rms[0] < rms[1] < rms[2]


def test_baseline_returns_more_than_doing_nothing() -> None:
    class Nothing:
        def act(self, observation: Any) -> Any:
            return np.zeros(3, np.int64)

    env = carry_v0.parallel_env()
    paper = [run_episode(env, seed=seed) for seed in range(5)]
    nothing = [run_episode(env, Nothing, seed=seed) for seed in range(5)]
    assert {one.outcome for one in paper} == {"delivered"}
    assert all(1.99 < one.returned < 2 for one in paper)
    assert max(one.returned for one in nothing) < min(one.returned for one in paper)
    drops = [one for one in nothing if one.outcome == "dropped"]
    assert drops and all(-1.1 < one.returned < 0 for one in drops)


@pytest.mark.parametrize("messages", [True, False])
@pytest.mark.parametrize("overrides", [{"robot.noise_m_s": 0.03}, {"start.left_m": 0.03, **LOSING}])
def test_silent_baseline_reproduces_the_carry_bit_for_bit(
    overrides: dict[str, Any], messages: bool
) -> None:
    """In an environment no robot stops, so the carry has no brake."""
    overrides = overrides | {"control.brake": False}
    known = pb.carry("paper", "silent", seed=3, overrides=overrides)
    env = carry_v0.parallel_env("paper", overrides=overrides, record=True, messages=messages)
    played = run_episode(env, lambda: SilentBaseline("paper", messages), seed=3)
    assert played.outcome == known.outcome
    assert env.carry("silent").trace_hash == known.trace_hash


def test_baseline_holds_while_it_reads_nothing() -> None:
    assert Baseline().act(np.array([0, -1, 1, 0, 0, 0, 0])).tolist() == [0, 0, 0]

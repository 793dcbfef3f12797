"""Slow motion changes nothing but the clock, unless accelerations matter."""

import numpy as np
import pytest

import palmbots as pb
from palmbots.batch import DELIVERED, run_seeds
from palmbots.compare import wilson
from palmbots.dynamic.run import run
from palmbots.dynamic.slow_motion import slow_motion
from palmbots.lowering import lower

BUSY = {
    "robot.noise_m_s": 0.015,
    "robot.left.bias_m_s": 0.002,
    "radio.jitter_s": 0.04,
    "radio.outages": [{"sender": "left", "start_s": 3, "end_s": 3.5}],
    "bumps.script": [{"at_s": 2.0, "robot": "left", "shift_m": 0.004}],
    "faults.script": [{"kind": "freeze", "robot": "left", "at_s": 5.0, "for_s": 0.05}],
}


@pytest.mark.parametrize("seed", [0, 1])
def test_without_inertia_the_path_is_the_same_to_the_last_bit(seed: int) -> None:
    """Factors that are powers of two leave no rounding behind."""
    scene = pb.load_scene("paper", {**BUSY, "task.inertia": False})
    fast, slow = (pb.carry(s, seed=seed) for s in (scene, slow_motion(scene, 2.0)))
    assert fast.trace is not None and slow.trace is not None
    assert slow.outcome == fast.outcome and slow.messages == fast.messages > 10
    assert slow.time_s == 2 * fast.time_s
    for name in ("contact", "separation", "midpoint", "palm", "sign", "case"):
        assert np.array_equal(slow.trace[name], fast.trace[name]), name
    assert np.array_equal(2 * slow.trace["speed"], fast.trace["speed"])


def test_with_inertia_it_is_not() -> None:
    scene = pb.load_scene("paper", BUSY)
    fast, slow = (pb.carry(s) for s in (scene, slow_motion(scene, 2.0)))
    assert fast.trace is not None and slow.trace is not None
    assert not np.array_equal(slow.trace["contact"][:1000], fast.trace["contact"][:1000])


def test_units_say_what_is_slowed() -> None:
    slow = slow_motion(pb.load_scene("paper", BUSY), 4.0)
    assert slow.robot.acceleration_m_s2 == 0.5 / 16 and slow.robot.speed_m_s == 0.06 / 4
    assert slow.palm.rate_deg_s == 50 / 4 and slow.palm.steep_deg == 15
    assert slow.robot.noise_tau_s == 2 and slow.control.period_s == 0.04
    assert slow.radio.outages[0].start_s == 12 and slow.faults.script[0].at_s == 20
    assert slow.dynamic == pb.Scene().dynamic and slow.tactile == pb.Scene().tactile
    with pytest.raises(pb.PalmbotsError, match=r"factor is 0\.0; allowed"):
        slow_motion(pb.Scene(), 0.0)
    with pytest.raises(pb.SceneError, match=r"palm\.rate_deg_s: .* too small"):
        slow_motion(pb.Scene(), 1e6)


def test_at_high_noise_mujoco_delivers_as_often_as_the_quasistatic_world_in_slow_motion() -> None:
    """3 cm/s, where a third of the carries fail: MuJoCo's interval holds the quasistatic rate."""
    scene = pb.load_scene("paper", {"robot.noise_m_s": 0.03, "task.distance_m": 0.5})
    known = run_seeds(lower(slow_motion(scene, 4.0)), "distributed", 0, 4000, "double")["outcome"]
    rate = float((known == DELIVERED).mean())
    n = 60
    delivered = sum(run(scene, "distributed", seed)[0].outcome == "delivered" for seed in range(n))
    low, high = wilson(delivered, n)
    assert low <= rate <= high and high - low < 0.25
    assert 0.6 < rate < 0.95  # neither none nor all

# SPDX-License-Identifier: Apache-2.0
"""`exact-p` and `kalman`: what they may know, how they compare, and that they are labelled."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import palmbots as pb
from paired_drops import more_drops
from palmbots.control.registry import controller_names, reference_names, resolve
from palmbots.optimum.opening import LinearFeedback
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DELIVERED, DROPPED, run_seeds

NAMES = ("exact-p", "exact-p-stopping", "kalman", "kalman-stopping")
SHORT = {"task.distance_m": 0.5}
BLIND = {"tactile.zones": [{"sign": "0", "from_m": -1.0, "to_m": 1.0}]}
"""Every switch reads 0 everywhere."""


def drops(name: str, carries: int, **keys: object) -> NDArray[np.bool_]:
    scene = pb.load_scene("paper", {"task.distance_m": 0.6} | keys)
    run = run_seeds(to_spec(scene), name, 10**6, carries, threads=2)
    return run["outcome"] == DROPPED


def test_they_are_references() -> None:
    assert set(NAMES) < set(reference_names())
    assert not set(NAMES) & set(controller_names())
    for name in NAMES:
        entry = resolve(name)
        assert entry.is_reference and not entry.uses_radio and not entry.preparation
        assert entry.description.startswith("reference with linear feedback")
    assert LinearFeedback(True, False).time_s == 0.4


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "change",
    [
        {},
        {"robot.noise_m_s": 0.0},
        {"task.direction": "backward", "robot.noise_m_s": 0.03},
        {"robot.left.correction_m_s": 0.02, "robot.right.speed_m_s": 0.07},
        {"palm.left.length_m": 0.1},
        {"robot.left.bias_m_s": 0.015},
        {"tactile.false_rate": 0.05},
    ],
)
def test_scenes_with_little_noise_are_delivered(name: str, change: dict[str, object]) -> None:
    run = pb.carry("paper", name, overrides=SHORT | change)
    assert run.outcome == "delivered"
    assert run.messages == 0
    assert any("no robot can run it" in line for line in run.warnings)


@pytest.mark.parametrize("targets_m", [(0.02, 0.01), (-0.02, 0.02)])
def test_contacts_go_to_their_targets(targets_m: tuple[float, float]) -> None:
    """So the attack on the bound also tries contacts at the tips and flat on a palm."""
    maker = LinearFeedback(True, True, targets_m=targets_m)
    entry = replace(resolve("exact-p-stopping"), policy_maker=lambda spec: maker)
    trace = pb.carry("paper", entry).trace
    assert trace is not None
    late = trace["contact"].isel(time=slice(trace.sizes["time"] // 2, None)).mean("time")
    np.testing.assert_allclose(late, targets_m, atol=0.006)


@pytest.mark.slow
def test_exact_coordinates_help_and_stopping_helps() -> None:
    """At a noise at which signs are not enough, on the same seeds."""
    noise = {"robot.noise_m_s": 0.05}
    exact, kalman = (drops(name, 1000, **noise) for name in ("exact-p", "kalman"))
    assert more_drops(kalman, exact) < 1e-3
    for name, before in (("exact-p-stopping", exact), ("kalman-stopping", kalman)):
        assert more_drops(before, drops(name, 1000, **noise)) < 1e-3


def test_kalman_knows_only_what_the_switches_say() -> None:
    """With switches that always read 0, its feedback sees nothing of the contacts: about as many
    objects fall as without a controller. `exact-p` does not use the switches."""
    noise = {"robot.noise_m_s": 0.02}
    without = drops("none", 300, **noise)
    kalman = drops("kalman", 300, **noise, **BLIND)
    assert kalman.mean() > 0.8 * without.mean()
    assert np.array_equal(drops("exact-p", 300, **noise, **BLIND), drops("exact-p", 300, **noise))
    assert not drops("kalman", 300, **noise).any()


def test_exact_coordinates_come_near_the_optimum() -> None:
    noise = {"robot.noise_m_s": 0.045}
    exact, best = (float(drops(name, 2000, **noise).mean()) for name in ("exact-p", "optimal"))
    assert best < 1.5 * exact and exact < 1.5 * best


def test_stopping_costs_no_time_where_it_is_not_needed() -> None:
    scene = pb.load_scene("paper", SHORT | {"robot.noise_m_s": 0.01})
    run = run_seeds(to_spec(scene), "kalman-stopping", 0, 50)
    assert (run["outcome"] == DELIVERED).all()
    assert float(run["time_s"].mean()) < 0.5 / 0.06


@pytest.mark.parametrize("name", ["optimal", *NAMES])
def test_log_of_a_reference_is_replayed(name: str, tmp_path: Path) -> None:
    keys = {"task.distance_m": 0.2, "robot.noise_m_s": 0.03}
    run = pb.carry("paper", name, seed=5, overrides=keys)
    pb.write_log(run, tmp_path / "carry.mcap")
    assert pb.replay(tmp_path / "carry.mcap").identical

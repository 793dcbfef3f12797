# SPDX-License-Identifier: Apache-2.0
"""`optimal` and `optimal-stopping`: near the bound, beaten by no shipped controller, labelled."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

import palmbots as pb
from paired_drops import more_drops, rejected
from palmbots.control.registry import (
    controller_names,
    describe,
    reference_names,
    refusal,
    resolve,
    shipped_names,
)
from palmbots.optimum import optimal_controllers
from palmbots.optimum.opening import COARSE, FINE, Grid, law_m_s, opening_problem, solve
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DELIVERED, DROPPED, Columns, run_seeds
from random_scenes import random_scene

BEST = ("optimal", "optimal-stopping")
COARSEST = Grid(40, 20, 0.5)
STOPS = ("silent", "shared-sign")
"""Shipped controllers whose robots may stop: the others are compared with corrections only."""


def columns(scene: pb.Scene, controller: str, carries: int, first: int = 10**6) -> Columns:
    return run_seeds(to_spec(scene), controller, first, carries, threads=2)


def on_grid(grid: Grid, monkeypatch: pytest.MonkeyPatch) -> None:
    """Solve on this grid, and keep nothing for other tests."""
    monkeypatch.setattr(optimal_controllers, "FINE", grid)
    if grid != FINE:
        monkeypatch.setattr(optimal_controllers, "COARSE", COARSEST)
    monkeypatch.setattr(optimal_controllers, "_policy", optimal_controllers._policy.__wrapped__)


def test_references_are_no_shipped_controllers() -> None:
    assert set(BEST) < set(reference_names())
    assert not set(reference_names()) & {*shipped_names(), *controller_names()}
    for name in BEST:
        entry = resolve(name)
        assert entry.is_reference and not entry.runs_in_lanes
        assert describe(name) is entry
        assert entry.description.startswith("reference with full information")


@pytest.mark.slow
def test_drop_rate_is_near_the_prediction() -> None:
    """The palms turn in finite time, so one contact is farther out than the other: a little more
    drops than the opening problem predicts. Never less, within 4 standard errors."""
    scene = pb.load_scene("paper", {"robot.noise_m_s": 0.045, "task.distance_m": 0.6})
    predicted = solve(opening_problem(to_spec(scene), "corrections"), FINE).drop
    carries = 4000
    found = float(np.mean(columns(scene, "optimal", carries)["outcome"] == DROPPED))
    error = 4 * math.sqrt(predicted * (1 - predicted) / carries)
    assert predicted - error < found < 1.25 * predicted + error


def test_stopping_drops_fewer_and_costs_little_time(monkeypatch: pytest.MonkeyPatch) -> None:
    on_grid(COARSE, monkeypatch)
    scene = pb.load_scene("paper", {"robot.noise_m_s": 0.05, "task.distance_m": 0.6})
    one, two = (columns(scene, name, 400) for name in BEST)
    dropped = [float(np.mean(run["outcome"] == DROPPED)) for run in (one, two)]
    assert dropped[1] < 0.3 * dropped[0]
    times = two["time_s"][two["outcome"] == DELIVERED]
    assert float(np.mean(times.astype(float))) < 1.15 * 0.6 / 0.06


BACKWARD = {"task.direction": "backward", "robot.noise_m_s": 0.03}
UNEQUAL = {"robot.left.correction_m_s": 0.02, "robot.right.speed_m_s": 0.07}


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("optimal", {}),
        ("optimal", {"robot.noise_m_s": 0.0}),
        ("optimal", BACKWARD),
        ("optimal", {"robot.noise_tau_s": 0.05, "robot.noise_m_s": 0.03}),
        ("optimal", UNEQUAL),
        ("optimal", {"palm.left.length_m": 0.1}),
        ("optimal-stopping", BACKWARD),
        ("optimal-stopping", UNEQUAL),
    ],
)
def test_scenes_with_little_noise_are_delivered(
    name: str, change: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """On very coarse grids: nobody looks at a drop rate here."""
    on_grid(COARSEST, monkeypatch)
    run = pb.carry("paper", name, overrides={"task.distance_m": 0.5} | change)
    assert run.outcome == "delivered"
    assert run.messages == 0
    assert any("no robot can run it" in line for line in run.warnings)


@pytest.mark.soak
def test_noise_limit_of_the_reference_is_below_the_bound() -> None:
    short = {"task.distance_m": 0.3}
    limit = pb.noise_limit("paper", "optimal", relative_half_width=0.1, overrides=short)
    most = pb.bound("paper", "corrections", overrides=short).sigma_star_m_s
    assert limit.interval[0] < most
    assert limit.sigma_star_m_s > 0.9 * most


def drops(scene: pb.Scene, controller: str, carries: int) -> NDArray[np.bool_]:
    return columns(scene, controller, carries)["outcome"] == DROPPED


def noisy(scene: pb.Scene) -> pb.Scene:
    """The scene at the noise where the design law expects that about 1 % drop."""
    spec = to_spec(scene)
    law = law_m_s(opening_problem(spec, "corrections"), spec.robots[0].noise_tau)
    return pb.load_scene(scene, {"robot.noise_m_s": min(law, 1.0)})


@pytest.mark.parametrize(
    ("best", "exact", "estimating", "noise_m_s"),
    [
        ("optimal", "exact-p", "kalman", 0.045),
        ("optimal-stopping", "exact-p-stopping", "kalman-stopping", 0.07),
    ],
)
def test_full_information_is_used(
    best: str, exact: str, estimating: str, noise_m_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Linear feedback of exact coordinates is no better, and that of estimates is worse: so it
    would be noticed if it took the place of the best. Paired seeds, one-sided."""
    on_grid(COARSE, monkeypatch)
    scene = pb.load_scene("paper", {"robot.noise_m_s": noise_m_s, "task.distance_m": 0.6})
    mine, linear, guessed = (drops(scene, name, 1500) for name in (best, exact, estimating))
    assert more_drops(mine, linear) > 0.01
    assert more_drops(guessed, mine) < 1e-3
    assert more_drops(guessed, linear) < 1e-3


@pytest.mark.parametrize(
    ("scenes", "carries", "grid"),
    [(1, 300, COARSE), pytest.param(40, 2000, FINE, marks=pytest.mark.soak)],
)
def test_no_shipped_controller_is_better(
    scenes: int, carries: int, grid: Grid, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Paired seeds, one-sided, at 1 % by Holm's procedure over all comparisons."""
    on_grid(grid, monkeypatch)
    p_values = []
    for seed in range(scenes):
        scene = noisy(random_scene(seed, 0.5))
        best = {name: drops(scene, name, carries) for name in BEST}
        for controller in shipped_names():
            if refusal(controller, scene) is not None:
                continue
            reference = "optimal-stopping" if controller in STOPS else "optimal"
            p_values.append(more_drops(best[reference], drops(scene, controller, carries)))
            print(seed, controller, best[reference].mean(), p_values[-1], flush=True)
    assert len(p_values) > 4 * scenes
    assert rejected(p_values, 0.01) == 0

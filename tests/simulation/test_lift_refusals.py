# SPDX-License-Identifier: Apache-2.0
"""What is refused before a job on the floor starts, against simulations without the refusal."""

import itertools

import numpy as np
import pytest

import palmbots as pb
from palmbots._util.confidence_intervals import wilson
from palmbots.errors import PalmbotsError
from palmbots.mechanics.lifting import lifting
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import run_seeds
from random_lifts import random_lift
from sampled import amounts

JOBS = 1
LEFT = 1.1
"""Of each margin over what the scene uses up, in a job that has to succeed without noise."""
UNKNOWN = ("object.mass_kg", "object.vertices_m")
"""Keys of refusals that the exact world does not know: traction, and noses that meet."""


@pytest.mark.slow
@pytest.mark.parametrize("scenes", amounts(36, 300))
def test_what_is_refused_fails_and_what_is_accepted_succeeds(scenes: int) -> None:
    """Shares of all jobs. Accepted: without a warning of the analysis.

    The rule was adjusted on some of these scenes, and the bounds were set after its first result:
    the test keeps the rule from getting worse, and is no evidence for it.
    """
    delivered: dict[str, list[float]] = {"refused": [], "warned": [], "accepted": []}
    for seed in range(scenes):
        scene = load_scene("lift", random_lift(seed))
        found = lifting(scene)
        assert found is not None
        known = [one for one in found.refusals if not one.startswith(UNKNOWN)]
        outcomes = run_seeds(to_spec(scene), "shared-sign", 0, JOBS, threads=2)["outcome"]
        verdict = "refused" if known else "warned" if found.warnings else "accepted"
        delivered[verdict].append(float(np.mean(outcomes == 1)))
    shares = {verdict: np.mean(jobs) for verdict, jobs in delivered.items()}
    # Of the few jobs before a change, one may succeed by chance: the end of an interval counts.
    refused = delivered["refused"]
    assert wilson(round(sum(refused)), len(refused))[0] <= 0.04, (shares, delivered)
    assert shares["accepted"] >= 0.8, (shares, delivered)


def has_margin(scene: pb.Scene) -> bool:
    """Whether `analyze` accepts the job without a warning, and more than a tenth is left of each
    margin. That of contacts which no robot corrects does not count: the robots correct them."""
    try:
        found = lifting(scene)
        if found is None or found.refusals or found.warnings:
            return False
        analysis = pb.analyze(scene)
    except PalmbotsError:  # the object does not stand, or another limit refuses it
        return False
    return analysis.holds and all(
        one.times is None or one.times >= LEFT
        for one in analysis.ranking
        if one.quantity != "contact"
    )


@pytest.mark.slow
@pytest.mark.parametrize("jobs", amounts(12, 200))
def test_jobs_with_margin_succeed_without_noise(jobs: int) -> None:
    quiet = {"robot.noise_m_s": 0.0, "mujoco.palm_torque_n_m": 1.0, "task.distance_m": 0.1}
    tried = 0
    # Early among them, 594: without a heel, and its palm is steeper than the lean of its nose.
    for seed in itertools.count(590):
        scene = load_scene("lift", random_lift(seed) | quiet)
        if not has_margin(scene):
            continue
        outcome = run_seeds(to_spec(scene), "shared-sign", seed, 1, threads=1)["outcome"]
        assert outcome.tolist() == [1], seed
        tried += 1
        if tried == jobs:
            break

# SPDX-License-Identifier: Apache-2.0
"""A palm that is longer than its usable part: contacts count as off the palm beyond that part."""

import numpy as np
import pytest

import palmbots as pb
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import run_seeds
from palmbots.stability.problem import stability_problem

SHORT = {"palm.length_m": 0.06}
USABLE = {"palm.length_m": 0.14, "palm.usable_m": 0.06}
NOISY = {"robot.noise_m_s": 0.03, "task.distance_m": 0.5}


def test_carries_are_those_of_a_palm_that_ends_there() -> None:
    """Above an object whose edges are clear of longer palms, to the last bit, drops included."""
    ends = set()
    for controller, seed in (("distributed", 0), ("shared-sign", 0), ("none", 1), ("silent", 2)):
        one, other = (
            pb.carry("paper", controller, seed=seed, overrides=NOISY | keys)
            for keys in (SHORT, USABLE)
        )
        assert one.trace_hash == other.trace_hash
        assert (one.outcome, one.reason) == (other.outcome, other.reason)
        ends.add(one.reason)
    assert "off-palm" in ends


def test_lanes_agree() -> None:
    one, other = (
        run_seeds(to_spec(load_scene("paper", NOISY | keys)), "distributed", 0, 64, threads=1)
        for keys in (SHORT, USABLE)
    )
    assert all(np.array_equal(one[name], other[name], equal_nan=True) for name in one)


def test_certificates_and_analysis_are_about_the_usable_part() -> None:
    scene = load_scene("paper", USABLE)
    assert stability_problem(scene).contacts == ((-0.03, 0.03), (-0.03, 0.03))
    box = pb.certify(scene, claims=["property 1"]).data["box"]
    assert [float(x) for x in box["contacts_m"]["left"]] == [-0.03, 0.03]
    with pytest.raises(pb.PalmbotsError, match=r"from -0\.03 to 0"):
        pb.analyze(scene, region_m=(-0.05, 0.05))
    assert (
        pb.analyze(scene).clearance_deg
        == pb.analyze(
            "paper", region_m=(-0.03, 0.03), overrides={"palm.length_m": 0.14}
        ).clearance_deg
    )


def test_region_has_the_same_words_everywhere() -> None:
    implied = pb.analyze(region_m="implied").region_m.left
    assert implied[0] == -implied[1] and 0.005 < implied[1] < 0.075
    box = pb.certify(region_m="implied", claims=["property 1"]).data["box"]
    assert [float(x) for x in box["contacts_m"]["left"]] == pytest.approx(implied, abs=1e-12)

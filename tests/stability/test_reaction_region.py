# SPDX-License-Identifier: Apache-2.0
"""The contacts that a scene implies: by hand, and by laws for robots that are not alike."""

import math
from typing import Any

import pytest

import palmbots as pb
from palmbots.stability.reaction_region import reaction

SHALLOW, STEEP = math.radians(5), math.radians(15)
UNLIKE: dict[str, Any] = {
    "palm.left.rate_deg_s": 40.0,
    "palm.right.rate_deg_s": 20.0,
    "palm.left.length_m": 0.10,
    "palm.right.length_m": 0.16,
    "palm.left.pivot_offset_m": -0.02,
    "palm.right.pivot_offset_m": 0.005,
    "robot.left.correction_m_s": 0.05,
    "robot.right.correction_m_s": 0.02,
    "robot.left.noise_m_s": 0.003,
    "robot.right.noise_m_s": 0.004,
    "robot.left.bias_m_s": -0.001,
    "robot.right.bias_m_s": 0.002,
    "radio.latency_s": 0.08,
    "radio.jitter_s": 0.01,
    "control.period_s": 0.02,
    "tactile.zero_half_width_m": 0.007,
}


def test_reaction_agrees_with_a_calculation_by_hand() -> None:
    """Palms turn 10° at 20°/s; noise √(3² + 4²) = 5 mm/s; a message takes 80 + 10 + 20 ms."""
    found = reaction(pb.load_scene("paper", UNLIKE), SHALLOW, STEEP)
    assert found.own_s == pytest.approx(0.02 + 0.5)
    assert found.asked_s == pytest.approx(0.02 + 2 * 0.11 + 0.5)
    drift = 0.003 + 3 * 0.005
    negative = 0.007 + drift * 0.52
    # The partner first turns its palm, brings its own contact back at 2 cm/s, turns back.
    positive = 0.007 + drift * (0.74 + 0.52 + negative / 0.02 + 0.5)
    turned = math.radians(10) * (positive * math.sin(STEEP) + 0.02)
    assert found.reach_m == pytest.approx(positive + turned, rel=1e-12)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    ("key", "worse"),
    [
        ("palm.{}.rate_deg_s", 5.0),
        ("palm.{}.pivot_offset_m", -0.05),
        ("palm.{}.pivot_offset_m", 0.05),
        ("robot.{}.correction_m_s", 0.005),
        ("robot.{}.noise_m_s", 0.02),
        ("robot.{}.bias_m_s", -0.02),
        ("robot.{}.bias_m_s", 0.02),
        ("radio.latency_s", 0.3),
        ("radio.jitter_s", 0.3),
        ("control.period_s", 0.1),
        ("tactile.zero_half_width_m", 0.02),
    ],
)
def test_worst_robot_or_palm_determines_the_reaction(side: str, key: str, worse: float) -> None:
    """Whatever is worse, on one robot or palm alone, takes the contacts farther out."""
    before = reaction(pb.load_scene("paper", UNLIKE), SHALLOW, STEEP)
    after = reaction(pb.load_scene("paper", UNLIKE | {key.format(side): worse}), SHALLOW, STEEP)
    assert after.reach_m > before.reach_m
    assert after.beyond_m >= 0


def test_asymmetric_zone_counts_with_its_farther_edge_on_the_palm() -> None:
    def reach(low: float, high: float) -> float:
        zones = [
            {"sign": "-", "from_m": -0.2, "to_m": low},
            {"sign": "0", "from_m": low, "to_m": high},
            {"sign": "+", "from_m": high, "to_m": 0.2},
        ]
        changes = UNLIKE | {"tactile.zones": zones}
        del changes["tactile.zero_half_width_m"]
        return float(reaction(pb.load_scene("paper", changes), SHALLOW, STEEP).reach_m)

    by_half = float(reaction(pb.load_scene("paper", UNLIKE), SHALLOW, STEEP).reach_m)
    assert reach(-0.007, 0.002) == reach(-0.002, 0.007) == pytest.approx(by_half, rel=1e-12)
    assert reach(-0.08, 0.08) == pytest.approx(reach(-0.1, 0.15), rel=1e-12)
    assert reach(-0.07, 0.07) < reach(-0.08, 0.08)


def test_overrun_past_the_pivot() -> None:
    """Only what the zero zone does not take up."""
    quick = {"robot.correction_m_s": 0.05, "control.period_s": 0.1}
    near, far = (
        reaction(pb.load_scene("paper", quick | {"tactile.zero_half_width_m": w}), SHALLOW, STEEP)
        for w in (0.001, 0.002)
    )
    assert near.beyond_m - far.beyond_m == pytest.approx(0.001, rel=1e-9)
    assert reaction(pb.load_scene("paper"), SHALLOW, STEEP).beyond_m == 0

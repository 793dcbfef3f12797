# SPDX-License-Identifier: Apache-2.0
"""The binding constraint of the analysis agrees with the contact modes of the core there."""

import math

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import SIDES, Side
from palmbots.mechanics.contact_modes import CONTACT_MODES
from palmbots.stability.analysis import Analysis
from sampled import amounts

SLIDES = {  # (palm, up): which mode that is, the other contact sticking
    ("left", True): CONTACT_MODES.index(("SL", "ST")),
    ("left", False): CONTACT_MODES.index(("SR", "ST")),
    ("right", True): CONTACT_MODES.index(("ST", "SR")),
    ("right", False): CONTACT_MODES.index(("ST", "SL")),
}
BINDING_TEXTS = {
    1: (
        "on closing, the steep palm's contact would slide up first",
        "on closing, the steep palm's contact would slide down",
        "the shallow palm's contact is wedged and never slides up",
    ),
    2: (
        "on opening, the shallow palm's contact would slide down first",
        "on opening, the shallow palm's contact would slide up",
        "the steep palm's contact is wedged and never slides down",
    ),
}


def other(side: Side) -> Side:
    return "right" if side == "left" else "left"


def check(report: Analysis, number: int, shallow: Side) -> str:
    """Check one failing property at its reported state; returns the binding text."""
    found, at = report.properties[number, shallow], report.problem
    theta = at.palms(shallow)
    state = pb.contact_modes_batch(
        width=at.width,
        com_x=at.com[0],
        com_y=at.com[1],
        theta_left=theta[0],
        theta_right=theta[1],
        p_left=found.binding_p_m[0],
        p_right=found.binding_p_m[1],
        friction_left=at.friction[0],
        friction_right=at.friction[1],
        offset_left=at.offset[0],
        offset_right=at.offset[1],
        slope=at.slope,
    )
    flat, high = (state.squeeze[SIDES.index(side)] for side in (shallow, other(shallow)))
    held = bool(state.feasible[CONTACT_MODES.index(("ST", "ST"))])
    first, second, wedged = BINDING_TEXTS[number]
    if found.binding == first:
        # The contact that should stick lets go before the one that should slide.
        assert high[1] < flat[1] if number == 1 else flat[0] > high[0]
        if held and number == 1:
            assert state.closing == SLIDES[other(shallow), True]
        if held and number == 2:
            assert state.opening == SLIDES[shallow, False]
    elif found.binding == second:
        assert flat[1] < high[0]
        assert not state.feasible.any()
    elif found.binding == wedged:
        assert math.isinf(flat[1] if number == 1 else high[0])
    else:
        lifted = found.binding.split()[-2]
        assert found.binding == f"the object tips: nothing presses on the {lifted} palm"
        # Only a wedge could hold what tips; the analysis does not build on that.
        assert not held or np.isinf(state.squeeze).any()
    return found.binding


@pytest.mark.slow
def test_binding_state_fails_as_reported() -> None:
    rng = np.random.default_rng(0)
    texts: set[str] = set()
    for _ in range(100):
        angles = np.sort(rng.uniform(-5, 40, 2))
        changes = {
            "palm.shallow_deg": float(angles[0]),
            "palm.steep_deg": float(angles[1]) + 0.5,
            "palm.left.friction": float(rng.uniform(0.02, 1.0)),
            "palm.right.friction": float(rng.uniform(0.02, 1.0)),
            "object.com_m": [float(rng.uniform(0.01, 0.24)), float(rng.uniform(0.005, 0.15))],
            "task.slope_deg": float(rng.choice([0.0, rng.uniform(-8, 8)])),
            "palm.pivot_offset_m": float(rng.choice([0.0, 0.01])),
        }
        report = pb.analyze("paper", overrides=changes)
        for number in (1, 2):
            for shallow in SIDES:
                if not report.properties[number, shallow].holds:
                    texts.add(check(report, number, shallow))
    assert texts >= {text for group in BINDING_TEXTS.values() for text in group[:2]}


@pytest.mark.parametrize("cases", amounts(40, 100))
def test_wedged_contact_cannot_slide(cases: int) -> None:
    rng = np.random.default_rng(1)
    wedged = 0
    for _ in range(cases):
        changes = {
            "palm.shallow_deg": 33.0,
            "palm.steep_deg": 36.0,
            "palm.length_m": float(rng.uniform(0.2, 0.3)),
            "palm.friction": float(rng.uniform(0.9, 1.3)),
            "object.com_m": [float(rng.uniform(0.02, 0.23)), float(rng.uniform(0.005, 0.15))],
        }
        report = pb.analyze("paper", overrides=changes)
        for shallow in SIDES:
            if "wedged" in report.properties[1, shallow].binding:
                assert check(report, 1, shallow) == BINDING_TEXTS[1][2]
                wedged += 1
    assert wedged > cases / 30


def test_property_zero_names_the_palm_that_slips() -> None:
    """Little friction: on angles far apart the steep palm pushes the object off the shallow one."""
    report = pb.analyze("paper", overrides={"palm.friction": 0.05, "palm.steep_deg": 30.0})
    for shallow in SIDES:
        found = report.properties[0, shallow]
        assert not found.holds
        assert found.binding.startswith("the shallow palm cannot hold against the steep one")

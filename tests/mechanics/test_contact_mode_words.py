# SPDX-License-Identifier: Apache-2.0
"""The sentences about a contact mode say what the core finds."""

import math
import random
import re

import pytest

import palmbots as pb
from palmbots.errors import PalmbotsError
from palmbots.mechanics.contact_mode_words import decision_sentence, margin_sentence, mode_sentence

SLIDES = {"left": {"SL": "up", "SR": "down"}, "right": {"SR": "up", "SL": "down"}}


def states() -> list[pb.mechanics.ContactModes]:
    """States of the default scene, held or not."""
    draw = random.Random(26)
    found: list[pb.mechanics.ContactModes] = []
    while len(found) < 60:
        try:
            found.append(
                pb.contact_modes(
                    p_left_m=draw.uniform(-0.07, 0.07), p_right_m=draw.uniform(-0.07, 0.07),
                    theta_left_deg=draw.uniform(0, 45), theta_right_deg=draw.uniform(0, 45),
                )
            )  # fmt: skip
        except PalmbotsError:
            continue  # a palm would lie inside the object
    return found


def test_the_contact_that_slides_is_the_one_that_the_inequality_names() -> None:
    """The mode is the core's own search; the sentence only compares the ends of I_L and I_R."""
    seen = set()
    for found in states():
        held = ("ST", "ST") in found.feasible
        for mode, closing in ((found.closing, True), (found.opening, False)):
            said = decision_sentence(found.squeeze, closing=closing, held=held)
            words = mode_sentence(mode, held=held)
            if mode is None:
                assert "no squeeze in common" in said and "holds the object" in words
                seen.add("not held")
                continue
            sliding = [side for side, motion in zip(SLIDES, mode, strict=True) if motion != "ST"]
            near, far = re.findall(r"edge of the (\w+) cone", said)
            assert sliding == [near] and far != near
            way = "up" if closing else "down"
            motion = mode[0] if near == "left" else mode[1]
            assert SLIDES[near][motion] == way and f"slides {way}" in words
            first, second = (
                float(number.replace("−", "-"))
                for number in re.findall(r"(?:= |[≤≥] )(−?[\d.]+)", said)
            )
            end = 1 if closing else 0
            assert first == pytest.approx(found.squeeze[near][end], abs=6e-4)
            assert second == pytest.approx(found.squeeze[far][end], abs=6e-4)
            assert (first < second) == closing
            seen.add((near, closing))
    assert len(seen) == 5


def test_palms_alike_reach_both_edges_at_once() -> None:
    found = pb.contact_modes(p_left_m=0.01, p_right_m=0.01)
    assert decision_sentence(found.squeeze, closing=True, held=True) == (
        "The squeeze rises until it reaches the upper edges of both cones at once: "
        f"H = {found.squeeze['left'][1]:.3f}."
    )
    assert mode_sentence(found.closing, held=True) == (
        "The left contact slides up, the right one slides up."
    )


def test_wedged_contacts_have_no_edge_to_reach() -> None:
    found = pb.contact_modes(
        overrides={"palm.friction": 1.2}, theta_left_deg=40, theta_right_deg=40
    )
    assert found.closing is None
    assert mode_sentence(None, held=True).endswith("the object is jammed.")
    assert "rises without end" in decision_sentence(found.squeeze, closing=True, held=True)


def test_the_margin_has_a_sign() -> None:
    assert margin_sentence(math.radians(3)).startswith("Both friction cones may shrink by 3.00°")
    assert "would have to grow by 3.00°" in margin_sentence(math.radians(-3))

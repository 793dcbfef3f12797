# SPDX-License-Identifier: Apache-2.0
"""What `analyze` says happens where the outline just touches a palm."""

import math

import numpy as np
import pytest
from scipy.optimize import nnls

import palmbots as pb
import palmbots._core as _core
from contact_scripts import SHARP
from palmbots.scene.spec import to_spec
from palmbots.stability.first_contact import FirstTouch

# Lips hang below the line of contacts: with these the outline touches inside the region.
LIPPED = {
    "object": {
        "vertices_m": [[0, 0], [0.05, -0.001], [0.2, -0.001], [0.25, 0], [0.25, 0.16], [0, 0.16]],
        "contacts": [0, 3],
        "com_m": [0.125, 0.04],
        "mass_kg": 0.5,
        "depth_m": 0.1,
    },
    "palm": {"shallow_deg": 1.0},
}
SCENES = [{"object": name} for name in SHARP] + [LIPPED]


def found(scene: dict) -> FirstTouch:
    touch = pb.analyze(scene).touch
    assert touch is not None
    return touch


def balance(scene: dict, touch: FirstTouch) -> float:
    """What is left of weight and its moment by the best forces along edges of friction cones."""
    spec = to_spec(pb.load_scene(scene))
    com = np.array([spec.com_left, spec.com_height])
    rise = [
        p * math.sin(a) + spec.palms[i].offset * math.cos(a)
        for i, (p, a) in enumerate(zip(touch.contacts_m, touch.angles_rad, strict=True))
    ]
    tilt = math.asin((rise[1] - rise[0]) / spec.width)
    turn = np.array([[math.cos(tilt), -math.sin(tilt)], [math.sin(tilt), math.cos(tilt)]])
    wrenches = []
    for contact in touch.contacts:
        side = 0 if contact.side == "left" else 1
        arm = turn @ (np.array(contact.point_m) - com)
        lean = touch.angles_rad[side] if side == 0 else -touch.angles_rad[side]
        if contact.kind == "tip":
            return math.nan  # its normal is the edge's
        for edge in (-1, 1):
            angle = lean + edge * math.atan(spec.palms[side].friction)
            force = np.array([math.sin(angle), math.cos(angle)])
            moment = arm[0] * force[1] - arm[1] * force[0]
            wrenches.append([*force, moment / spec.width])
    push = np.array([spec.slope, 1.0, 0.0])
    return float(nnls(np.array(wrenches).T, push)[1])


def test_an_object_may_lie_flush_on_a_palm_of_real_thickness() -> None:
    """Its foot ends beyond the nose, so it is beside the end face of the plate, and not in it."""
    touch = pb.analyze("lift", overrides={"object": "bottle"}).touch
    assert touch is not None
    assert [contact.kind for contact in touch.contacts].count("flush") == 2


@pytest.mark.parametrize("scene", SCENES, ids=lambda s: str(s["object"])[:9])
def test_first_touch_is_the_boundary_of_touching(scene: dict) -> None:
    touch = found(scene)
    nearest = pb.analyze(scene).clearance.rotation_margin
    spec = to_spec(pb.load_scene(scene))
    side = 0 if nearest.side == "left" else 1
    assert touch.contacts_m == nearest.contacts_m
    assert touch.angles_rad[1 - side] == pytest.approx(nearest.angles_rad[1 - side])
    pierced = set()
    for turn in (-1e-3, 1e-3):
        left, right = touch.angles_rad
        angles = (left + turn, right) if side == 0 else (left, right + turn)
        pierced.add(_core.contacts(spec, angles, touch.contacts_m)[1])
    assert pierced == {None, side}
    assert len(touch.contacts) > 2
    # How far it was turned: no less than the margin says, for the object turns with the palm.
    turned = abs(touch.angles_rad[side] - nearest.angles_rad[side])
    assert 0.2 * abs(nearest.margin) <= turned <= 1.5 * abs(nearest.margin) + math.radians(1)


@pytest.mark.parametrize("scene", SCENES, ids=lambda s: str(s["object"])[:9])
def test_held_agrees_with_non_negative_least_squares(scene: dict) -> None:
    touch = found(scene)
    left = balance(scene, touch)
    if not math.isnan(left):
        assert touch.held == (left < 1e-9)


def test_first_touch_may_be_unbalanced() -> None:
    slippery = {"palm": {"friction": 0.005}}
    touch = found(slippery)
    assert not touch.held
    assert balance(slippery, touch) > 1e-3


def test_outcomes_name_every_contact() -> None:
    touch = found({})
    for motions in touch.closing + touch.opening:
        assert len(motions) == len(touch.contacts)
        assert set(motions) <= {"ST", "SL", "SR", "BR"}
    assert touch.closing
    assert touch.opening


def test_summary_contains_the_first_touch() -> None:
    touch = pb.analyze("paper").summary()["touch"]
    assert {contact["kind"] for contact in touch["contacts"]} == {"flush", "vertex"}
    assert touch["held"] is True

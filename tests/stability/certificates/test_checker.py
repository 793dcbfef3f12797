# SPDX-License-Identifier: Apache-2.0
"""The checker refuses tampered certificates, each for its own reason; its enclosures are true."""

import copy
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx, fmpq

from palmbots import check as check_function
from palmbots._types import SIDES
from palmbots.stability.certificates.checker import property_conditions as exact_forms
from palmbots.stability.certificates.checker.enclosures import (
    cosine_of_degrees,
    root,
    sine_of_degrees,
)
from palmbots.stability.certificates.parameter_box import exact
from palmbots.stability.certificates.prover import certify

TAMPERED: list[tuple[str, Any]] = [
    ("box.com_m.0.0", "0.10"),
    ("box.friction.left.1", "0.9"),
    ("box.shallow_deg.right.0", "1"),
    ("box.shallow_deg.left", ["6", "5"]),
    ("box.steep_deg.left.0", "85"),
    ("box.shallow_deg.left", ["16", "17"]),
    ("box.beyond_m", "-0.07"),
    ("box.contacts_m.left.0", "-0.5"),
    ("box.contacts_m.left", ["0.01", "0.02"]),
    ("box.width_m.1", "0.9"),
    ("box.slope.1", "0.3"),
    ("box.com_m", []),
    ("box.friction.common", 1),
    ("box.width_m.0", "1e999999999"),
    ("box.width_m.0", "-0.25"),
    ("box.width_m.0", "1/0"),
    ("box.width_m.0", 0.25),
    ("box.outline_m.0.2", "-0.1"),
    ("claims", ["property 3"]),
    ("claims", []),
    ("claims", "property 1"),
    ("verdict", "fails"),
    ("verdict", "undecided"),
    ("proof.1 left", ["friction", "0.3", "corners", "corners"]),
    ("proof.1 left", ["colour", "0.3", "corners", "corners"]),
    ("proof.1 left", ["left", "7", "corners", "corners"]),
    ("proof.1 left", "trust me"),
    ("proof.1 left", None),
    ("proof", {}),
]


@pytest.mark.parametrize(("where", "value"), TAMPERED, ids=lambda v: str(v)[:40])
def test_tampered_certificates_are_refused(where: str, value: Any, tmp_path: Path) -> None:
    data = copy.deepcopy(certify("paper", com_x_m=(0.12, 0.13)).data)
    at: Any = data
    *path, last = where.split(".")
    for key in path:
        at = at[int(key)] if isinstance(at, list) else at[key]
    at[int(last) if isinstance(at, list) else last] = value
    target = tmp_path / "tampered.json"
    target.write_text(json.dumps(data))
    found = check_function(target)
    assert not found.valid
    assert found.reason


def test_witness_outside_the_box_is_refused(tmp_path: Path) -> None:
    data = certify("paper", friction=(0.3, 0.5)).data
    for key, value in (
        ("friction", {"left": "0.6", "right": "0.3"}),
        ("friction", {"left": "0.3", "right": "0.3"}),
        ("fails", "second"),
        ("fails", "bad luck"),
        ("claim", "9 left"),
        ("com_m", ["0.05", "0.04"]),
        ("contacts_m", {"left": "0.05", "right": "0.075"}),
    ):
        changed = copy.deepcopy(data)
        changed["witness"][key] = value
        target = tmp_path / "witness.json"
        target.write_text(json.dumps(changed))
        assert not check_function(target).valid, key


def test_enclosures_contain_the_values_of_ball_arithmetic() -> None:
    rng = np.random.default_rng(6)
    with ctx.workprec(200):
        for degrees in [0, 45, 90, -90, 30, *np.round(rng.uniform(-90, 90, 200), 6)]:
            value = exact(float(degrees))
            angle = arb(fmpq(value.numerator, value.denominator)) * arb.pi() / 180
            sides = (
                (sine_of_degrees(value), angle.sin()),
                (cosine_of_degrees(value), angle.cos()),
            )
            for (low, high), true in sides:
                assert arb(fmpq(low.numerator, low.denominator)) <= true
                assert arb(fmpq(high.numerator, high.denominator)) >= true
                assert high - low < Fraction(1, 10**21)
    for x in rng.uniform(0, 2, 200):
        value = exact(float(x))
        assert root(value, False) ** 2 <= value <= root(value, True) ** 2
        assert root(value, True) - root(value, False) <= Fraction(3, 10**24)


def test_object_tangent_encloses_sampled_states() -> None:
    """For random boxes, every tangent at sampled points is inside; with the extremes near it."""
    rng = np.random.default_rng(8)
    near = 0
    for _ in range(200):
        angles = np.sort(np.round(rng.uniform(-10, 40, (2, 2)), 3), axis=1)
        contacts = np.sort(np.round(rng.uniform(-0.08, 0.08, (2, 2)), 4), axis=1)
        widths = np.sort(np.round(rng.uniform(0.2, 0.4, 2), 3))
        offsets = np.round(rng.choice([0.0, 0.01, -0.02], 2), 3)
        turned, placed = (
            ((exact(v[0, 0]), exact(v[0, 1])), (exact(v[1, 0]), exact(v[1, 1])))
            for v in (angles, contacts)
        )
        zero = (Fraction(0), Fraction(0))
        box = exact_forms.ParameterBox(
            turned, (zero, zero), (exact(widths[0]), exact(widths[1])), placed, False
        )
        above = (exact(offsets[0]), exact(offsets[0])), (exact(offsets[1]), exact(offsets[1]))
        given = exact_forms.ObjectParams((), zero, above)
        low, high = exact_forms.object_tangent(box, given)
        shape = (500, 2)
        share = rng.random(shape).round(rng.integers(0, 3))  # corners, too
        theta = np.radians(angles[:, 0] + share * np.diff(angles).T)
        p = contacts[:, 0] + rng.random(shape).round(0) * np.diff(contacts).T
        heights = p * np.sin(theta) + offsets * np.cos(theta)
        z = heights[:, 1] - heights[:, 0]
        w = widths[0] + rng.integers(0, 2, 500) * (widths[1] - widths[0])
        tangent = z / np.sqrt(w**2 - z**2)
        assert float(low) - 1e-12 <= tangent.min()
        assert tangent.max() <= float(high) + 1e-12
        near += tangent.max() > float(high) - 0.02
    assert near > 100


def refused(data: dict[str, Any], folder: Path) -> str:
    target = folder / "false.json"
    target.write_text(json.dumps(data))
    found = check_function(target)
    assert not found.valid
    return found.reason


def all_corners(data: dict[str, Any]) -> dict[str, Any]:
    """The same claim with the proof that says least: look at the corners of the whole box."""
    return data | {"proof": dict.fromkeys(data["proof"], "corners")}


def test_false_claims_are_refused_each_for_its_own_reason(tmp_path: Path) -> None:
    """Claims that are wrong in one place only: that place has to be looked at."""
    held = copy.deepcopy(certify("paper", claims=("property 0",)).data)
    for side in SIDES:
        held["box"]["friction"][side] = ["0.04", "0.04"]
    # With palms alike it is held; between 5° and 15° it slides (10° > 2 φ).
    assert refused(held, tmp_path).startswith("0 left 1: the wrong contact may slide")

    tipping = copy.deepcopy(certify("paper", claims=("property 0",)).data)
    tipping["box"]["com_m"] = [["0.2505", "0.04"]]
    assert "the object may tip" in refused(tipping, tmp_path)

    data = copy.deepcopy(
        certify("paper", friction=(0.3, 0.5), common_friction=True, com_x_m=(0.117, 0.133)).data
    )
    valid = data["proof"]["1 left"]
    assert valid != "corners"
    wider = copy.deepcopy(data)
    for side in SIDES:
        wider["box"]["friction"][side] = ["0.3", "1.0"]
    for name in wider["proof"]:
        wider["proof"][name] = ["friction", "0.5", wider["proof"][name], "corners"]
    assert "1 left: the wrong contact may slide" in refused(wider, tmp_path)
    lower = copy.deepcopy(data)
    for side in SIDES:
        lower["box"]["friction"][side] = ["0.05", "0.5"]
    for name in lower["proof"]:
        lower["proof"][name] = ["friction", "0.3", "corners", lower["proof"][name]]
    assert "the wrong contact may slide" in refused(lower, tmp_path)
    unlike = copy.deepcopy(data)
    unlike["box"]["friction"]["right"] = ["0.3", "0.3"]
    assert "two intervals" in refused(unlike, tmp_path)
    assert "the wrong contact may slide" in refused(all_corners(data), tmp_path)

    clear = copy.deepcopy(certify("paper", claims=("clearance",)).data)
    clear["box"]["shallow_deg"] = {side: ["3", "3"] for side in SIDES}
    assert "touch a palm" in refused(clear, tmp_path) or "lie flat" in refused(clear, tmp_path)
    keel = copy.deepcopy(certify("paper", claims=("clearance",)).data)
    keel["box"]["outline_m"].insert(1, ["0.02", "0.23", "-0.01"])
    keel["box"]["right_contact"] = 2
    body = keel["scene"]["object"]
    body["vertices_m"] = [body["vertices_m"][0], [0.02, -0.01], *body["vertices_m"][1:]]
    body["contacts"] = [0, 2]
    assert "lie flat on a palm" in refused(keel, tmp_path)

    wedged = copy.deepcopy(certify("paper", claims=("property 1",)).data)
    for side in SIDES:
        wedged["box"]["friction"][side] = ["20", "20"]
    assert refused(wedged, tmp_path)


def test_wedged_edge_voids_a_condition_only_if_wedged_at_all_corners() -> None:
    """With the least friction the wrong contact slides; with the greatest it is wedged."""

    def at(friction: tuple[str, str]) -> list[exact_forms.Corner]:
        def just(*values: str) -> Any:
            return tuple((Fraction(value), Fraction(value)) for value in values)

        mu = Fraction(friction[0]), Fraction(friction[1])
        width = (Fraction("0.25"), Fraction("0.25"))
        box = exact_forms.ParameterBox(
            just("17", "59"), (mu, *just("0.6")), width, just("-0.048", "-0.003"), False
        )
        com = ((Fraction("0.22"), Fraction("0.17")),)
        given = exact_forms.ObjectParams(com, just("0")[0], just("0", "0"))
        return list(exact_forms.corners(box, given))

    exact_forms.prove_property(0, exact_forms.LEFT, at(("3.29", "3.29")))
    for friction in (("0.91", "0.91"), ("0.91", "3.29")):
        with pytest.raises(exact_forms.CheckFailed, match="the wrong contact may slide"):
            exact_forms.prove_property(0, exact_forms.LEFT, at(friction))

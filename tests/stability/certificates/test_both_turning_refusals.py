# SPDX-License-Identifier: Apache-2.0
"""The claims about palms that turn at the same time: forged certificates, the command, designs."""

import copy
import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from certificate_cases import WIDE_APART, checked
from palmbots._types import SIDES
from palmbots.cli.main import run
from palmbots.stability.certificates import jam_proof, property_proof
from palmbots.stability.certificates.box_from_scene import box_of
from palmbots.stability.certificates.checker.certificate_file import Entry
from palmbots.stability.certificates.checker.claimed_box import read_box
from palmbots.stability.certificates.checker.jam_conditions import prove_no_jam
from palmbots.stability.certificates.checker.property_conditions import CheckFailed, Corner
from palmbots.stability.certificates.checker.required_obligations import required_obligations
from palmbots.stability.certificates.obligations import (
    BOTH_TURN,
    CLAIMS,
    ONE_TURNS,
    Obligation,
    Subbox,
    obligations,
)
from palmbots.stability.certificates.prover import certify

# Frictions at which the cones of both palms contain the line between the contacts.
STICKY: dict[str, Any] = {"friction": (0.3, 4.0)}


@pytest.fixture(scope="module")
def held() -> dict[str, Any]:
    return json.loads(json.dumps(certify("paper", com_x_m=(0.12, 0.13)).data))


def _without(name: str) -> Callable[[dict[str, Any]], None]:
    return lambda data: data["proof"].pop(name)


def _set(key: str, value: Any) -> Callable[[dict[str, Any]], None]:
    def change(data: dict[str, Any]) -> None:
        data["box"][key] = dict.fromkeys(SIDES, value) | (
            {"common": False} if key == "friction" else {}
        )

    return change


def _only(*claims: str) -> Callable[[dict[str, Any]], None]:
    """Drop the other claims, so that nothing else refuses the certificate."""
    return lambda data: data.update(claims=list(claims))


FORGED: dict[str, tuple[tuple[Callable[[dict[str, Any]], None], ...], str]] = {
    "no proof of closing": ((_without("jam closing"),), "proof.jam closing is missing"),
    "no proof of opening": ((_without("jam opening"),), "proof.jam opening is missing"),
    "no proof of property 0": ((_without("0 turning"),), "proof.0 turning is missing"),
    "no proof of clearance": (
        (_without("clear right turning inward"),),
        "proof.clear right turning inward is missing",
    ),
    "more friction": (
        (_only("no jam"), _set("friction", ["0.3", "4"])),
        "jam closing: both contacts may be wedged",
    ),
    "much friction on palms that tilt inward": (
        (_only("no jam"), _set("friction", ["6", "6"]), _set("shallow_deg", ["-12", "-12"])),
        "jam ",
    ),
    "less friction": (
        (_only("property 0 turning"), _set("friction", ["0.08", "0.3"])),
        "0 turning: the wrong contact may slide",
    ),
    "flatter": (
        (_only("clearance turning"), _set("shallow_deg", ["3", "3"])),
        "clear ",
    ),
    "steeper": (
        (_only("property 0 turning"), _set("steep_deg", ["60", "60"])),
        "0 turning: ",
    ),
}


@pytest.mark.parametrize("name", FORGED)
def test_false_claims_are_refused_with_their_obligation(
    name: str, held: dict[str, Any], tmp_path: Path
) -> None:
    changes, reason = FORGED[name]
    data = copy.deepcopy(held)
    assert checked(data, tmp_path).valid
    for change in changes:
        change(data)
    found = checked(data, tmp_path)
    assert not found.valid
    assert found.reason.startswith(reason), found.reason


def test_property_0_of_one_turning_palm_does_not_prove_that_of_two(tmp_path: Path) -> None:
    data = certify(WIDE_APART, claims=("property 0",)).data
    data["claims"] = ["property 0 turning"]
    assert checked(data, tmp_path).reason == "proof.0 turning is missing"
    data["proof"]["0 turning"] = "corners"
    assert checked(data, tmp_path).reason == "0 turning: the wrong contact may slide"


def test_forged_witnesses_of_a_jam_are_refused(tmp_path: Path) -> None:
    data = certify("paper", claims=("no jam",), **STICKY).data
    assert (data["verdict"], data["witness"]["claim"]) == ("fails", "jam closing")
    assert checked(data, tmp_path).valid
    for key, value, reason in (
        ("friction", {"left": "4", "right": "0.3"}, "not certainly wedged"),
        ("angle_deg", {"left": "5", "right": "5"}, "not certainly wedged"),
        ("claim", "jam opening", "not certainly wedged"),
        ("fails", "first", '"wedged"'),
        ("friction", {"left": "5", "right": "5"}, "not a point of the parameter box"),
        ("angle_deg", {"left": "16", "right": "15"}, "not a point of the parameter box"),
        ("claim", "jam", "jam closing"),
    ):
        changed = copy.deepcopy(data)
        changed["witness"][key] = value
        found = checked(changed, tmp_path)
        assert not found.valid
        assert reason in found.reason, found.reason


def test_prover_and_checker_require_the_same() -> None:
    """Both list the obligations on their own; a correction continues past p = 0, so that every
    region is clipped."""
    scene = pb.load_scene("paper", {"palm.right.length_m": 0.12})
    box = box_of(scene, beyond_m=0.01, shallow_deg=(4.0, 5.0), steep_deg=(14.0, 16.0))
    prover = {o.name: o for o in obligations(box, CLAIMS)}
    required = required_obligations(read_box(Entry(box.as_dict())), CLAIMS)
    assert list(prover) == list(required)
    for name, one in prover.items():
        other = required[name]
        assert (one.claim, one.number, one.side) == (other.claim, other.number, other.side)
        assert (one.part.angles, one.part.contacts) == (other.angles, other.contacts)
    inward = required["clear left turning inward"].contacts
    assert inward == ((Fraction("-0.075"), Fraction("0.01")), (Fraction("-0.06"), Fraction("0.01")))


# (tangents of the palm angles, tangent of the object's angle, the friction on both palms, whether
# closing and opening are possible), with the reason worked out by hand.
EDGES: tuple[tuple[tuple[str, str], str, str, tuple[bool, bool]], ...] = (
    (("0.1", "0.2"), "0", "0.3", (True, True)),
    # a d + b c > 0, but the left edge leans outward (a < 0): b − a T = −1 and d + c T = −3.
    (("-1", "2"), "-2", "0", (False, False)),
    # Only the left edge is wedged, b − a T = −0.2, while a d + b c > 0: the right contact slides.
    (("1", "0.5"), "1.2", "0", (True, True)),
    # Only the right edge is, with a < 0, so that it is the left contact that proves it.
    (("-0.1", "2"), "-0.6", "0", (True, True)),
    # Both up edges are wedged, and both down edges are not.
    (("0.5", "0.5"), "0", "3", (False, True)),
    # Both palms tilt inward: both down edges are wedged.
    (("-0.5", "-0.5"), "0", "3", (True, False)),
)


@pytest.mark.parametrize(("tangents", "turn", "friction", "possible"), EDGES)
def test_jam_conditions_by_hand(
    tangents: tuple[str, str], turn: str, friction: str, possible: tuple[bool, bool]
) -> None:
    t = Fraction(tangents[0]), Fraction(tangents[1])
    mu = Fraction(friction)
    at = [Corner(t, (mu, mu), Fraction(1), Fraction(0), Fraction(turn), Fraction(2), Fraction(0))]
    for number, moves in zip((1, 2), possible, strict=True):
        if moves:
            prove_no_jam(number, at)
        else:
            with pytest.raises(CheckFailed, match="both contacts may be wedged"):
                prove_no_jam(number, at)


@pytest.mark.parametrize(("tangents", "turn", "friction", "possible"), EDGES)
def test_jam_proof_by_hand(
    tangents: tuple[str, str],
    turn: str,
    friction: str,
    possible: tuple[bool, bool],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    box = box_of(pb.load_scene("paper"))
    part = Subbox(box.shallow_deg, box.friction, box.width, box.contacts)
    t, mu = (float(tangents[0]), float(tangents[1])), float(friction)
    corner = property_proof.Corner(t, (mu, mu), (1.0, 0.0), float(turn), 2.0, 0.0)
    monkeypatch.setattr(jam_proof, "corners", lambda *_: [corner])
    for number, moves in zip((1, 2), possible, strict=True):
        obligation = Obligation("jam", "no jam", number, 0, part)
        assert jam_proof.proved(box, obligation, part) == moves


def test_command_names_what_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "jam.json"
    words = ["certify", "--claims", "no jam", "-o", str(path)]
    assert run([*words, "--friction", "0.3", "4"]) == 1
    shown = capsys.readouterr().out
    assert "CERTIFIED TO FAIL  no jam" in shown
    assert "jam closing: both contacts are wedged" in shown
    assert run(["check", str(path)]) == 0
    assert "fails: no jam" in capsys.readouterr().out
    assert run(["certify", "--claims", "property 0, no jam"]) == 0
    assert "property 0, no jam" in capsys.readouterr().out
    words = [f"--set=palm.{key}={value}" for key, value in WIDE_APART["palm"].items()]
    words.append("--set=object.com_m=[0.1089, 0.0765]")
    assert run(["certify", "--claims", "property 0 turning", *words]) == 1
    assert "both palms turning: the right palm cannot hold" in capsys.readouterr().out


@pytest.mark.slow
def test_design_certifies_what_holds_at_its_angles(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The angles for the largest error of the COM do not have all claims; other ones do."""
    words = ["design", "--maximize", "com", "--region", "palm", "--resolution-deg", "1"]
    words += ["--friction", "0.3", "0.5", "--common-friction", "--set", "task.distance_m=0.1"]
    assert run([*words, "--out", str(tmp_path)]) == 0
    shown = capsys.readouterr().out
    (line,) = [line for line in shown.splitlines() if line.startswith("not certified")]
    assert line == "not certified for palms that turn at the same time: property 0 turning"
    written = json.loads((tmp_path / "design.json").read_text())
    assert written["claims"] == [*ONE_TURNS, "clearance turning", "no jam"]
    assert checked(written, tmp_path).valid
    found = pb.design("paper", maximize="region", controller=None, resolution_deg=1.0)
    assert found.certificate is not None
    assert found.certificate.data["claims"] == [*ONE_TURNS, *BOTH_TURN]

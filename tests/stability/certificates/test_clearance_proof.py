# SPDX-License-Identifier: Apache-2.0
"""Certificates of clearance from palms as long as they are: true, decided, and hard to forge."""

import copy
import json
import math
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import palmbots as pb
from certificate_cases import checked, numbers
from clearance_cases import arch, keel, lips, touches
from palmbots import check as check_function
from palmbots._types import SIDES
from palmbots.cli.main import run
from palmbots.stability.certificates.prover import Certificate, certify
from palmbots.stability.clearance import outline_clearance
from palmbots.stability.problem import stability_problem
from sampled import amounts

Array = NDArray[np.float64]
CLEARANCE = ("clearance",)


def proved(scene: Any, **given: Any) -> Certificate:
    return certify(scene, claims=CLEARANCE, **given)


def sampled(box: dict[str, Any], rng: np.random.Generator, n: int) -> NDArray[np.bool_]:
    """Whether each of many random points of a box touches, many of them at its corners."""

    def anything(low: Any, high: Any) -> Array:
        share = np.where(rng.random(n) < 0.5, rng.integers(0, 2, n), rng.random(n))
        return np.asarray(low) + (np.asarray(high) - np.asarray(low)) * share

    low, high = ({s: numbers(box[key][s]) for s in SIDES} for key in ("shallow_deg", "steep_deg"))
    w = anything(*numbers(box["width_m"]))
    turning = rng.integers(0, 4, n)  # none but steep, left, right, all shallow
    angles, p = [], []
    region = rng.integers(1, 3, n)
    for i, side in enumerate(SIDES):
        steep, shallow = anything(*high[side]), anything(*low[side])
        between = anything(low[side][0], high[side][1])
        angles.append(
            np.radians(np.where(turning == 3, shallow, np.where(turning == i + 1, between, steep)))
        )
        ends = numbers(box["contacts_m"][side])
        top = np.where((turning == i + 1) & (region == 1), 0.0, ends[1])
        bottom = np.where((turning == 2 - i) & (region == 2), 0.0, ends[0])
        p.append(anything(bottom, top))
    offset = [anything(*numbers(box["offset_m"][side])) for side in SIDES]
    rise = [p[i] * np.sin(angles[i]) + offset[i] * np.cos(angles[i]) for i in (0, 1)]
    tilt = np.arcsin((rise[1] - rise[0]) / w)
    found = np.zeros(n, dtype=bool)
    for i, side in enumerate(SIDES):
        outline = np.array([[*numbers((v[i], v[2]))] for v in box["outline_m"]])
        half = numbers(box["half_length_m"][side])[1]
        alpha = angles[i] + (tilt if i == 0 else -tilt)
        for k in range(n) if len(set(w)) > 1 else ():
            outline[box["right_contact"] if i == 0 else 0, 0] = w[k]
            found[k] |= touches(outline, alpha[k], half + p[i][k], half - p[i][k])[0]
        if len(set(w)) == 1:
            found |= touches(outline, alpha, half + p[i], half - p[i])
    return found


def certainly_touches(box: dict[str, Any], witness: dict[str, Any]) -> bool:
    side = witness["claim"].split()[1]
    i = SIDES.index(side)
    at = {k: numbers(witness[k].values()) for k in ("angle_deg", "contacts_m", "offset_m")}
    angles, p = np.radians(at["angle_deg"]), at["contacts_m"]
    rise = [p[k] * math.sin(angles[k]) + at["offset_m"][k] * math.cos(angles[k]) for k in (0, 1)]
    w = float(Fraction(witness["width_m"]))
    tilt = math.asin((rise[1] - rise[0]) / w)
    outline = np.array([[*numbers((v[i], v[2]))] for v in box["outline_m"]])
    outline[box["right_contact"] if i == 0 else 0, 0] = w
    half = float(Fraction(witness["half_length_m"][side]))
    alpha = np.array([angles[i] + (tilt if i == 0 else -tilt)])
    return bool(touches(outline, alpha, np.array(half + p[i]), np.array(half - p[i]))[0])


def random_case(rng: np.random.Generator) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """(scene, changes, uncertainty)."""
    thing = [lips, arch, keel][rng.integers(3)](round(float(rng.uniform(0.002, 0.035)), 4))
    shallow = round(float(rng.uniform(-1, 6)), 2)
    changes = {"palm.shallow_deg": shallow, "palm.left.length_m": 0.15 - 0.01 * rng.integers(3)}
    reach = round(float(rng.uniform(0.002, 0.06)), 4)
    given: dict[str, Any] = {"region_m": (-reach, reach)}
    if rng.random() < 0.6:
        given["shallow_deg"] = (shallow - 0.1, shallow + 0.1)
    if rng.random() < 0.4:
        given["length_m"] = (0.13, 0.152)
    if rng.random() < 0.4:
        given["offset_m"] = (0.0, 0.002)
    if rng.random() < 0.3:
        given["width_m"] = (0.249, 0.2502)
    return thing, changes, given


@pytest.mark.parametrize("cases", amounts(14, 32))
def test_verdicts_agree_with_brute_force(cases: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    verdicts = {"holds": 0, "fails": 0, "undecided": 0}
    halved = 0
    for _ in range(cases):
        thing, changes, given = random_case(rng)
        found = proved(thing, overrides=changes, max_boxes=300, **given)
        verdicts[found.verdict] += 1
        if found.verdict == "undecided":
            continue
        assert checked(found.data, tmp_path).valid
        box = found.data["box"]
        if found.verdict == "holds":
            halved += found.parts > 12
            assert not sampled(box, rng, 300).any()
        else:
            assert certainly_touches(box, found.data["witness"])
    assert verdicts["holds"] > 10 / 32 * cases
    assert verdicts["fails"] > 6 / 32 * cases
    assert verdicts["undecided"] < 5 / 32 * cases
    assert halved > 2 / 32 * cases


@pytest.mark.parametrize("drop", [0.002, 0.02, 0.03])
def test_verdict_changes_at_the_limit_of_analyze(drop: float) -> None:
    """Palms a little shorter than the margin are certified; a little longer they touch."""
    at = stability_problem(pb.load_scene(lips(drop)), (-0.005, 0.005))
    found = outline_clearance(at)
    room = found.length_margin.margin if found.length_margin else 0.3
    for more, verdict in ((-5e-4, "holds"), (5e-5, "fails")):
        length = round(0.15 + 2 * (room + more), 6)
        if found.length_margin or more < 0:
            given = {"length_m": (length, length), "region_m": (-0.005, 0.005)}
            assert proved(lips(drop), **given).verdict == verdict


def test_palms_of_any_length_are_proved_at_corners() -> None:
    """Where no vertex comes down to the line of a palm, its length costs nothing."""
    for length in (0.15, 9.0):
        found = proved("paper", length_m=(0.15, length), region_m=(-0.07, 0.07))
        assert (found.verdict, found.parts) == ("holds", 12)


def test_clearance_is_claimed_by_default() -> None:
    """At 3° the palm meets the box's bottom, though the properties hold."""
    overrides = {"palm.shallow_deg": 3.0}
    properties = ("property 1", "property 2", "property 0")
    assert certify("paper", overrides=overrides, claims=properties).verdict == "holds"
    found = certify("paper", overrides=overrides)
    assert (found.verdict, found.data["witness"]["fails"]) == ("fails", "clearance")


# ---- forged certificates -------------------------------------------------------------------------


def held() -> dict[str, Any]:
    """A tight claim: lips that clear the palms' back ends by less than a millimetre."""
    found = proved(lips(0.02), length_m=(0.15, 0.163), region_m=(-0.01, 0.01))
    assert found.verdict == "holds"
    return found.data


def failed() -> dict[str, Any]:
    """A lip that a back end meets: no edge at a contact."""
    found = proved(lips(0.02), length_m=(0.15, 0.18), region_m=(-0.01, 0.01))
    assert found.verdict == "fails"
    return found.data


@pytest.fixture(scope="module")
def claims() -> dict[str, dict[str, Any]]:
    return {"held": held(), "failed": failed()}


def put(where: str, value: Any) -> Callable[[dict[str, Any]], None]:
    def change(data: dict[str, Any]) -> None:
        at: Any = data
        *path, last = where.split(".")
        for key in path:
            at = at[int(key)] if isinstance(at, list) else at[key]
        at[int(last) if isinstance(at, list) else last] = value

    return change


def _swap(data: dict[str, Any]) -> None:
    """A proof of its own for each half, the wrong way round."""
    for tree in data["proof"].values():
        if isinstance(tree, list):
            tree[2], tree[3] = tree[3], tree[2]


def _clockwise(data: dict[str, Any]) -> None:
    box = data["box"]
    outline = box["outline_m"]
    box["outline_m"] = [outline[0], *reversed(outline[1:])]
    box["right_contact"] = len(outline) - box["right_contact"]


def _drop(data: dict[str, Any]) -> None:
    """Half of a halved box is said to be proved whole, and the other half is left out."""
    for name, tree in data["proof"].items():
        if isinstance(tree, list):
            data["proof"][name] = tree[:3]


def _leaves(data: dict[str, Any]) -> None:
    data["proof"] = dict.fromkeys(data["proof"], "corners")


def _lower_lip(data: dict[str, Any]) -> None:
    for vertex in data["box"]["outline_m"]:
        if vertex[2] == "0.02" and float(Fraction(vertex[0])) > 0.3:
            vertex[2] = "0.012"


def _one_sided(data: dict[str, Any]) -> None:
    """The lip seen from the left palm only: no object has it there and not there."""
    for vertex in data["box"]["outline_m"]:
        if vertex[2] == "0.02" and float(Fraction(vertex[0])) < 0:
            vertex[0] = "-0.2"


def _only_left(data: dict[str, Any]) -> None:
    data["proof"] = {k: tree for k, tree in data["proof"].items() if "clear left" in k}


def _narrower_above(data: dict[str, Any]) -> None:
    """A corner far above the palms is elsewhere as seen from the left palm; nothing touches."""
    for vertex in data["box"]["outline_m"]:
        if vertex[2] == "0.07" and float(Fraction(vertex[0])) > 0:
            vertex[0] = "0.36"


FORGED: dict[str, Callable[[dict[str, Any]], None]] = {
    "longer palm": put("box.half_length_m.left.1", "0.084"),
    "longer right palm": put("box.half_length_m.right.1", "0.084"),
    "no palm": put("box.half_length_m.left", ["0", "0.08"]),
    "length upside down": put("box.half_length_m.left", ["0.08", "0.07"]),
    "length a number": put("box.half_length_m.left.1", 0.08),
    "no lengths": put("box.half_length_m", {}),
    "larger region": put("box.contacts_m.left.0", "-0.02"),
    "steeper": put("box.steep_deg.left", ["15", "16"]),
    "flatter": put("box.shallow_deg.left", ["-30", "5"]),
    "offset": put("box.offset_m.right", ["0", "0.03"]),
    "offset as it was": put("box.offset_m.right", "0"),
    "width": put("box.width_m.0", "0.2"),
    "lip lower": _lower_lip,
    "lip elsewhere": _one_sided,
    "two outlines": _narrower_above,
    "clockwise": _clockwise,
    "other contact": put("box.right_contact", 2),
    "no contact": put("box.right_contact", 99),
    "left twice": put("box.right_contact", 0),
    "contact true": put("box.right_contact", True),
    "contact text": put("box.right_contact", "3"),
    "contact moved": put("box.outline_m.0.2", "-0.1"),
    "an edge only": put("box.outline_m", [["0", "0.25", "0"], ["0.25", "0", "0"]]),
    "vertex with two numbers": put("box.outline_m.5", ["0", "0"]),
    "another format": put("format", "palmbots certificate 1"),
    "claims more": put("claims", ["clearance", "property 1"]),
    "claims other": put("claims", ["endless clearance"]),
    "fails instead": put("verdict", "fails"),
    "halves swapped": _swap,
    "half dropped": _drop,
    "no halves": _leaves,
    "one palm only": _only_left,
    "halved outside": put("proof.clear left left 1", ["p left", "0.5", "corners", "corners"]),
    "halved at its end": put("proof.clear left left 1", ["p left", "-0.01", "corners", "corners"]),
    "halved nothing": put("proof.clear left left 1", ["p", "0", "corners", "corners"]),
    "friction halved": put("proof.clear left left 1", ["friction", "0.3", "corners", "corners"]),
    "a word": put("proof.clear right left 1", "endless"),
}


@pytest.mark.parametrize("name", FORGED)
def test_forged_claims_are_refused(
    name: str, claims: dict[str, dict[str, Any]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = copy.deepcopy(claims["held"])
    assert any(isinstance(tree, list) for tree in data["proof"].values())
    FORGED[name](data)
    assert data != claims["held"]
    target = tmp_path / "forged.json"
    target.write_text(json.dumps(data))
    status = run(["check", str(target)])
    shown = capsys.readouterr()
    assert status == (2 if name == "another format" else 1)
    assert "VALID" not in shown.out.replace("INVALID", "")
    if status == 2:
        assert shown.err.count("\n") == 1


FORGED_WITNESSES: dict[str, Callable[[dict[str, Any]], None]] = {
    "another edge": put("witness.edge", 1),
    "its neighbour": put("witness.edge", 4),
    "an edge at the contact": put("witness.edge", 0),
    "no edge": put("witness.edge", 99),
    "edge true": put("witness.edge", True),
    "edge text": put("witness.edge", "3"),
    "negative edge": put("witness.edge", -1),
    "too long a palm": put("witness.half_length_m", {"left": "0.5", "right": "0.5"}),
    "the shortest palm": put("witness.half_length_m", {"left": "0.075", "right": "0.075"}),
    "another place": put("witness.contacts_m", {"left": "0.01", "right": "0.01"}),
    "beyond the region": put("witness.contacts_m", {"left": "-0.075", "right": "-0.075"}),
    "another angle": put("witness.angle_deg", {"left": "20", "right": "20"}),
    "another width": put("witness.width_m", "0.26"),
    "another offset": put("witness.offset_m", {"left": "0.01", "right": "0"}),
    "another pose": put("witness.claim", "clear left nowhere"),
    "a property": put("witness.claim", "1 left"),
    "holds instead": put("verdict", "holds"),
    "shorter palms": put("box.half_length_m.left", ["0.05", "0.06"]),
}


@pytest.mark.parametrize("name", FORGED_WITNESSES)
def test_forged_witnesses_are_refused(
    name: str, claims: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    data = copy.deepcopy(claims["failed"])
    assert checked(data, tmp_path).valid
    FORGED_WITNESSES[name](data)
    found = checked(data, tmp_path)
    assert not found.valid
    assert found.reason


def test_truncated_files_are_refused(
    claims: dict[str, dict[str, Any]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = json.dumps(claims["held"], indent=1)
    target = tmp_path / "short.json"
    for length in range(0, len(whole) - 1, 1999):
        target.write_text(whole[:length])
        assert run(["check", str(target)]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_random_edits_prove_nothing_false(tmp_path: Path) -> None:
    """Digits of the box changed at random: what is still valid must be true."""
    data = proved(lips(0.03), region_m=(-0.02, 0.02)).data
    rng = np.random.default_rng(7)
    original = json.dumps(data)
    first, last = original.index('"box"'), original.index('"verdict"')
    digits = [k for k in range(first, last) if original[k].isdigit()]
    target = tmp_path / "edited.json"
    valid = 0
    for _ in range(80):
        letters = list(original)
        for place in rng.choice(digits, 2):
            letters[place] = str(rng.integers(10))
        target.write_text("".join(letters))
        if check_function(target).valid:
            valid += 1
            assert not sampled(json.loads("".join(letters))["box"], rng, 200).any()
    assert 5 < valid < 60

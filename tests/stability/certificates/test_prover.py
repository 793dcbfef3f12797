# SPDX-License-Identifier: Apache-2.0
"""Certificates of the properties: true, and decided where brute force decides."""

import json
import math
import random
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots import check as check_function
from palmbots._types import SIDES
from palmbots.cli.main import run
from palmbots.scene.spec import to_spec
from palmbots.stability.certificates.obligations import CLAIMS
from palmbots.stability.certificates.parameter_box import exact, text
from palmbots.stability.certificates.prover import Certificate, certify
from palmbots.stability.problem import stability_problem
from sampled import amounts
from stability_oracle import happens

SOURCE = Path(pb.__file__).parent

UNCERTAIN: list[dict[str, Any]] = [
    {},
    {"com_x_m": (0.12, 0.13), "com_y_m": (0.03, 0.05)},
    {"friction": (0.3, 0.5), "common_friction": True, "com_x_m": (0.12, 0.13)},
    {"friction": (0.25, 0.28), "friction_right": (0.26, 0.3)},
    {"shallow_deg": (4.95, 5.2), "steep_deg": (14.5, 15.5), "friction": (0.3, 0.31)},
    {"width_m": (0.24, 0.26), "length_m": (0.14, 0.16)},
    {"slope_deg": (-1.2, 1.2), "com_polygon_m": [(0.12, 0.03), (0.13, 0.04), (0.125, 0.05)]},
]


def saved(certificate: Certificate, folder: Path) -> Path:
    path = folder / "certificate.json"
    certificate.save(path)
    return path


@pytest.mark.parametrize("uncertainty", UNCERTAIN, ids=str)
def test_boxes_that_hold_are_certified(uncertainty: dict[str, Any], tmp_path: Path) -> None:
    certificate = certify("paper", **uncertainty)
    assert certificate.verdict == "holds"
    found = check_function(saved(certificate, tmp_path))
    assert (found.valid, found.reason) == (True, "")
    assert found.claim == f"holds: {', '.join(CLAIMS)}"


def ends(pair: list[str]) -> tuple[float, float]:
    low, high = (float(Fraction(v)) for v in pair)
    return low, high


def sampled_holds(data: dict[str, Any], rng: np.random.Generator, n: int) -> bool:
    """Whether properties 1 and 2 hold at random points of a certificate's box."""
    box = data["box"]
    at = stability_problem(pb.load_scene("paper"))
    corners = np.array([[float(Fraction(v)) for v in point] for point in box["com_m"]])
    for _ in range(n):
        weights = rng.dirichlet(np.full(len(corners), 0.3))
        x, y = weights @ corners
        mu = [rng.uniform(*ends(box["friction"][side])) for side in SIDES]
        if box["friction"]["common"]:
            mu[1] = mu[0]
        for number in (1, 2):
            for shallow in SIDES:
                angles, p = [], []
                for side in SIDES:
                    key = "shallow_deg" if side == shallow else "steep_deg"
                    angles.append(math.radians(rng.uniform(*ends(box[key][side]))))
                    low, high = ends(box["contacts_m"][side])
                    if number == 1 and side == shallow:
                        high = min(high, 0.0)
                    if number == 2 and side != shallow:
                        low = max(low, 0.0)
                    p.append(np.append(rng.uniform(low, high, 6), [low, low, high, high]))
                p[1][-4:] = p[1][[-4, -1, -4, -1]]
                if not happens(
                    at,
                    number,
                    shallow,
                    (angles[0], angles[1]),
                    (p[0], p[1]),
                    com_x=x,
                    com_y=y,
                    friction_left=mu[0],
                    friction_right=mu[1],
                    width=rng.uniform(*ends(box["width_m"])),
                    slope=rng.uniform(*ends(box["slope"])),
                ).all():
                    return False
    return True


def random_uncertainty(rng: np.random.Generator) -> dict[str, Any]:
    def around(middle: float, size: float) -> tuple[float, float]:
        half = rng.uniform(0, size)
        return round(middle - half, 5), round(middle + half, 5)

    given = {
        "com_x_m": around(rng.uniform(0.115, 0.135), 0.008),
        "com_y_m": around(0.04, 0.02),
        "friction": around(rng.uniform(0.2, 0.6), 0.04),
        "common_friction": bool(rng.integers(2)),
        "shallow_deg": around(rng.uniform(4.5, 8), 0.2),
        "steep_deg": around(rng.uniform(14, 24), 0.3),
    }
    return {k: v for k, v in given.items() if k == "common_friction" or rng.random() < 0.7}


@pytest.mark.slow
@pytest.mark.parametrize("cases", amounts(15, 36))
def test_verdicts_agree_with_brute_force(cases: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    verdicts = {"holds": 0, "fails": 0, "undecided": 0}
    for _ in range(cases):
        certificate = certify(
            "paper", claims=("property 1", "property 2"), **random_uncertainty(rng)
        )
        verdicts[certificate.verdict] += 1
        if certificate.verdict == "undecided":
            continue
        assert check_function(saved(certificate, tmp_path)).valid
        if certificate.verdict == "holds":
            assert sampled_holds(certificate.data, rng, 40)
            continue
        witness = certificate.data["witness"]
        number, shallow = int(witness["claim"][0]), witness["claim"].split()[1]
        both = {
            key: [float(Fraction(witness[key][s])) for s in SIDES]
            for key in ("angle_deg", "friction", "contacts_m")
        }
        angles = tuple(math.radians(a) for a in both["angle_deg"])
        at = stability_problem(pb.load_scene("paper"))
        x, y = (float(Fraction(v)) for v in witness["com_m"])
        p = (np.array(both["contacts_m"][0]), np.array(both["contacts_m"][1]))
        assert not happens(
            at,
            number,
            shallow,
            (angles[0], angles[1]),
            p,
            com_x=x,
            com_y=y,
            friction_left=both["friction"][0],
            friction_right=both["friction"][1],
            width=float(Fraction(witness["width_m"])),
            slope=float(Fraction(witness["slope"])),
        ).all()
    assert verdicts["holds"] > cases / 4
    assert verdicts["fails"] > cases / 4


def test_verdict_changes_at_the_limit_of_analyze() -> None:
    low, high = pb.analyze("paper").com_x_m or (0.0, 0.0)
    for inset, verdict in ((1e-9, "holds"), (-1e-9, "fails")):
        found = certify("paper", com_x_m=(round(low + inset, 12), round(high - inset, 12)))
        assert found.verdict == verdict


def test_few_boxes_leave_the_claim_undecided() -> None:
    found = certify(
        "paper", friction=(0.3, 0.5), common_friction=True, com_x_m=(0.117, 0.133), max_boxes=5
    )
    assert found.verdict == "undecided"
    assert found.undecided
    assert "proof" not in found.data


def test_undecided_claim_renames_an_older_certificate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`certify -o FILE; check FILE` must not end in VALID, and no file of the user is lost."""
    path = tmp_path / "box.json"
    assert run(["certify", "-o", str(path)]) == 0
    older = path.read_bytes()
    capsys.readouterr()
    flat = ["--set", "palm.shallow_deg=0", "--region", "0,0"]  # it lies on the palm
    for suffix in (".old", ".old2"):
        assert run(["certify", *flat, "-o", str(path), "--json"]) == 1
        said = capsys.readouterr()
        assert json.loads(said.out)["verdict"] == "undecided"
        said_line = " ".join(said.err.split())  # it is wrapped
        assert said_line.endswith(f"was renamed to {path}{suffix}")
        assert run(["check", str(path)]) == 2
        capsys.readouterr()
        assert Path(f"{path}{suffix}").read_bytes() == older
        path.write_bytes(older)
    path.unlink()
    assert run(["certify", *flat, "-o", str(path), "--json"]) == 1
    assert capsys.readouterr().err == ""


def test_mutated_certificates_neither_crash_nor_prove_falsehoods(tmp_path: Path) -> None:
    chance = random.Random(4)
    rng = np.random.default_rng(4)
    original = json.dumps(
        certify("paper", friction=(0.3, 0.5), common_friction=True, com_x_m=(0.12, 0.13)).data
    )
    target = tmp_path / "mutated.json"
    valid = 0
    for _ in range(60):
        letters = list(original)
        for _ in range(chance.randint(1, 3)):
            place = chance.randrange(len(letters))
            letters[place] = chance.choice('0123456789.-"[]{},:/a')
        target.write_text("".join(letters))
        try:
            found = check_function(target)
        except pb.PalmbotsError:
            continue
        if found.valid and found.claim.startswith("holds"):
            valid += 1
            data = json.loads("".join(letters))
            if {"property 1", "property 2"} <= set(data["claims"]):
                assert sampled_holds(data, rng, 5)
    assert valid < 40


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_slope_interval_is_in_degrees_uphill_in_travel(direction: str) -> None:
    """The box contains the slopes of all scenes of the interval, hardly more, and no others."""
    scene = pb.load_scene("paper", {"task.direction": direction})
    box = certify(scene, slope_deg=(-1.0, 3.0), claims=("property 1",)).data["box"]
    low, high = ends(box["slope"])
    sign = 1 if direction == "forward" else -1
    slopes = sorted(sign * math.tan(math.radians(degrees)) for degrees in (-1, 3))
    assert low <= slopes[0] < low + 1e-11
    assert high - 1e-11 < slopes[1] <= high
    for degrees, inside in ((-1.0, True), (3.0, True), (3.001, False), (-1.001, False)):
        slope = to_spec(pb.load_scene(scene, {"task.slope_deg": degrees})).slope
        assert (low <= slope <= high) == inside


def test_friction_is_independent_unless_common_is_asked_for() -> None:
    assert certify("paper", friction=(0.3, 0.5)).verdict == "fails"
    assert certify("paper", friction=(0.3, 0.5), common_friction=True).verdict == "holds"
    assert run(["certify", "--friction", "0.3", "0.5", "--common-friction"]) == 0
    assert run(["certify", "--friction", "0.3", "0.5", "--independent-friction"]) == 1
    assert run(["design", "--friction", "0.3", "0.5", "--region", "palm"]) == 2
    words = ["--region", "palm", "--resolution-deg", "1", "--common-friction", "--maximize", "com"]
    words += ["--set", "task.distance_m=0.1"]
    assert run(["design", "--friction", "0.3", "0.5", *words]) == 0


def test_numbers_are_written_exactly() -> None:
    rng = random.Random(1)
    for _ in range(300):
        value = Fraction(rng.randint(-(10**9), 10**9), rng.choice([1, 8, 1000, 10**9, 3, 7]))
        assert Fraction(text(value)) == value
    assert text(exact(0.1)) == "0.1"
    assert text(Fraction(-1, 8)) == "-0.125"


def test_failing_certificate_claims_at_least_one_failure(tmp_path: Path) -> None:
    """A witness refutes one claim and states nothing about the others."""
    failing = certify("paper", length_m=(0.14, 0.17))
    assert failing.verdict == "fails"
    assert check_function(saved(failing, tmp_path)).claim == (
        f"fails: at least one of {', '.join(CLAIMS)}"
    )
    alone = certify("paper", length_m=(0.14, 0.17), claims=("clearance",))
    assert check_function(saved(alone, tmp_path)).claim == "fails: clearance"


def test_a_common_friction_is_tried_where_frictions_of_their_own_fail() -> None:
    interval = (0.2, 0.5)
    found = certify("paper", friction=interval)
    alone = certify("paper", friction=interval, common_friction=True)
    assert found.verdict == "fails" and alone.verdict == "holds" == found.with_common_friction
    assert any("--common-friction" in str(line) for line in found.lines())
    assert certify("paper", friction=(0.28, 0.36)).with_common_friction is None
    assert certify("paper", com_x_m=(0.1, 0.15)).with_common_friction is None

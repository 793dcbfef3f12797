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
from palmbots.cli import run
from palmbots.sections import SIDES
from palmbots.stability.box import exact, text
from palmbots.stability.certificate import Certificate, certify
from palmbots.stability.situation import situation_of
from test_stability import happens

SOURCE = Path(pb.__file__).parent

UNCERTAIN: list[dict[str, Any]] = [
    {},
    {"com_x_m": (0.12, 0.13), "com_y_m": (0.03, 0.05)},
    {"friction": (0.3, 0.5), "common": True, "com_x_m": (0.12, 0.13)},
    {"friction": (0.25, 0.28), "friction_right": (0.26, 0.3)},
    {"shallow_deg": (4.95, 5.2), "steep_deg": (14.5, 15.5), "friction": (0.3, 0.31)},
    {"width_m": (0.24, 0.26), "length_m": (0.14, 0.16)},
    {"slope": (-0.02, 0.02), "com_polygon_m": [(0.12, 0.03), (0.13, 0.04), (0.125, 0.05)]},
]


def saved(certificate: Certificate, folder: Path) -> Path:
    path = folder / "certificate.json"
    certificate.save(path)
    return path


@pytest.mark.parametrize("uncertainty", UNCERTAIN, ids=str)
def test_certified_to_hold(uncertainty: dict[str, Any], tmp_path: Path) -> None:
    certificate = certify("paper", **uncertainty)
    assert certificate.verdict == "holds"
    found = check_function(saved(certificate, tmp_path))
    assert (found.valid, found.why) == (True, "")
    assert found.claim == "holds: property 1, property 2, property 0, clearance"


def ends(pair: list[str]) -> tuple[float, float]:
    low, high = (float(Fraction(v)) for v in pair)
    return low, high


def sampled_holds(data: dict[str, Any], rng: np.random.Generator, n: int) -> bool:
    """Whether properties 1 and 2 hold at random points of a certificate's box."""
    box = data["box"]
    at = situation_of(pb.load_scene("paper"))
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
        "common": bool(rng.integers(2)),
        "shallow_deg": around(rng.uniform(4.5, 8), 0.2),
        "steep_deg": around(rng.uniform(14, 24), 0.3),
    }
    return {k: v for k, v in given.items() if k == "common" or rng.random() < 0.7}


def test_verdicts_agree_with_brute_force(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    verdicts = {"holds": 0, "fails": 0, "undecided": 0}
    for _ in range(60):
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
        at = situation_of(pb.load_scene("paper"))
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
    assert verdicts["holds"] > 10
    assert verdicts["fails"] > 10


def test_the_line_is_drawn_where_analyze_draws_it() -> None:
    low, high = pb.analyze("paper").com_x_m or (0.0, 0.0)
    for inset, verdict in ((1e-9, "holds"), (-1e-9, "fails")):
        found = certify("paper", com_x_m=(round(low + inset, 12), round(high - inset, 12)))
        assert found.verdict == verdict


def test_little_work_leaves_it_undecided() -> None:
    found = certify("paper", friction=(0.3, 0.5), common=True, com_x_m=(0.117, 0.133), most_parts=5)
    assert found.verdict == "undecided"
    assert found.undecided
    assert "proof" not in found.data


def test_an_older_certificate_does_not_pass_for_an_undecided_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`certify -o FILE; check FILE` may not end in VALID; and nothing of the user's is lost."""
    path = tmp_path / "box.json"
    assert run(["certify", "-o", str(path)]) == 0
    older = path.read_bytes()
    capsys.readouterr()
    flat = ["--set", "palm.shallow_deg=0", "--region-m", "0", "0"]  # it lies on the palm
    for suffix in (".old", ".old2"):
        assert run(["certify", *flat, "-o", str(path), "--json"]) == 1
        said = capsys.readouterr()
        assert json.loads(said.out)["verdict"] == "undecided"
        (line,) = said.err.splitlines()
        assert line.endswith(f"{path} was of an earlier run: it is {path}{suffix} now")
        assert run(["check", str(path)]) == 2
        capsys.readouterr()
        assert Path(f"{path}{suffix}").read_bytes() == older
        path.write_bytes(older)
    path.unlink()
    assert run(["certify", *flat, "-o", str(path), "--json"]) == 1
    assert capsys.readouterr().err == ""


def test_no_mutation_crashes_the_check_or_proves_what_is_false(tmp_path: Path) -> None:
    chance = random.Random(4)
    rng = np.random.default_rng(4)
    original = json.dumps(
        certify("paper", friction=(0.3, 0.5), common=True, com_x_m=(0.12, 0.13)).data
    )
    target = tmp_path / "mutated.json"
    valid = 0
    for _ in range(150):
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
    assert valid < 100


def test_numbers_are_written_exactly() -> None:
    rng = random.Random(1)
    for _ in range(300):
        value = Fraction(rng.randint(-(10**9), 10**9), rng.choice([1, 8, 1000, 10**9, 3, 7]))
        assert Fraction(text(value)) == value
    assert text(exact(0.1)) == "0.1"
    assert text(Fraction(-1, 8)) == "-0.125"


def test_bad_intervals_are_refused() -> None:
    bad: tuple[dict[str, Any], ...] = (
        {"com_x_m": (0.13, 0.12)},
        {"friction": (-0.1, 0.2)},
        {"friction": (0.2, 0.3), "friction_right": (0.3, 0.4), "common": True},
        {"shallow_deg": (4.0, 16.0)},
        {"steep_deg": (60.0, 85.0)},
        {"region_m": (0.01, 0.02)},
        {"region_m": (-0.5, 0.5)},
        {"com_x_m": (math.nan, 0.2)},
        {"com_polygon_m": [(0.1, 0.1)], "com_x_m": (0.1, 0.1)},
        {"friction": 0.3},
        {"friction": (0.2, 0.3, 0.4)},
        {"friction": "ab"},
    )
    for given in bad:
        with pytest.raises(pb.PalmbotsError, match="allowed"):
            certify("paper", **given)


def test_of_nothing_nothing_is_certified() -> None:
    """A claim that nobody knows has no obligations, all of which would hold."""
    for claims in ((), ("propert 1",), ("property 1", "x"), "clearance"):
        with pytest.raises(pb.PalmbotsError, match=r"claims: .*allowed: .*property 1"):
            certify("paper", claims=claims)  # type: ignore[arg-type]


def test_a_failing_certificate_does_not_say_that_every_claim_fails(tmp_path: Path) -> None:
    """A witness refutes one claim; of the others it says nothing."""
    failing = certify("paper", length_m=(0.14, 0.17))
    assert failing.verdict == "fails"
    assert check_function(saved(failing, tmp_path)).claim == (
        "fails: at least one of property 1, property 2, property 0, clearance"
    )
    alone = certify("paper", length_m=(0.14, 0.17), claims=("clearance",))
    assert check_function(saved(alone, tmp_path)).claim == "fails: clearance"

"""Certificates: true, refused when tampered with, and checked by code that shares nothing."""

import ast
import copy
import json
import math
import random
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx, fmpq

import palmbots as pb
from palmbots import check as check_function
from palmbots import exact_forms
from palmbots.enclosures import cosine_of_degrees, root, sine_of_degrees
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


def test_clearance_is_part_of_it() -> None:
    """At 3° the palm's end meets the box, though both properties hold."""
    overrides = {"palm.shallow_deg": 3.0}
    properties = ("property 1", "property 2", "property 0")
    assert certify("paper", overrides=overrides, claims=properties).verdict == "holds"
    assert certify("paper", overrides=overrides, most_parts=300).verdict == "undecided"


TAMPERED: list[tuple[str, Any]] = [
    ("box.com_m.0.0", "0.10"),
    ("box.friction.left.1", "0.9"),
    ("box.shallow_deg.right.0", "1"),
    ("box.shallow_deg.left", ["6", "5"]),
    ("box.steep_deg.left.0", "85"),
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
    assert found.why


def test_a_witness_has_to_lie_in_the_box(tmp_path: Path) -> None:
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


@pytest.mark.parametrize(
    "content", [b"", b"{", b"[]", b'{"format": "other"}', b"\xff\xfe", b"[" * 10**5]
)
def test_what_is_no_certificate(content: bytes, tmp_path: Path) -> None:
    target = tmp_path / "no.json"
    target.write_bytes(content)
    with pytest.raises(pb.PalmbotsError, match=r"no\.json: is no certificate"):
        check_function(target)


def test_prover_and_checker_share_nothing() -> None:
    def imports(path: Path) -> set[str]:
        found = set()
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module:
                found.add(node.module)
            elif isinstance(node, ast.Import):
                found |= {name.name for name in node.names}
        return found

    own = {m for m in imports(SOURCE / "check.py") if m.startswith("palmbots")}
    forms = {"palmbots.enclosures", "palmbots.exact_forms"}
    assert own == forms | {"palmbots.errors", "palmbots.exact_clearance"}
    for name, needs in (("exact_forms", {"palmbots.enclosures"}), ("exact_clearance", forms)):
        exact = imports(SOURCE / f"{name}.py")
        assert {m for m in exact if m.startswith("palmbots")} == needs
        assert not exact & {"flint", "numpy"}
    assert imports(SOURCE / "enclosures.py") == {"fractions", "functools", "math"}
    assert not imports(SOURCE / "check.py") & {"flint", "numpy"}
    for path in (SOURCE / "stability").glob("*.py"):
        if path.name not in ("cli.py", "report.py"):
            assert "palmbots.check" not in imports(path)


def test_enclosures_of_the_checker() -> None:
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


def test_the_checker_encloses_the_objects_angle() -> None:
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
        box = exact_forms.Box(
            turned, (zero, zero), (exact(widths[0]), exact(widths[1])), placed, False
        )
        above = (exact(offsets[0]), exact(offsets[0])), (exact(offsets[1]), exact(offsets[1]))
        given = exact_forms.Given((), zero, above)
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
    )
    for given in bad:
        with pytest.raises(pb.PalmbotsError, match="allowed"):
            certify("paper", **given)


def refused(data: dict[str, Any], folder: Path) -> str:
    target = folder / "false.json"
    target.write_text(json.dumps(data))
    found = check_function(target)
    assert not found.valid
    return found.why


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
        certify("paper", friction=(0.3, 0.5), common=True, com_x_m=(0.117, 0.133)).data
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
    keel["box"]["outline_m"].append(["0.02", "0.23", "-0.01"])
    assert "touch a palm" in refused(keel, tmp_path)

    wedged = copy.deepcopy(certify("paper", claims=("property 1",)).data)
    for side in SIDES:
        wedged["box"]["friction"][side] = ["20", "20"]
    assert refused(wedged, tmp_path)

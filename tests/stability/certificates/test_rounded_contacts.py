# SPDX-License-Identifier: Apache-2.0
"""Certificates of rounded contact vertices: what they contain, and what the checker refuses."""

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import ctx

import palmbots as pb
from claims_oracle import States
from palmbots.errors import PalmbotsError
from palmbots.stability.certificates.box_from_scene import box_of
from palmbots.stability.certificates.checker.certificate_file import Entry
from palmbots.stability.certificates.checker.claimed_box import read_box
from palmbots.stability.certificates.checker.property_conditions import (
    ParameterBox as CheckedBox,
)
from palmbots.stability.certificates.checker.touching_points import (
    ContactArcs,
    Interval,
    _cosines,
)
from palmbots.stability.certificates.contact_arcs import at_contacts
from palmbots.stability.certificates.obligations import FORCE_CLAIMS, Subbox
from palmbots.stability.certificates.prover import certify
from sampled import amounts

CARTON = {"object": "carton"}
ROUND = [0.02, 0.008, 0.0, 0.0]
COM_LOST_M = 1e-3  # what the analysis may permit less, as in stability/test_rounded_contacts.py


def changed(data: dict[str, Any], folder: Path, **keys: Any) -> Path:
    """The file of a certificate with other keys of its object."""
    copy = json.loads(json.dumps(data))
    copy["scene"]["object"] |= keys
    path = folder / "certificate.json"
    path.write_text(json.dumps(copy))
    return path


def between(rng: np.random.Generator, ends: tuple[Fraction, Fraction], n: int) -> Any:
    share = np.where(rng.random(n) < 0.5, rng.random(n), rng.integers(0, 2, n))
    return float(ends[0]) + float(ends[1] - ends[0]) * share


@pytest.mark.parametrize(("polygon", "share"), [(False, 1), (True, 1), (False, Fraction(1, 50))])
def test_both_enclosures_contain_the_touching_points(polygon: bool, share: Fraction) -> None:
    """Width and COM of states in random parts of a box, and the enclosures are not much wider."""
    rng = np.random.default_rng(1)
    used: list[float] = []
    for _ in range(40):
        radii = tuple(rng.uniform(0, 0.03, 2))
        body = {"box_m": [0.25, 0.16], "edge_radius_m": [*radii, 0, 0], "com_m": [0.12, 0.06]}
        triangle = [[0.1, 0.04], [0.15, 0.05], [0.12, 0.09]]
        coms: dict[str, Any] = {"com_polygon_m": triangle}
        if not polygon:
            far = 0.01 * float(share)
            coms = {"com_x_m": (0.12 - far, 0.12 + far), "com_y_m": (0.06 - far, 0.06 + far)}
        box = box_of(
            pb.load_scene({"object": body}),
            width_m=(0.25 - 0.01 * float(share), 0.25 + 0.01 * float(share)),
            offset_m=(0.01 - 0.01 * float(share), 0.01),
            **coms,
        )
        low = [[Fraction(round(float(v), 3)) for v in rng.uniform(-30, 30, 2)] for _ in range(2)]
        size = share * Fraction(int(rng.integers(0, 20)), 2)
        left, right = ((a, a + size) for a, _ in low)
        angles = left, right
        ends = [sorted(Fraction(int(v), 1000) for v in rng.integers(-75, 75, 2)) for _ in range(2)]
        one, two = ((a, a + share * (b - a)) for a, b in ends)
        contacts = one, two
        part = Subbox(angles, box.friction, box.width, contacts)
        with ctx.workprec(128):
            proved = at_contacts(box, part)
        claimed = read_box(Entry(json.loads(json.dumps(box.as_dict()))))
        arcs = ContactArcs.of(claimed.outline, box.radius)
        checked = arcs.touching(
            CheckedBox(angles, box.friction, box.width, contacts, False), claimed.params
        )
        assert proved is not None
        n = 2000
        corners = np.array([[float(v) for v in corner] for corner in box.com])
        states = States(
            width=between(rng, box.width, n),
            com=(rng.dirichlet(np.full(len(corners), 0.3), n) @ corners).T,
            theta=np.radians([between(rng, one, n) for one in angles]),
            p=np.stack([between(rng, one, n) for one in contacts]),
            friction=np.zeros((2, n)),
            offset=np.stack([between(rng, one, n) for one in box.offset]),
            slope=np.zeros(n),
        ).touching((float(box.radius[0]), float(box.radius[1])))
        for width, com in (
            (proved[1].width, proved[0].com),
            (checked[0].width, checked[1].com),
        ):
            xs, ys = zip(*com, strict=True)
            rows = ((states.width, width), (states.com[0], xs), (states.com[1], ys))
            for values, limits in rows:
                least, most = float(min(limits)), float(max(limits))
                assert least <= values.min() + 1e-12 and values.max() - 1e-12 <= most
                used.append((values.max() - values.min()) / (most - least))
    assert np.median(used) > 0.4


def test_intervals_of_the_checker_contain_every_result_and_little_more() -> None:
    """Also where the extreme is inside: the square at 0, the cosine at 0°."""
    rng = np.random.default_rng(3)
    for _ in range(300):
        low, least = (Fraction(int(v), 10) for v in rng.integers(-20, 20, 2))
        size, more = (Fraction(int(v), 10) for v in rng.integers(0, 20, 2))
        one, other = Interval(low, low + size), Interval(least, least + more)
        xs, ys = (np.linspace(float(of.low), float(of.high), 41) for of in (one, other))
        results = [(one + other, xs[:, None] + ys), (one - other, xs[:, None] - ys)]
        results += [(one * other, xs[:, None] * ys), (one.square(), xs**2)]
        if least > 0:
            results += [(one.over(other), xs[:, None] / ys), (other.root(), np.sqrt(ys))]
        ends = _cosines((30 * low, 30 * (low + size)))
        results.append((Interval(min(ends), max(ends)), np.cos(np.radians(30 * xs))))
        for found, values in results:
            assert float(found.low) - 1e-12 <= values.min() <= float(found.low) + 0.01
            assert float(found.high) - 0.01 <= values.max() <= float(found.high) + 1e-12


@pytest.mark.parametrize("overrides", [CARTON, {"object.edge_radius_m": ROUND}])
def test_certificate_is_valid_and_says_what_it_does_not_claim(
    overrides: dict[str, Any], tmp_path: Path
) -> None:
    found = certify("paper", overrides=overrides, friction=(0.28, 0.32))
    assert found.verdict == "holds" and found.claims == FORCE_CLAIMS
    assert "which suffices" in str(found) and "clearance is not certified" in str(found)
    path = tmp_path / "certificate.json"
    found.save(path)
    assert pb.check(path, pb.load_scene("paper", overrides)).valid
    other = pb.check(path, pb.load_scene("paper", overrides | {"object.edge_radius_m": 0.011}))
    assert not other.valid and "another object" in other.reason
    for claim in ("clearance", "clearance turning"):
        with pytest.raises(PalmbotsError, match="a contact vertex is rounded"):
            certify("paper", overrides=overrides, claims=[claim])


@pytest.mark.parametrize("cases", amounts(100, 2000))
def test_proves_the_properties_that_the_analysis_computes(cases: int) -> None:
    """In all random scenes. The analysis may permit a little less: it takes extreme tilts of the
    object as independent of the contacts, which the proof bisects."""
    rng = np.random.default_rng(5)
    held = 0
    for _ in range(cases):
        shallow = rng.uniform(-5, 20)
        com = [float(rng.uniform(0.08, 0.17)), float(rng.uniform(0.03, 0.15))]
        scene = pb.load_scene(
            {
                "object": {"com_m": com, "edge_radius_m": [*rng.uniform(0, 0.03, 2), 0, 0]},
                "palm": {
                    "length_m": rng.uniform(0.04, 0.16),
                    "shallow_deg": shallow,
                    "steep_deg": shallow + rng.uniform(3, 20),
                    "friction": rng.uniform(0.1, 0.8),
                },
            }
        )
        reports = list(pb.analyze(scene).properties.values())
        holds = all(one.holds for one in reports)
        nearly = all((one.margins.com_m or -1) > -COM_LOST_M for one in reports)
        verdict = certify(scene, claims=FORCE_CLAIMS[:3]).verdict
        assert verdict == ("holds" if holds else "undecided") or (nearly and not holds), scene
        held += holds
    assert held > cases / 10


def test_polygon_of_coms_is_no_rectangle(tmp_path: Path) -> None:
    """The higher the COM, the fewer places along the object hold."""
    keys = {"object.edge_radius_m": ROUND, "object.com_m": [0.13, 0.05]}
    corners = [[0.117, 0.02], [0.143, 0.02], [0.13, 0.12]]
    claims = ("property 1", "property 2")
    found = certify("paper", com_polygon_m=corners, claims=claims, overrides=keys)
    assert found.holds and pb.check(changed(found.data, tmp_path)).valid
    around: dict[str, Any] = {"com_x_m": (0.117, 0.143), "com_y_m": (0.02, 0.12)}
    assert not certify("paper", **around, claims=claims, overrides=keys).holds


def test_pipes_are_refused() -> None:
    with pytest.raises(PalmbotsError, match="makes the object a pipe"):
        certify("pipe")


@pytest.mark.parametrize(
    ("radius", "com_x", "tampered"),
    [(0, 0.118, ROUND), (0, 0.134, 0.02), (ROUND, 0.1385, 0), (ROUND, 0.122, [0.03, 0.008, 0, 0])],
)
def test_proof_for_other_radii_is_refused(
    radius: Any, com_x: float, tampered: Any, tmp_path: Path
) -> None:
    """Property 1 holds with one radius and not with the other."""
    at = {"object.com_m": [com_x, 0.08]}
    found, other = (
        certify("paper", claims=["property 1"], overrides=at | {"object.edge_radius_m": r})
        for r in (radius, tampered)
    )
    assert found.holds and not other.holds
    assert pb.check(changed(found.data, tmp_path)).valid
    result = pb.check(changed(found.data, tmp_path, edge_radius_m=tampered))
    assert not result.valid and "the wrong contact may slide" in result.reason


@pytest.mark.parametrize(
    ("claim", "com", "verdict", "reason"),
    [
        ("clearance", [0.125, 0.04], "holds", "no proof covers the clearance of rounded"),
        ("property 1", [0.05, 0.04], "fails", "no witness proves that a claim fails for rounded"),
    ],
)
def test_proof_of_another_kind_is_refused(
    claim: str, com: list[float], verdict: str, reason: str, tmp_path: Path
) -> None:
    """Those about the sharp outline, for a contact vertex that is hardly rounded."""
    found = certify("paper", claims=[claim], overrides={"object.com_m": com})
    assert found.verdict == verdict and pb.check(changed(found.data, tmp_path)).valid
    result = pb.check(changed(found.data, tmp_path, edge_radius_m=1e-4))
    assert not result.valid and reason in result.reason

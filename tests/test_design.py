"""Designed angles against brute force, their certificates, and what is refused."""

import importlib
import itertools
import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots import check as check_function
from palmbots.cli import run
from palmbots.sections import SIDES
from palmbots.stability.design import with_angles
from palmbots.stability.design_figure import draw
from palmbots.stability.region import reaction
from palmbots.stability.situation import Situation, situation_of
from test_stability import contacts, happens


def demands(at: Situation) -> Iterator[tuple[int, Any, Any, Any]]:
    """All that has to hold: property, shallow palm, palm angles, contacts at the corners."""
    for shallow in SIDES:
        for number in (0, 1, 2):
            for pose in at.poses(number, shallow) if number == 0 else [None]:
                palms = at.palms(shallow) if pose is None else pose.angles
                for region in (1, 2) if number == 0 else (number,):
                    alike = number == 0 and abs(palms[0] - palms[1]) < 1e-12
                    yield number, shallow, palms, contacts(at, 0 if alike else region, shallow, 2)


def brute_tolerance(at: Situation, angles: tuple[float, float], frictions: list[float]) -> float:
    """How far c_x may be from the scene's, by trying it every 0.4 mm at the region's corners."""
    steps = np.arange(0, 160) * 4e-4
    pair = at.with_(angles=(angles, angles))
    good = np.ones(len(steps), bool)
    # Axes: contacts, frictions, either way, steps.
    mu = np.array(frictions)[:, None, None]
    x = np.stack([at.com[0] - steps, at.com[0] + steps])
    for number, shallow, palms, p in demands(pair):
        places = (p[0][..., None, None, None], p[1][..., None, None, None])
        given = {"com_x": x, "friction_left": mu, "friction_right": mu}
        held = happens(pair, number, shallow, palms, places, **given)
        good &= held.reshape(-1, len(steps)).all(axis=0)
    return -1.0 if not good[0] else float(steps[np.argmin(good)] if not good.all() else steps[-1])


def test_the_answer_is_that_of_a_brute_force_search() -> None:
    found = pb.design(
        "paper", friction=(0.3, 0.5), region_m="palm", resolution_deg=3.0, angles_deg=(0.0, 45.0)
    )
    at = situation_of(found.scene)
    frictions = list(np.linspace(0.3, 0.5, 5))
    best = -1.0
    checked = 0
    for i, shallow in enumerate(found.map["shallow"].to_numpy()):
        for j, steep in enumerate(found.map["steep"].to_numpy()):
            if steep - shallow < 4.9:
                continue
            mine = float(found.map["tolerance"][i, j])
            if (i + j) % 3 != 0 and mine <= 0:
                continue  # where nothing holds a third of the grid will do
            brute = brute_tolerance(at, (math.radians(shallow), math.radians(steep)), frictions)
            # Frictions between those tried, and a step of c_x, are what brute force misses.
            assert (brute < 0) == (mine < 0) or abs(mine) < 6e-4, (shallow, steep)
            if mine > 0:
                assert brute == pytest.approx(mine, abs=6e-4), (shallow, steep)
            checked += 1
            if found.map["clearance"][i, j] >= 0.25:
                best = max(best, brute)
    assert checked > 40
    assert found.tolerance == pytest.approx(best, abs=6e-4)


def holds_everywhere(at: Situation, frictions: list[float], slopes: list[float]) -> bool:
    """Properties 0, 1 and 2, either palm shallow, tried state by state."""
    mu, slope = np.meshgrid(frictions, slopes)
    given = {"friction_left": mu, "friction_right": mu, "slope": slope}
    for number, shallow, palms, p in demands(at):
        places = (p[0][..., None, None], p[1][..., None, None])
        if not happens(at, number, shallow, palms, places, **given).all():
            return False
    return True


def wrong_by(at: Situation, quantity: str, by: float) -> list[Situation]:
    """The extremes where one quantity of a palm or of the region is off by `by`."""
    if quantity == "region":
        return [at.with_(contacts=((-by, by), (-by, by)))]
    if quantity == "angle":
        return [
            at.with_(
                angles=tuple((s + e, t + e) for (s, t), e in zip(at.angles, errors, strict=True))
            )
            for errors in itertools.product((-by, 0.0, by), repeat=2)
        ]
    return [at]


def holds_with_an_error(at: Situation, quantity: str, by: float) -> bool:
    """Whether everything holds with one quantity off by as much as `by`, either way."""
    frictions, slopes = [at.friction[0]], [at.slope]
    if quantity == "friction":
        frictions = list(np.linspace(max(0.0, at.friction[0] - by), at.friction[0] + by, 5))
    if quantity == "slope":
        slopes = [at.slope - by, at.slope, at.slope + by]
    return all(holds_everywhere(wrong, frictions, slopes) for wrong in wrong_by(at, quantity, by))


@pytest.mark.parametrize(
    ("quantity", "step"),
    [("friction", 0.01), ("slope", 0.005), ("region", 1e-3), ("angle", math.radians(0.2))],
)
def test_every_tolerance_is_that_of_a_scan(quantity: str, step: float) -> None:
    region = (-0.025, 0.025)
    found = pb.design(
        "paper", maximize=quantity, region_m=region, resolution_deg=4.0, angles_deg=(1.0, 37.0)
    )
    at = situation_of(found.scene, region)
    equal = 0
    for i, shallow in enumerate(found.map["shallow"].to_numpy()):
        for j, steep in enumerate(found.map["steep"].to_numpy()):
            mine = float(found.map["tolerance"][i, j])
            if not (steep - shallow >= 4.9 and (i + 2 * j) % 5 == 0 and mine > 0):
                continue
            pair = (math.radians(shallow), math.radians(steep))
            here = at.with_(angles=(pair, pair))
            least = 0.0
            while least < mine + 3 * step and holds_with_an_error(here, quantity, least + step):
                least += step
            # Never more than a scan finds, and less only where the outline would touch.
            assert mine < least + step, (shallow, steep)
            beyond = wrong_by(here, quantity, mine + step)
            if all(wrong.envelope().clearance(wrong.angles) >= 0 for wrong in beyond):
                assert mine > least - step, (shallow, steep)
                equal += 1
    assert equal >= 3


def test_more_tolerant_than_the_papers_angles() -> None:
    """At least 1.4 × the COM tolerance of 5° and 15°, over the whole palm, cleared and proved."""
    found = pb.design("paper", friction=(0.3, 0.5), region_m="palm")
    assert found.paper_tolerance == pytest.approx(0.00904, abs=1e-5)
    assert found.tolerance >= 1.4 * (found.paper_tolerance or math.inf)
    assert found.clearance_deg >= 0.25
    assert found.certificate.verdict == "holds"


@pytest.mark.parametrize(
    "maximize", ["com", "friction", "slope", "acceleration", "region", "angle"]
)
def test_every_quantity_gets_a_certificate(maximize: str, tmp_path: Path) -> None:
    found = pb.design("paper", maximize=maximize, resolution_deg=1.0)
    assert found.certificate.verdict == "holds"
    found.certificate.save(tmp_path / "design.json")
    assert check_function(tmp_path / "design.json").valid
    assert found.steep_deg - found.shallow_deg >= 5
    assert found.tolerance > 0


def test_the_certificate_is_tight() -> None:
    """A hundredth more tolerance can be refuted, and nothing on the map has more."""
    found = pb.design("paper", friction=(0.3, 0.5), region_m="palm", resolution_deg=0.5)
    most = float(found.map["tolerance"].where(found.map["allowed"]).max())
    assert found.tolerance == pytest.approx(most, rel=1e-8)
    x = found.scene.object.com_m[0]
    more = found.tolerance * 1.01
    refuted = pb.certify(
        with_angles(found.scene, found),
        com_x_m=(x - more, x + more),
        friction=(0.3, 0.5),
        common=True,
    )
    assert refuted.verdict == "fails"


def test_designed_angles_carry() -> None:
    found = pb.design("paper")
    scene = with_angles(found.scene, found)
    report = pb.analyze(scene)
    assert report.holds
    done = [pb.carry(scene, seed=seed, record=False).outcome for seed in range(20)]
    assert done.count("delivered") == 20


def test_each_palm_its_own_friction_tolerates_less() -> None:
    common = pb.design("paper", friction=(0.28, 0.32), resolution_deg=1.0)
    each = pb.design("paper", friction=(0.28, 0.32), common=False, resolution_deg=1.0)
    assert each.tolerance < common.tolerance
    assert each.certificate.verdict == "holds"


def test_the_implied_region_holds_the_contacts_of_carries() -> None:
    for scene in (pb.load_scene("paper"), pb.load_scene("paper", {"robot.noise_m_s": 0.006})):
        palm = scene.palm
        reach = float(
            reaction(scene, math.radians(palm.shallow_deg), math.radians(palm.steep_deg)).reach_m
        )
        for seed in range(100):
            done = pb.carry(scene, seed=seed, record=False)
            assert max(done.contact_peak_m.values()) <= reach
    assert reach < 0.04  # not the whole palm


def test_less_time_to_react_is_a_larger_region() -> None:
    scene = pb.load_scene("paper")
    slow = pb.load_scene("paper", {"radio.latency_s": 0.2})
    near, far = (reaction(scene, 0.1, a).reach_m for a in (0.2, 0.4))
    assert near < far
    assert reaction(slow, 0.1, 0.2).reach_m > near
    assert reaction(slow, 0.1, 0.2).asked_s - reaction(scene, 0.1, 0.2).asked_s == pytest.approx(
        0.3
    )


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"maximize": "beauty"}, "allowed: com, friction"),
        ({"resolution_deg": 0.0}, "resolution_deg"),
        ({"resolution_deg": math.nan}, "resolution_deg"),
        ({"angles_deg": (20.0, 10.0)}, "angles_deg"),
        ({"least_difference_deg": -1.0}, "least_difference_deg"),
        ({"least_clearance_deg": math.nan}, "least_clearance_deg"),
        ({"friction": (0.5, 0.3)}, "friction"),
        ({"friction": (-0.5, 0.3)}, "friction"),
        ({"friction": 0.3}, "friction: value is 0.3; allowed: two numbers"),
        ({"angles_deg": 5}, "angles_deg: value is 5; allowed: two numbers"),
        ({"slope": (0, 0.1, 0.2)}, "slope: .*allowed: two numbers"),
        ({"region_m": (0.01, 0.02)}, "region_m"),
        ({"region_m": "somewhere"}, "region_m"),
        ({"friction": (0.01, 0.9)}, "no pair of angles qualifies"),
        ({"least_clearance_deg": 40.0}, "clearance is at most"),
        ({"overrides": {"palm.left.friction": 0.4}}, "common"),
    ],
    ids=str,
)
def test_refused_in_one_line(given: dict[str, object], match: str) -> None:
    with pytest.raises(pb.PalmbotsError, match=match):
        pb.design("paper", **({"resolution_deg": 1.0} | given))  # pyright: ignore[reportArgumentType]


def test_the_map_is_drawn_with_units_and_the_papers_angles() -> None:
    found = pb.design("paper", resolution_deg=1.0)
    axes = draw(found).axes[0]
    assert axes.get_xlabel() == "steep palm angle [°]"
    assert axes.get_ylabel() == "shallow palm angle [°]"
    assert any("paper 5° / 15°" in text.get_text() for text in axes.texts)


def test_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["design", "--friction", "0.3", "0.5", "--region", "palm", "--resolution-deg", "0.5"]
    assert run([*words, "--json", "--out", str(tmp_path)]) == 0
    found = json.loads(capsys.readouterr().out)
    keys = "shallow_deg steep_deg tolerance friction friction_floor reaction_s certificate scene"
    assert set(keys.split()) <= set(found)
    assert run(["check", str(tmp_path / "design.json"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["valid"] is True
    assert (tmp_path / "design.png").read_bytes()[:4] == b"\x89PNG"
    assert run(["design", "--region", "0.1;0.2"]) == 2
    assert "allowed: implied, palm" in capsys.readouterr().err
    assert run(["certify", "--com-x-m", "0.12", "0.13", "-o", str(tmp_path / "c.json")]) == 0
    assert run(["certify", "--friction", "0.3", "0.5"]) == 1
    (tmp_path / "c.json").write_text((tmp_path / "c.json").read_text()[:-200])
    assert run(["check", str(tmp_path / "c.json")]) == 2
    capsys.readouterr()
    assert run(["analyze", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    keys = "properties bands com_x_m friction max_slope_deg max_acceleration_m_s2 scene"
    assert set(keys.split()) <= set(found)
    assert set(found["properties"]) == {"0", "1", "2"}
    assert run(["analyze", "--set", "palm.friction=0.02"]) == 0
    assert "FAILS" in capsys.readouterr().out
    assert run(["analyze", "--region-m", "0.5", "0.6"]) == 2
    assert "allowed" in capsys.readouterr().err


@pytest.mark.parametrize(("kind", "start"), [("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_the_map_as_vectors(kind: str, start: bytes, tmp_path: Path) -> None:
    words = ["design", "--region", "palm", "--resolution-deg", "2", "--format", kind]
    for name in ("one", "two"):
        assert run([*words, "--out", str(tmp_path / name)]) == 0
    files = [(tmp_path / name / f"design.{kind}").read_bytes() for name in ("one", "two")]
    assert files[0].startswith(start)
    assert files[0] == files[1]
    assert run(["design", "--format", "gif", "--out", str(tmp_path / "three")]) == 2
    assert not (tmp_path / "three").exists()


def test_of_equals_the_pair_that_turns_least() -> None:
    """On the whole palm many pairs reach its end; the quickest of them is taken."""
    found = pb.design("paper", maximize="region", region_m="palm", resolution_deg=1.0)
    value = found.map["tolerance"].where(found.map["allowed"])
    best = value >= float(value.max()) * (1 - 1e-9)
    assert int(best.sum()) > 3
    turns = (found.map["steep"] - found.map["shallow"]).where(best)
    assert found.steep_deg - found.shallow_deg == float(turns.min())


def test_the_search_stays_within_the_limits_of_the_angles() -> None:
    found = pb.design("paper", angles_deg=(2.0, 17.0), resolution_deg=1.0, least_clearance_deg=0.0)
    for name in ("shallow", "steep"):
        assert float(found.map[name].min()) >= 2.0
        assert float(found.map[name].max()) <= 17.0
    assert float(found.map["shallow"].min()) == 2.0
    assert float(found.map["steep"].max()) == 17.0


def test_an_older_certificate_does_not_pass_for_the_designs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["design", "--region", "palm", "--resolution-deg", "2", "--out", str(tmp_path)]
    assert run(words) == 0
    older = (tmp_path / "design.json").read_bytes()
    found = pb.design("paper", region_m="palm", resolution_deg=2.0)
    unproved = replace(found.certificate, verdict="undecided", undecided="property 1")
    module = importlib.import_module("palmbots.stability.design")
    monkeypatch.setattr(module, "design", lambda *_, **__: replace(found, certificate=unproved))
    capsys.readouterr()
    assert run(words) == 0
    assert "design.json.old now" in capsys.readouterr().err
    assert {path.name for path in tmp_path.iterdir()} == {"design.png", "design.json.old"}
    assert (tmp_path / "design.json.old").read_bytes() == older

# SPDX-License-Identifier: Apache-2.0
"""Designed angles against brute force, their certificates, and what is refused."""

import functools
import importlib
import itertools
import json
import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots import check as check_function
from palmbots._types import SIDES
from palmbots.cli.main import run
from palmbots.stability import Design, design_carries
from palmbots.stability.design_carries import carries_of_measurement, time_line
from palmbots.stability.figures.palm_angles_figure import palm_angles
from palmbots.stability.palm_angles import with_angles
from palmbots.stability.problem import StabilityProblem, stability_problem
from palmbots.stability.reaction_region import reaction
from palmbots.viz.style import styled
from stability_oracle import contacts, happens


def designed(scene: Any, **given: Any) -> Design:
    """A design for a tolerance, of the COM by default, without carries."""
    wanted: dict[str, Any] = {"maximize": "com", "controller": None, **given}
    return pb.design(scene, **wanted)


def demands(at: StabilityProblem) -> Iterator[tuple[int, Any, Any, Any]]:
    """All that has to hold: property, shallow palm, palm angles, contacts at the corners."""
    corners = functools.cache(lambda number, shallow: contacts(at, number, shallow, 2))
    for shallow in SIDES:
        for number in (0, 1, 2):
            for pose in at.poses(number, shallow) if number == 0 else [None]:
                palms = at.palms(shallow) if pose is None else pose.angles
                for region in (1, 2) if number == 0 else (number,):
                    alike = number == 0 and abs(palms[0] - palms[1]) < 1e-12
                    yield number, shallow, palms, corners(0 if alike else region, shallow)


def brute_tolerance(
    at: StabilityProblem, angles: tuple[float, float], frictions: list[float]
) -> float:
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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("resolution_deg", "least"), [(5.0, 15), pytest.param(3.0, 40, marks=pytest.mark.soak)]
)
def test_best_pair_agrees_with_a_brute_force_search(resolution_deg: float, least: int) -> None:
    found = designed(
        "paper",
        friction=(0.3, 0.5),
        common_friction=True,
        region_m="palm",
        resolution_deg=resolution_deg,
        angle_range_deg=(0.0, 45.0),
    )
    at = stability_problem(found.scene)
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
    assert checked > least
    assert found.tolerance == pytest.approx(best, abs=6e-4)


def holds_everywhere(at: StabilityProblem, frictions: list[float], slopes: list[float]) -> bool:
    """Properties 0, 1 and 2, either palm shallow, state by state; each palm its own friction."""
    left, right, slope = (values.ravel() for values in np.meshgrid(frictions, frictions, slopes))
    given = {"friction_left": left, "friction_right": right, "slope": slope}
    alike: defaultdict[tuple[int, Any], list[tuple[Any, Any]]] = defaultdict(list)
    for number, shallow, palms, p in demands(at):
        alike[number, shallow].append((palms, p))
    for (number, shallow), cases in alike.items():
        # Axes: cases, contacts, conditions.
        angles = [np.array([palms[k] for palms, _ in cases])[:, None, None] for k in (0, 1)]
        places = [np.stack([p[k].ravel() for _, p in cases])[..., None] for k in (0, 1)]
        held = happens(at, number, shallow, (angles[0], angles[1]), (places[0], places[1]), **given)
        if not held.all():
            return False
    return True


def wrong_by(at: StabilityProblem, quantity: str, by: float) -> list[StabilityProblem]:
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


def holds_with_an_error(at: StabilityProblem, quantity: str, by: float) -> bool:
    """Whether everything holds with one quantity off by as much as `by`, either way."""
    frictions, slopes = [at.friction[0]], [at.slope]
    if quantity == "friction":
        frictions = list(np.linspace(max(0.0, at.friction[0] - by), at.friction[0] + by, 3))
    if quantity == "slope":
        slopes = [at.slope - by, at.slope, at.slope + by]
    return all(holds_everywhere(wrong, frictions, slopes) for wrong in wrong_by(at, quantity, by))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("quantity", "step"),
    [("friction", 0.01), ("slope", 0.005), ("region", 1e-3), ("angle", math.radians(0.2))],
)
def test_tolerances_agree_with_a_scan(quantity: str, step: float) -> None:
    region = (-0.025, 0.025)
    found = designed(
        "paper", maximize=quantity, region_m=region, resolution_deg=4.0, angle_range_deg=(1.0, 37.0)
    )
    at = stability_problem(found.scene, region)
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


def test_best_pair_tolerates_1_4_times_the_papers_pair() -> None:
    """At least 1.4 × the COM tolerance of 5° and 15°, over the whole palm, cleared and proved."""
    found = designed("paper", friction=(0.3, 0.5), common_friction=True, region_m="palm")
    assert found.paper_tolerance == pytest.approx(0.00904, abs=1e-5)
    assert found.tolerance >= 1.4 * (found.paper_tolerance or math.inf)
    assert found.clearance_deg >= 0.25
    assert found.certificate is not None and found.is_certified


@pytest.mark.parametrize(
    "maximize", ["com", "friction", "slope", "acceleration", "region", "angle"]
)
def test_every_quantity_gets_a_certificate(maximize: str, tmp_path: Path) -> None:
    found = designed("paper", maximize=maximize, resolution_deg=1.0)
    assert found.certificate is not None and found.is_certified
    found.certificate.save(tmp_path / "design.json")
    assert check_function(tmp_path / "design.json").valid
    assert found.steep_deg - found.shallow_deg >= 5
    assert found.tolerance > 0


def test_one_percent_more_tolerance_is_refuted() -> None:
    """A hundredth more tolerance can be refuted, and nothing on the map has more."""
    found = designed(
        "paper", friction=(0.3, 0.5), common_friction=True, region_m="palm", resolution_deg=0.5
    )
    most = float(found.map["tolerance"].where(found.map["allowed"]).max())
    assert found.tolerance == pytest.approx(most, rel=1e-8)
    x = found.scene.object.com_m[0]
    more = found.tolerance * 1.01
    refuted = pb.certify(
        with_angles(found.scene, found),
        com_x_m=(x - more, x + more),
        friction=(0.3, 0.5),
        common_friction=True,
    )
    assert refuted.verdict == "fails"


def test_carries_with_designed_angles_are_delivered() -> None:
    found = designed("paper")
    scene = with_angles(found.scene, found)
    assert scene == found.designed_scene
    report = pb.analyze(scene)
    assert report.holds
    done = [pb.carry(scene, seed=seed, record=False).outcome for seed in range(20)]
    assert done.count("delivered") == 20


def test_independent_friction_tolerates_less_than_common_friction() -> None:
    common = designed("paper", friction=(0.28, 0.32), common_friction=True, resolution_deg=1.0)
    each = designed("paper", friction=(0.28, 0.32), resolution_deg=1.0)  # the default
    assert each.tolerance < common.tolerance
    assert each.certificate is not None and each.is_certified


def test_implied_region_contains_the_contacts_of_carries() -> None:
    for scene in (pb.load_scene("paper"), pb.load_scene("paper", {"robot.noise_m_s": 0.006})):
        palm = scene.palm
        reach = float(
            reaction(scene, math.radians(palm.shallow_deg), math.radians(palm.steep_deg)).reach_m
        )
        for seed in range(100):
            done = pb.carry(scene, seed=seed, record=False)
            assert max(done.contact_peak_m.values()) <= reach
    assert reach < 0.04  # not the whole palm


def test_longer_reaction_time_enlarges_the_region() -> None:
    scene = pb.load_scene("paper")
    slow = pb.load_scene("paper", {"radio.latency_s": 0.2})
    near, far = (reaction(scene, 0.1, a).reach_m for a in (0.2, 0.4))
    assert near < far
    assert reaction(slow, 0.1, 0.2).reach_m > near
    assert reaction(slow, 0.1, 0.2).asked_s - reaction(scene, 0.1, 0.2).asked_s == pytest.approx(
        0.3
    )


@pytest.mark.parametrize("scene", ["paper", {"object": "l-shape"}], ids=str)
def test_map_has_units_and_a_legend_that_covers_nothing(scene: Any) -> None:
    """The legend names both marks, the limit of the clearance, and the areas; outside the map."""
    design = designed(scene, resolution_deg=0.5)
    figure = palm_angles(design)
    axes, bar = figure.axes
    assert axes.get_xlabel() == "steep palm angle [°]"
    assert axes.get_ylabel() == "shallow palm angle [°]"
    (legend,) = figure.legends
    texts = [text.get_text() for text in legend.get_texts()]
    assert texts[0].startswith(f"best pair, {design.shallow_deg:g}° and {design.steep_deg:g}°")
    assert texts[0].endswith(f"clearance {design.clearance_deg:.2f}°")
    assert texts[1].startswith("paper, 5° and 15°: ±")
    assert "clearance below 0.25°" in texts[2]
    with styled():
        figure.draw_without_rendering()
        box = legend.get_window_extent()
        assert not axes.texts
        assert box.y0 >= axes.bbox.y1
        assert box.x0 >= 0 and box.x1 <= figure.bbox.width
        assert box.y1 <= figure.bbox.height
    # Contour lines stand in the colour bar, each with its number.
    contours = [float(tick) for tick in bar.get_yticks()]
    assert len(contours) >= 3


@pytest.mark.slow
def test_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["design", "--maximize", "com", "--friction", "0.3", "0.4", "--region", "palm"]
    words += ["--resolution-deg", "2", "--set", "task.distance_m=0.1"]
    assert run([*words, "--json", "--out", str(tmp_path)]) == 0
    found = json.loads(capsys.readouterr().out)
    keys = (
        "shallow_deg steep_deg tolerance friction friction_floor reaction_s certificate scene "
        "sigma_star_m_s designed_scene"
    )
    assert set(keys.split()) <= set(found)
    assert run(["check", str(tmp_path / "design.json"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["valid"] is True
    assert (tmp_path / "design.png").read_bytes()[:4] == b"\x89PNG"
    assert run(["certify", "--com-x-m", "0.12", "0.13", "-o", str(tmp_path / "c.json")]) == 0
    assert run(["certify", "--friction", "0.3", "0.5"]) == 1
    (tmp_path / "c.json").write_text((tmp_path / "c.json").read_text()[:-200])
    assert run(["check", str(tmp_path / "c.json")]) == 2
    capsys.readouterr()
    assert run(["analyze", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    keys = "properties bands com_x_m friction max_slope_deg max_acceleration_m_s2 scene"
    assert set(keys.split()) <= set(found)
    assert set(found["properties"]) == {"closing", "opening", "turning"}
    assert run(["analyze", "--set", "palm.friction=0.02"]) == 0
    assert "FAILS" in capsys.readouterr().out


def test_slope_in_degrees_changes_the_design() -> None:
    """An interval of 3° costs tolerance; its certificate contains the tangents of both ends."""
    level = designed("paper", resolution_deg=1.0)
    sloped = designed("paper", slope_deg=(-3.0, 3.0), resolution_deg=1.0)
    assert sloped.tolerance < level.tolerance
    assert sloped.certificate is not None
    low, high = (float(Fraction(end)) for end in sloped.certificate.data["box"]["slope"])
    assert -low == pytest.approx(high)
    assert high == pytest.approx(math.tan(math.radians(3.0)), abs=1e-11)


def test_tie_prefers_smallest_angle_difference() -> None:
    """On the whole palm many pairs reach its end; the quickest of them is taken."""
    found = designed("paper", maximize="region", region_m="palm", resolution_deg=1.0)
    value = found.map["tolerance"].where(found.map["allowed"])
    best = value >= float(value.max()) * (1 - 1e-9)
    assert int(best.sum()) > 3
    turns = (found.map["steep"] - found.map["shallow"]).where(best)
    assert found.steep_deg - found.shallow_deg == float(turns.min())


def test_search_stays_within_the_angle_range() -> None:
    found = designed(
        "paper", angle_range_deg=(2.0, 17.0), resolution_deg=1.0, min_clearance_deg=0.0
    )
    for name in ("shallow", "steep"):
        assert float(found.map[name].min()) >= 2.0
        assert float(found.map[name].max()) <= 17.0
    assert float(found.map["shallow"].min()) == 2.0
    assert float(found.map["steep"].max()) == 17.0


def test_undecided_design_renames_an_older_certificate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["design", "--region", "palm", "--resolution-deg", "2", "--out", str(tmp_path)]
    words += ["--maximize", "com", "--set", "task.distance_m=0.1"]
    assert run(words) == 0
    older = (tmp_path / "design.json").read_bytes()
    found = designed("paper", region_m="palm", resolution_deg=2.0)
    assert found.certificate is not None
    unproved = replace(found.certificate, verdict="undecided", undecided="property 1")
    module = importlib.import_module("palmbots.stability.palm_angles")
    monkeypatch.setattr(module, "design", lambda *_, **__: replace(found, certificate=unproved))
    capsys.readouterr()
    assert run(words) == 1
    assert "design.json.old\n" in capsys.readouterr().err
    assert {path.name for path in tmp_path.iterdir()} == {
        "design.png", "design.json.old", "scene.toml",
    }  # fmt: skip
    assert (tmp_path / "design.json.old").read_bytes() == older


def test_time_of_a_design_is_stated_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_carries, "_MOMENT_S", 0.0)
    lines, done = list[str](), list[float]()

    def on_line(line: str) -> None:
        lines.append(line)
        assert done == []

    pb.design("paper", maximize="com", on_progress=done.append, on_line=on_line)
    assert [line[:23] for line in lines] == ["the design takes about "]
    assert done == sorted(done) and done[-1] == 1


def test_a_long_design_names_what_is_quicker() -> None:
    carries = 2 * carries_of_measurement("angle")
    line = time_line("noise", 1400.0, 97.0 / carries)
    assert line == (
        "the design takes about 23.3 min; --maximize angle, which compares pairs without carries, "
        "takes about 1.7 min"
    )
    assert time_line("noise", 50.0, 1.0) == "the design takes about 50.0 s"
    assert time_line("com", 1400.0, 1.0) == "the design takes about 23.3 min"
    assert time_line("noise", 1.0, 1.0) == ""

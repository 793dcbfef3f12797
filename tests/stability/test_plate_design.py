# SPDX-License-Identifier: Apache-2.0
"""`palmbots.design` of a job on the floor: no random plate has a larger tightest margin than the
designed one, and jobs with it succeed."""

import json
import random
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.cli.main import run
from sampled import amounts

GRID: dict[str, Any] = {"resolution_deg": 2.5, "angle_range_deg": (2.5, 25.0)}
RANGES = {
    "palm.nose_m": (0.0002, 0.001), "palm.bevel_m": (0.0, 0.02), "palm.heel_m": (0.0, 0.02),
    "palm.shallow_deg": (2.5, 20.0), "palm.steep_deg": (7.5, 25.0),
}  # fmt: skip
ONE: dict[str, Any] = {
    "angle_range_deg": (5.0, 15.0), "min_angle_difference_deg": 10.0, "resolution_deg": 5.0,
    "nose_range_m": (0.0003, 0.0003), "bevel_range_m": (0.008, 0.008),
    "heel_range_m": (0.012, 0.012),
}  # fmt: skip


def least_margin(scene: pb.Scene | str, values: dict[str, Any]) -> float | None:
    """Of a plate with which the job can begin; None: it cannot."""
    try:
        found = pb.analyze(scene, overrides=values)
    except pb.PalmbotsError:
        return None
    lifting = found.lifting
    assert lifting is not None
    certain = lifting.works and all(palm.gets_under for palm in lifting.palms.values())
    if not certain or not found.holds or found.clearance_deg < 0.25:
        return None
    return min(one.times for one in found.ranking if one.times is not None)


@pytest.mark.slow
@pytest.mark.parametrize("plates", amounts(100, 2000))
def test_no_random_plate_has_a_greater_least_margin(plates: int) -> None:
    """In the ranges of the search, between the points of its grid, too."""
    best = pb.design("lift", controller=None, **GRID)
    assert least_margin("lift", best.angle_keys) == pytest.approx(best.tolerance)
    assert best.own.tolerance == pytest.approx(least_margin("lift", {}))
    draw, tried = random.Random(plates), 0
    for _ in range(plates):
        values = {key: draw.uniform(*ends) for key, ends in RANGES.items()}
        if values["palm.steep_deg"] - values["palm.shallow_deg"] >= 5:
            least = least_margin("lift", values)
            tried += least is not None
            # Between the points of a coarse grid a plate may be a little better.
            assert least is None or least <= 1.03 * best.tolerance, values
    assert tried > plates / 10


def test_the_only_plate_of_a_grid_is_that_of_the_scene() -> None:
    best = pb.design("lift", controller=None, **ONE)
    assert best.plate is not None and best.plate.best.sizes() == best.plate.own.sizes()
    assert best.maximize == "lift" and best.tolerance == best.own.tolerance
    assert best.headline().startswith("DESIGNED  nose 0.3 mm, bevel 8 mm, heel 12 mm")


@pytest.mark.slow
def test_a_plate_that_jams_becomes_one_whose_jobs_succeed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The command writes a scene with it."""
    grid = ["--resolution-deg", "5", "--angle-range-deg", "5", "15"]
    grid += ["--min-angle-difference-deg", "10"]
    plate = ["--nose-range-m", "0.0004", "0.0004", "--bevel-range-m", "0.008", "0.008"]
    files = ["--heel-range-m", "0", "0.01", "--out", str(tmp_path), "--json"]
    assert run(["design", "lift", *grid, *plate, *files, "--set", "palm.heel_m=0"]) == 0
    found = json.loads(capsys.readouterr().out)
    own, best = found["plate"]["own"], found["plate"]["best"]
    assert "jam" in own["refusal"] and own["least_margin"] is None and own["counts"] is None
    assert (best["nose_m"], best["shallow_deg"], best["steep_deg"]) == (0.0004, 5, 15)
    assert 0.003 <= best["heel_m"] <= 0.01 and best["counts"] == found["counts"]
    assert (found["counts"]["carries"], found["counts"]["stalled"]) == (1000, 0)
    scene = pb.load_scene(tmp_path / "scene.toml")
    assert least_margin(scene, {}) == pytest.approx(best["least_margin"])
    assert pb.carry(scene, "shared-sign", seed=10**6).outcome == "delivered"

# SPDX-License-Identifier: Apache-2.0
"""Angles designed for delivery drop no more carries than the scene's own, by a paired test.

`make soak` tries 20 random objects with every shipped controller.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

import paired_drops
import palmbots as pb
from palmbots.cli.main import run
from palmbots.control.registry import shipped_names
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DROPPED, run_seeds
from palmbots.simulation.outcome_counts import count_outcomes
from palmbots.stability import Design
from palmbots.stability.certificates.checker.verify import check as check_function
from palmbots.stability.reaction_region import implied_reach_m
from random_scenes import random_scene

FRESH = 10**9  # no seed of a design


def dropped(scene: pb.Scene, noise_m_s: float, controller: str, carries: int) -> np.ndarray:
    spec = to_spec(pb.load_scene(scene, {"robot.noise_m_s": noise_m_s}))
    return run_seeds(spec, controller, FRESH, carries, threads=2)["outcome"] == DROPPED


def more_drops(design: Design, noise_m_s: float, controller: str, carries: int) -> float:
    """McNemar's exact one-sided p-value: the designed angles drop no more than the scene's own."""
    scenes = design.designed_scene, design.scene
    return paired_drops.more_drops(
        *(dropped(one, noise_m_s, controller, carries) for one in scenes)
    )


@pytest.fixture(scope="module")
def crate() -> Design:
    """A light object on short palms, for which steep palms tolerate most and fail first."""
    return pb.design(crate_scene(), resolution_deg=1.0)


def crate_scene() -> pb.Scene:
    return pb.load_scene(
        {
            "object": {
                "vertices_m": [(0, 0), (0.4, 0), (0.4, 0.1), (0, 0.1)], "contacts": [0, 1],
                "com_m": (0.2, 0.05), "mass_kg": 0.3,
            },
            "palm": {"length_m": 0.06},
            "task": {"distance_m": 0.15},
        }
    )  # fmt: skip


@pytest.mark.slow
def test_designed_angles_drop_no_more_than_the_own_ones(crate: Design) -> None:
    assert crate.noise_limit is not None and crate.own.noise_limit is not None
    assert crate.noise_limit.interval[1] > crate.own.noise_limit.interval[0]
    noise = crate.own.noise_limit.sigma_star_m_s
    mine, own = (
        dropped(scene, noise, "distributed", 4000) for scene in (crate.designed_scene, crate.scene)
    )
    assert paired_drops.more_drops(mine, own) > 0.01
    assert float(own.mean()) == pytest.approx(0.01, abs=0.007)


def test_largest_tolerance_fails_and_warns(crate: Design) -> None:
    """The objective that ignores time recommends angles with a lower σ*, and says so."""
    com = pb.design(crate_scene(), maximize="com", resolution_deg=1.0)
    assert com.noise_limit is not None and crate.noise_limit is not None
    assert com.tolerance > crate.tolerance
    assert com.noise_limit.interval[1] < crate.noise_limit.interval[0]
    assert com.reach_m > 0.03 >= com.region_m[1]
    text = " ".join(com.warnings)
    assert "contacts leave the palm before the robots react" in text
    assert "tolerate less noise than the scene's own" in text
    assert not any("react" in warning for warning in crate.warnings)


def test_designed_pair_is_certified_and_among_the_candidates(crate: Design, tmp_path: Path) -> None:
    assert crate.certificate is not None and crate.is_certified
    crate.certificate.save(tmp_path / "design.json")
    assert check_function(tmp_path / "design.json").valid
    place = {"shallow": crate.shallow_deg, "steep": crate.steep_deg}
    assert bool(crate.map["allowed"].sel(place))
    tried = crate.map["sigma_star"].notnull()
    assert int(tried.sum()) > 20
    assert bool(tried.sel(place)) and not bool((tried & ~crate.map["allowed"]).any())
    estimate = float(crate.map["sigma_star"].sel(place))
    assert estimate == pytest.approx(crate.sigma_star_m_s, rel=0.1)
    assert pb.analyze(crate.designed_scene, region_m=crate.region_m).holds


def test_scene_with_the_designed_angles_is_ready(crate: Design) -> None:
    keys = {"palm.shallow_deg": crate.shallow_deg, "palm.steep_deg": crate.steep_deg}
    assert crate.angle_keys == keys
    assert crate.designed_scene == pb.load_scene(crate.scene, keys)
    assert crate.scene.palm.shallow_deg == 5
    assert crate.own.angles_deg == (5, 15)
    figure = crate.plot()
    left, right, _ = figure.axes
    assert left.get_ylabel() == "shallow palm angle [°]" and right.get_ylabel() == "σ* [cm/s]"
    FigureCanvasAgg(figure).draw()


def test_designed_angles_have_carried_this_scene_with_its_controller(crate: Design) -> None:
    assert crate.counts is not None and crate.own.counts is not None
    assert crate.counts.dropped == count_outcomes(crate.designed_scene).dropped
    assert crate.own.counts.dropped == count_outcomes(crate.scene).dropped == 0
    assert crate.is_better_here is False  # no angles drop less than none
    reach = implied_reach_m(crate.scene)
    assert (
        crate.own.clearance_deg == pb.analyze(crate.scene, region_m=(-reach, reach)).clearance_deg
    )
    text = repr(crate)
    assert "do not fail measurably less than the scene's own" in text
    run = f"run: palmbots carry {crate.scene.spelled} --set palm."
    assert run in text and " -c distributed\n" in f"{text}\n"
    other = replace(crate, words="mine.toml --unproved")  # as the user named a policy
    assert repr(other).splitlines()[-1].endswith(" -c mine.toml --unproved")


def test_angles_of_one_palm_are_replaced_too() -> None:
    scene = pb.load_scene("paper", {"palm.left.steep_deg": 20.0})
    found = pb.design(scene, maximize="com", controller=None, resolution_deg=2.0)
    assert found.own.angles_deg is None and found.own.tolerance is None
    assert found.angle_keys["palm.left.steep_deg"] == found.steep_deg
    assert found.designed_scene.palm_of("left") == found.designed_scene.palm_of("right")
    assert found.noise_limit is None and found.sigma_star_m_s is None


@pytest.mark.slow
def test_command_writes_a_scene_and_prints_what_to_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["design", "--maximize", "com", "--resolution-deg", "2", "--set", "task.distance_m=0.2"]
    assert run([*words, "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "--set palm.shallow_deg=" in text and f"wrote {tmp_path}/scene.toml" in text
    assert run([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    ready = pb.load_scene(tmp_path / "scene.toml")
    assert ready.model_dump() == pb.load_scene(found["designed_scene"]).model_dump()
    assert found["scene"]["palm"]["shallow_deg"] == 5


@pytest.mark.parametrize(
    ("scene", "given"),
    [
        (
            {
                "object": {
                    "vertices_m": [(0, 0), (0.3, 0), (0.25, 0.2), (0.05, 0.2)],
                    "contacts": [0, 1], "com_m": (0.16, 0.12), "mass_kg": 0.5,
                }
            },
            {"friction": (0.3, 0.5), "region_m": "palm"},
        ),
        (
            {
                "object": {
                    "vertices_m": [(0, 0), (0.2, 0), (0.2, 0.6), (0, 0.6)], "contacts": [0, 1],
                    "com_m": (0.1, 0.3), "mass_kg": 0.5,
                }
            },
            {"friction": (0.3, 0.4), "region_m": (-0.04, 0.04)},
        ),
    ],
    ids=["trapezoid", "tower"],
)  # fmt: skip
def test_prover_decides_a_tolerance_near_the_largest(scene: Any, given: Any) -> None:
    """It cannot decide one that is smaller by a millionth only."""
    found = pb.design(scene, maximize="com", controller=None, common_friction=True, **given)
    assert found.certificate is not None and found.is_certified
    largest = float(found.map["tolerance"].where(found.map["allowed"]).max())
    assert 0.99 * largest < found.tolerance <= largest


@pytest.mark.soak
def test_twenty_random_objects_drop_no_more_with_any_controller() -> None:
    """One-sided, over all objects, controllers and noises, at 1 % by Holm's procedure."""
    p_values, gains = [], []
    for seed in range(20):
        for controller in shipped_names():
            try:
                found = pb.design(
                    random_scene(seed, 0.2), controller=controller, resolution_deg=1.0
                )
            except pb.PalmbotsError as error:
                assert "refuses" in str(error) or "qualifies" in str(error)
                continue
            own = found.own.noise_limit
            if own is None or found.sigma_star_m_s is None:
                continue
            gains.append(found.sigma_star_m_s / own.sigma_star_m_s)
            for noise in (found.scene.robot.noise_m_s, own.sigma_star_m_s):
                p_values.append(more_drops(found, noise, controller, 4000))
            print(seed, controller, found.shallow_deg, found.steep_deg, gains[-1], p_values[-2:],
                  found.own.tolerance, flush=True)  # fmt: skip
    print(f"{len(gains)} designs, median gain in sigma* {np.median(gains):.3f}")
    assert len(gains) > 40
    assert paired_drops.rejected(p_values, 0.01) == 0

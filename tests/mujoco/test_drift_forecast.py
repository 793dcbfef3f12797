# SPDX-License-Identifier: Apache-2.0
"""The sideways budget: predicted before, measured after; warned of, refused, and lips that jam."""

import csv
import json
import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from cxx import ROOT
from palmbots.cli import main as cli
from palmbots.mujoco.drift_forecast import Forecast, forecast_drift, lip_clearance
from palmbots.scene.scene import Scene, load_scene
from sampled import in_soak

ARC = {"task.path.kind": "arc", "task.path.radius_m": 1.0, "task.distance_m": 1.0}


def scene_with(changes: dict[str, Any] | None = None) -> Scene:
    return load_scene("paper", ARC | (changes or {}))


@pytest.mark.parametrize(("radius", "seeds"), [(1.0, 1), in_soak(1.0, 3), in_soak(2.0, 3)])
def test_observed_drift_is_within_a_factor_of_two_of_the_forecast(
    radius: float, seeds: int
) -> None:
    """Twelve seeds on more paths are benchmarks/bench_curves.py."""
    scene = scene_with({"task.path.radius_m": radius})
    known = Forecast(scene)
    for seed in range(seeds):
        done = pb.carry(scene, world="mujoco", seed=seed, record=False)
        assert done.outcome == "delivered" and done.lateral_peak_m is not None
        seen = max(map(abs, done.lateral_peak_m.values()))
        predicted = float(np.abs(known.seed(seed)).max())
        assert predicted / 2 < seen < predicted * 2
        assert min(done.lateral_peak_m.values()) == pytest.approx(-seen)  # outward of a left turn


@pytest.mark.parametrize("radius", [2.0, 1.0, 0.7])
def test_mean_forecast_agrees_with_recorded_mujoco_carries(radius: float) -> None:
    """Over the twelve seeds that benchmarks/bench_curves.py has carried there."""
    with (ROOT / "benchmarks" / "results" / "curves.csv").open() as stream:
        rows = [r for r in csv.DictReader(stream) if r["case"] == f"25 s on R = {radius:g} m"]
    assert [row["outcome"] for row in rows] == ["delivered"] * 12
    seen = 1e-3 * float(np.mean([float(row["seen_mm"]) for row in rows]))
    predicted = forecast_drift(
        scene_with({"task.path.radius_m": radius, "task.distance_m": 1.75}), seeds=12
    )
    assert predicted.mean_m == pytest.approx(seen, rel=0.1)


def test_drift_on_an_s_goes_out_and_back() -> None:
    s = {"task.path.kind": "s", "task.path.angle_deg": 45.0, "task.distance_m": 2.2}
    drift = Forecast(scene_with(s)).seed(0).mean(axis=1)
    least = int(drift.argmin())
    assert drift[least] < -5e-3
    assert drift[-1] > drift[least] + 5e-3
    right = Forecast(scene_with(s | {"task.path.turn": "right"})).seed(0).mean(axis=1)
    assert right == pytest.approx(-drift)


def test_the_mirror_image_drifts_alike() -> None:
    scene = scene_with({"object.com_m": [0.13, 0.04], "palm.left.friction": 0.4})
    one, two = Forecast(scene).seed(3), Forecast(scene.mirrored()).seed(3)
    assert two[:, ::-1] == pytest.approx(one, abs=2e-4)


def test_tighter_and_longer_paths_use_up_more() -> None:
    budgets = [
        forecast_drift(scene_with({"task.path.radius_m": r, "task.distance_m": d}), seeds=4)
        for r, d in ((4.0, 1.0), (1.0, 1.0), (1.0, 2.0))
    ]
    assert budgets[0].mean_m < 0.5 * budgets[1].mean_m < 0.4 * budgets[2].mean_m
    assert [b.verdict for b in budgets][:2] == ["kept", "kept"]
    assert budgets[1].askew_deg == pytest.approx(math.degrees(math.asin(0.125)), rel=0.03)
    assert budgets[0].budget_m == 0.035


def test_axles_far_behind_the_palms_stand_more_askew() -> None:
    """What counts is how far apart the wheels stand, not the palms."""
    near, far = (
        Forecast(scene_with({"mujoco.axle_m": axle, "task.path.radius_m": 2.0})).askew
        for axle in (0.0, 0.2)
    )
    assert far / near == pytest.approx(0.65 / 0.25, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(("width", "verdict"), [(0.07, "kept"), (0.020, "near"), (0.008, "beyond")])
def test_narrow_palms_are_warned_of_and_refused(
    width: float, verdict: str, capsys: pytest.CaptureFixture[str]
) -> None:
    changes = {"palm.width_m": width, "robot.noise_m_s": 0.01}
    budget = forecast_drift(scene_with(changes))
    assert budget.verdict == verdict
    assert budget.summary()["verdict"] == verdict and "at most" in budget.text()
    if verdict != "beyond":
        return
    sets = [f"--set={k}={v}" for k, v in (ARC | changes).items()]
    assert cli.run(["carry", "--world", "mujoco", *sets]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1
    assert (
        "task.path: the object would drift" in printed.err
        and "--allow-drift-beyond-budget" in printed.err
    )
    assert cli.run(["carry", "--world", "mujoco", "--allow-drift-beyond-budget", *sets]) == 1
    printed = capsys.readouterr()
    assert printed.out.startswith("lateral drift, forecast over 16 seeds")
    assert "warning: with the worst seed" in printed.err
    assert "drifts sideways by 11 of the permitted 4 mm" in " ".join(printed.err.split())
    assert "DROPPED" in printed.out


def test_lips_that_jam_are_refused_and_others_keep_the_budget() -> None:
    """Half of a palm's length, 75 mm × tan β, is the room that both lips together must leave."""
    lips = {"palm.lip_height_m": 0.03, "palm.lip_clearance_m": 0.003}
    least = lip_clearance(scene_with())
    assert 2 * least == pytest.approx(0.075 * math.tan(math.asin(0.125)), rel=0.03)
    with pytest.raises(pb.SceneError, match=r"lip_clearance_m: 0.003 \(left\) is too tight") as no:
        Forecast(scene_with(lips))
    allowed = float(str(no.value).split("at least ")[1].split()[0])
    assert least <= allowed <= least + 1e-4
    kept = forecast_drift(scene_with(lips | {"palm.lip_clearance_m": 0.01}), seeds=2)
    assert (kept.verdict, kept.lips, kept.budget_m) == ("kept", True, 0.01)


def test_command_reports_forecast_and_result(capsys: pytest.CaptureFixture[str]) -> None:
    sets = [f"--set={k}={v}" for k, v in (ARC | {"task.distance_m": 0.1}).items()]
    assert cli.run(["carry", "--world", "mujoco", "--json", *sets]) == 0
    result = json.loads(capsys.readouterr().out)
    assert set(result["lateral_peak_m"]) == {"left", "right"}
    assert result["drift_forecast"]["verdict"] == "kept" and result["drift_forecast"]["seeds"] == 16
    assert cli.run(["carry", "--json", "--set=task.distance_m=0.1"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["lateral_peak_m"] is None and result["drift_forecast"] is None

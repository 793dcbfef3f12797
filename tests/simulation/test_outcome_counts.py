# SPDX-License-Identifier: Apache-2.0
"""How often a scene fails: counts of single carries, and only better controllers are named."""

import json
from pathlib import Path

import pytest

import palmbots as pb
from commands import Run
from palmbots._util.confidence_intervals import rate_interval, rate_text
from palmbots.control.registry import shipped_names
from palmbots.simulation import carry_worker, count_outcomes, outcome_counts
from palmbots.simulation.outcome_counts import default_carries, scene_statistics
from palmbots.simulation.prepare import prepare

CRATE = {
    "object.vertices_m": [[0, 0], [0.4, 0], [0.4, 0.12], [0, 0.12]],
    "object.contacts": [0, 1],
    "object.com_m": [0.22, 0.10],
    "object.depth_m": 0.2,
    "object.mass_kg": 1.2,
    "palm.friction": 0.35,
    "palm.length_m": 0.08,
    "robot.noise_m_s": 0.018,
    "radio.loss": 0.05,
}
SWING = """
from palmbots.control import StepOutput

class Swing:
    def step(self, seen):
        move = {1: "away", 0: "hold", -1: "closer"}[seen.sign]
        return StepOutput(palm="shallow" if seen.sign < 0 else "steep", move=move)
"""


def test_none_of_n_is_the_exact_bound() -> None:
    for n in (1, 20, 1000):
        high = rate_interval(0, n)[1]
        assert (1 - high) ** n == pytest.approx(0.05)
        assert rate_interval(n, n) == pytest.approx((1 - high, 1.0))
    assert rate_text(0, 1000) == "< 0.3 %"
    assert rate_text(288, 1000) == "28.8 % (26.1–31.7)"


def test_crate_that_is_delivered_once_drops_often_and_better_controllers_are_simulated() -> None:
    """DELIVERED with seed 0, dropped with most others."""
    carry = pb.carry("paper", overrides=CRATE)
    assert carry.outcome == "delivered"
    found = carry.statistics
    assert found is not None
    assert found.own.carries == default_carries(prepare(carry.scene)) == 1000
    assert found.own.drop_rate > 0.75
    assert found.better
    assert found.better[0].controller == "shared-sign"
    for one in found.better:
        assert one == count_outcomes(carry.scene, one.controller)
        assert one.failure_interval[1] < found.own.failure_interval[0]
    assert carry.statistics is found


@pytest.mark.parametrize("controller", ["distributed", "silent"])
def test_counts_are_those_of_single_carries(controller: str) -> None:
    overrides = {"task.distance_m": 0.3, "robot.noise_m_s": 0.05, "task.timeout_s": 6}
    found = count_outcomes("paper", controller, seeds=12, overrides=overrides)
    ends = [
        pb.carry("paper", controller, seed=k, record=False, overrides=overrides).outcome
        for k in range(12)
    ]
    assert (found.dropped, found.stalled) == (ends.count("dropped"), ends.count("stalled"))


def test_without_the_lockstep_modules_fewer_carries_give_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = pb.load_scene("paper", {"task.distance_m": 0.2, "robot.noise_m_s": 0.05})
    in_lanes = count_outcomes(scene, seeds=200)
    monkeypatch.setattr(outcome_counts, "is_built", lambda: False)
    assert default_carries(prepare(scene)) == 200
    assert count_outcomes(scene) == in_lanes


def test_carries_that_may_last_long_are_fewer() -> None:
    scene = pb.load_scene("paper", {"task.timeout_s": 500})
    assert default_carries(prepare(scene)) == pytest.approx(1000 * 50 / 500, abs=1)
    assert default_carries(prepare(pb.load_scene("paper", {"task.timeout_s": 1e5}))) == 20
    # Where every step is the general one, carries side by side are no faster than one by one.
    assert default_carries(prepare(pb.load_scene("paper", {"object": "carton"}))) == 200


def test_every_shipped_controller_is_compared() -> None:
    scene = pb.load_scene("paper", {"robot.noise_m_s": 0.05, "task.distance_m": 0.5})
    found = scene_statistics(prepare(scene, "none"), seeds=50)
    assert found is not None
    assert found.better is not None
    assert {one.controller for one in found.better} == set(shipped_names()) - {"none"}


def test_report_of_the_command_and_what_takes_long(here: Run, tmp_path: Path) -> None:
    noisy = ("--set", "robot.noise_m_s=0.03")
    text = here("carry", *noisy, "--seeds", "200").stdout
    assert "these controllers fail less in this scene, on the same seeds:" in text
    assert "--controller shared-sign" in text
    assert "default scene" not in text
    table = json.loads(here("carry", *noisy, "--seeds", "200", "--json").stdout)
    own = table["scene_statistics"]["own"]
    assert own["carries"] == 200
    assert f"drops {rate_text(own['dropped'], 200)}" in text

    (tmp_path / "swing.py").write_text(SWING)
    short = ("-c", str(tmp_path / "swing.py") + ":Swing", "--set", "task.distance_m=0.1")
    text = here("carry", *short).stdout
    assert "palmbots carry paper --set task.distance_m=0.1" in text and "--seeds 100" in text
    own = json.loads(here("carry", *short, "--seeds", "3", "--json").stdout)["scene_statistics"]
    assert own["own"]["carries"] == 3
    with pytest.raises(pb.PalmbotsError, match="seeds: none given"):
        count_outcomes("paper", str(tmp_path / "swing.py") + ":Swing")


@pytest.mark.parametrize(("worth_s", "processes"), [(0.0, 2), (100.0, 0)])
def test_processes_give_the_carries_of_this_one(
    worth_s: float, processes: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They share what the first carries show to be much."""
    started = []

    class Worker(carry_worker._Worker):
        def __init__(self, job: str) -> None:
            super().__init__(job)
            started.append(self)

    monkeypatch.setattr(carry_worker, "_Worker", Worker)
    monkeypatch.setattr(carry_worker, "_WORTH_S", worth_s)
    monkeypatch.setattr("palmbots.simulation.outcome_counts.available_cores", lambda: 2)
    (tmp_path / "swing.py").write_text(SWING)
    overrides = {"task.distance_m": 0.2, "robot.noise_m_s": 0.06, "task.timeout_s": 5}
    name = str(tmp_path / "swing.py") + ":Swing"
    found = count_outcomes("paper", name, seeds=6, overrides=overrides)
    ends = [pb.carry("paper", name, seed=k, overrides=overrides).outcome for k in range(6)]
    assert (found.dropped, found.stalled) == (ends.count("dropped"), ends.count("stalled"))
    assert len(started) == processes


@pytest.mark.parametrize(
    ("controller", "dropped", "stalled", "tries"),
    [
        ("distributed", 10, 0, True),
        ("distributed", 0, 10, True),
        ("distributed", 5, 5, True),
        ("distributed", 9, 0, False),
        ("distributed", 0, 9, False),
        ("creeping", 900, 0, False),  # its carries take long
    ],
)
def test_other_controllers_are_tried_from_one_failure_in_a_hundred(
    monkeypatch: pytest.MonkeyPatch, controller: str, dropped: int, stalled: int, tries: bool
) -> None:
    own = outcome_counts.OutcomeCounts("distributed", 1000, dropped, stalled)
    better = (outcome_counts.OutcomeCounts("silent", 1000, 0, 0),)
    monkeypatch.setattr(outcome_counts, "_counted", lambda *given: own)
    monkeypatch.setattr(outcome_counts, "better_controllers", lambda *given, **more: better)
    found = scene_statistics(prepare(pb.load_scene("paper"), controller), seeds=1000)
    assert found == outcome_counts.SceneStatistics(own, better if tries else None)


def test_one_carry_is_no_plural(here: Run) -> None:
    text = here("carry", "--seeds", "1", "--set", "task.distance_m=0.1").stdout
    assert "distributed: 1 carry of this scene" in text
    text = here("carry", "--seeds", "2", "--set", "task.distance_m=0.1").stdout
    assert "distributed: 2 carries of this scene" in text

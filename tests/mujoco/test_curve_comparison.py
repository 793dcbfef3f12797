# SPDX-License-Identifier: Apache-2.0
"""What helps along a curve: every change has been carried, and a turn keeps its angle."""

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

import palmbots as pb
from palmbots.mujoco import curve_comparison, curve_trial
from palmbots.mujoco.curve_trial import CurveTrial, tried_turn, turn_keys, whole_turn_keys
from palmbots.mujoco.curved_world import line_of
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.simulation.outcome_counts import OutcomeCounts

FORECAST = DriftBudget(0.035, 0.051, 0.06, 8, 8, 7.2, False)


def test_a_turn_of_fixed_angle_is_driven_to_its_end() -> None:
    """The trailing robot has left the arc where the carry ends, whatever the radius."""
    for radius in (0.6, 1.0, 3.0):
        scene = pb.load_scene("paper", turn_keys(pb.load_scene("paper"), radius))
        line, distance = line_of(scene), scene.task.distance_m
        after = line.at(distance - line.spread / 2 + 1e-9)
        assert after.curvature == 0.0
        assert after.heading == pytest.approx(1.5708, abs=1e-3)
        assert line.at(distance - line.spread / 2 - 0.02).curvature > 0
    endless = pb.load_scene("paper", {"task.path.kind": "arc"})
    assert whole_turn_keys(endless) == {}


@pytest.fixture
def carried(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """The scenes that are tried; lips with longer palms drop 1 of 20, all others 15."""
    tried: list[dict[str, Any]] = []

    def forecast_curve(scene: Any, entry: Any, changes: Any) -> CurveTrial:
        pb.load_scene(scene, dict(changes))
        tried.append(dict(changes))
        name = entry if isinstance(entry, str) else entry.name
        forecast = FORECAST if not tried[1:] else replace(FORECAST, mean_m=0.02)
        return CurveTrial(name, changes, forecast, None, "")

    def carry_curve(
        scene: Any, entry: Any, trial: CurveTrial, report: Callable[[float], None], *, carries: int
    ) -> CurveTrial:
        good = {"palm.length_m", "palm.lip_height_m"} <= set(trial.changes)
        report(1.0)
        counts = OutcomeCounts(trial.controller, 20, 1 if good else 15, 0)
        return replace(trial, counts=counts) if trial.can_be_carried else trial

    monkeypatch.setattr(curve_comparison, "forecast_curve", forecast_curve)
    monkeypatch.setattr(curve_comparison, "carry_curve", carry_curve)
    return tried


def test_every_change_that_is_printed_was_carried(carried: list[dict[str, Any]]) -> None:
    done: list[float] = []
    said: list[str] = []
    found = pb.mujoco.compare_on_curve(
        "paper", turn_radius_m=0.6, on_progress=done.append, on_line=said.append
    )
    first = said[: len(carried)]
    assert first[0] == "as it is: forecast drift 51.0 mm of 35.0 mm"
    assert all("forecast drift" in line for line in first)
    assert len(said) == 2 * len(carried) - 1 and "left" in said[-2] and "left" not in said[-1]
    assert done == sorted(done) and done[-1] == 1.0
    assert [one.changes for one in found.others] != [] and len(carried) == 1 + len(found.others)
    best = found.best
    assert best is not None and best.counts is not None and best.counts.dropped == 1
    text = repr(found)
    assert "BETTER" in text and "palm.length_m=0.225" in text
    (command,) = [line for line in text.splitlines() if "run: " in line]
    for key, value in {**found.own.changes, **best.changes}.items():
        assert f"--set {key}={value:g}" in command if isinstance(value, float) else key in command
    assert "-c distributed" in command
    assert {one.controller for one in found.others} == {"distributed", "shared-sign"}


def test_the_command_gives_each_key_once(carried: list[dict[str, Any]]) -> None:
    scene = pb.load_scene("paper", {"palm.length_m": 0.16, "robot.noise_m_s": 0.01})
    scene.spell("paper --set palm.length_m=0.16 --set robot.noise_m_s=0.01")
    text = repr(pb.mujoco.compare_on_curve(scene, turn_radius_m=0.6))
    (command,) = [line for line in text.splitlines() if "run: " in line]
    keys = re.findall(r"--set '?([a-z_.]+)=", command)
    assert "palm.length_m" in keys and "robot.noise_m_s" in keys
    assert len(keys) == len(set(keys))


def test_larger_radii_keep_the_angle_of_the_turn(carried: list[dict[str, Any]]) -> None:
    turn = turn_keys(pb.load_scene("paper"), 0.6)
    pb.mujoco.compare_on_curve("paper", overrides=dict(turn))
    radii = {one["task.path.radius_m"]: one for one in carried if "task.path.radius_m" in one}
    assert set(radii) == {0.9, 1.2}
    for radius, one in radii.items():
        assert one["task.distance_m"] > turn["task.distance_m"]
        assert (
            one["task.distance_m"] == turn_keys(pb.load_scene("paper"), radius)["task.distance_m"]
        )


def test_lips_that_are_there_get_more_room(carried: list[dict[str, Any]]) -> None:
    tight = {"palm.lip_height_m": 0.03, "palm.lip_clearance_m": 0.003}
    pb.mujoco.compare_on_curve("paper", turn_radius_m=0.6, overrides=tight)
    rooms = [one["palm.lip_clearance_m"] for one in carried if "palm.lip_clearance_m" in one]
    assert rooms[0] == 0.012 and min(rooms) > 0.003
    wide = tight | {"palm.lip_clearance_m": 0.02}
    carried.clear()
    pb.mujoco.compare_on_curve("paper", turn_radius_m=0.6, overrides=wide)
    assert {"palm.lip_clearance_m": 0.03} in carried


def test_refusal_names_the_command_that_tries_what_helps() -> None:
    scene = pb.load_scene("paper")
    scene.spell("crate.toml --set robot.noise_m_s=0.02")
    text = FORECAST.refusal(scene, "shared-sign")
    command = "palmbots curve crate.toml --set robot.noise_m_s=0.02 -c shared-sign"
    assert text.endswith(f"run: {command}") and "lip_height" not in text
    assert "which > 68.8 % of carries reach" in FORECAST.text()


def test_trial_beyond_the_budget_is_not_carried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curve_trial, "forecast_drift", lambda *a, **k: FORECAST)
    trial = curve_trial.try_curve(pb.load_scene("paper"), "silent", {}, print, carries=1)
    assert trial.counts is None and trial.forecast is FORECAST and trial.refusal == ""


@pytest.mark.parametrize(
    ("carries", "dropped", "word"),
    [(5, 0, "LIKELY"), (400, 0, "YES"), (5, 2, "PARTLY"), (5, 5, "NO")],
)
def test_few_carries_do_not_say_yes(carries: int, dropped: int, word: str) -> None:
    """None of five drops also if one in three does; a drop names its reason."""
    reasons = {"tipping": dropped} if dropped else {}
    counts = OutcomeCounts("silent", carries, dropped, 0, reasons=reasons)
    own = CurveTrial("silent", {}, FORECAST, counts, "")
    text = repr(curve_comparison.CurveComparison(own, (), pb.load_scene("paper")))
    assert text.startswith(f"{word}  as it is: ")
    assert ("most often tipping: " in text) == (dropped > 0)


LIPS = {"palm.left.lip_height_m": 0.03, "palm.right.lip_height_m": 0.03, "task.path.radius_m": 2.0}


@pytest.mark.parametrize(
    ("forecast", "dropped", "shown", "says"),
    [
        # The drift with lips is what the object would drift without them.
        (replace(FORECAST, lips=True, tips=0, budget_m=0.007), 0, "lips", None),
        (replace(FORECAST, lips=True, tips=0, budget_m=0.007), 9, "7.0 mm",
         "lips stop the drift, but 9 of 20 carries drop, most often sliding: "),
        (replace(FORECAST, mean_m=0.02, tips=0), 1, "20.0 mm", None),
        (replace(FORECAST, mean_m=0.02, tips=0), 9, "35.0 mm", "but 9 of 20 carries drop"),
        (replace(FORECAST, mean_m=0.03, tips=6), 0, "30.0 mm", ", but 0 of 20 carries drop"),
        (replace(FORECAST, mean_m=0.03, tips=4), 9, "30.0 mm", None),
    ],
)  # fmt: skip
def test_rows_do_not_contradict_the_forecast_in_silence(
    forecast: DriftBudget, dropped: int, shown: str, says: str | None
) -> None:
    counts = OutcomeCounts(
        "silent", 20, dropped, 0, reasons={"sliding": dropped} if dropped else {}
    )
    own = CurveTrial("silent", {}, FORECAST, None, "")
    one = CurveTrial("silent", LIPS, forecast, counts, "")
    scene = pb.load_scene("paper")
    text = repr(curve_comparison.CurveComparison(own, (one,), scene))
    label = "palm.lip_height_m=0.03 task.path.radius_m=2.0"
    (row,) = [line for line in text.splitlines() if line.startswith(f"  {label}  ")]
    assert shown in row and "51.0 mm" not in row
    assert (f"{label}: " in text.split(row)[1]) == (says is not None)
    assert says is None or says in text


def test_wider_palms_are_tried_up_to_the_depth_of_the_object(carried: list[dict[str, Any]]) -> None:
    pb.mujoco.compare_on_curve("paper", turn_radius_m=0.6, overrides={"object.depth_m": 0.262})
    widths = [one["palm.width_m"] for one in carried if "palm.width_m" in one]
    assert widths == [0.15, 0.265]  # 2.5 times the forecast of the worst seed; the depth
    carried.clear()
    pb.mujoco.compare_on_curve("paper", turn_radius_m=0.6, overrides={"object.depth_m": 0.12})
    assert [one["palm.width_m"] for one in carried if "palm.width_m" in one] == [0.12]


def test_sides_that_change_unlike_are_named() -> None:
    keys: dict[str, float | str] = {"palm.left.width_m": 0.1, "palm.right.width_m": 0.12}
    own, one = (CurveTrial("silent", some, FORECAST, None, "") for some in ({}, keys))
    text = repr(curve_comparison.CurveComparison(own, (one,), pb.load_scene("paper")))
    assert "  palm.left.width_m=0.1 palm.right.width_m=0.12  " in text


def test_turns_are_refused_from_the_distance_between_the_palms_on() -> None:
    scene = pb.load_scene("paper")
    with pytest.raises(pb.PalmbotsError, match=r"turn_radius_m: value is 0\.249; .* from 0\.25,"):
        tried_turn(scene, 0.249, 90.0)
    assert tried_turn(scene, 0.25, 90.0) == turn_keys(scene, 0.25, 90.0)

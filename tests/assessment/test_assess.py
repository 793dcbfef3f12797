# SPDX-License-Identifier: Apache-2.0
"""`palmbots assess`: the answers are those of the functions behind the commands that they name."""

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.assessment.angles import try_angles
from palmbots.assessment.assess import QUESTIONS
from palmbots.cli.main import run
from palmbots.simulation import count_outcomes

CRATE: dict[str, Any] = {
    "object": {
        "vertices_m": [[0, 0], [0.4, 0], [0.4, 0.12], [0, 0.12]], "depth_m": 0.2, "mass_kg": 1.2,
        "com_m": [0.22, 0.10],
    },
    "palm": {"friction": 0.35, "length_m": 0.08},
    "robot": {"noise_m_s": 0.018},
    "radio": {"loss": 0.05},
}  # fmt: skip
"""A carry with seed 0 and `distributed` delivers it, and most of the others drop it."""


def test_one_lucky_seed_is_not_the_answer() -> None:
    assert pb.carry(CRATE, "distributed").outcome == "delivered"
    found = pb.assess(CRATE, turn_radius_m=0.0)
    rates = {one.controller: one.drop_rate for one in found.counts}
    assert rates["distributed"] == count_outcomes(CRATE, "distributed").drop_rate > 0.5
    assert found.controller == "shared-sign" and found.verdict == "yes"
    assert "distributed" not in found.answers.controllers.text
    assert found.curve is None and found.answers.curve.verdict == "open"


def test_noise_beyond_every_controller_is_said_first() -> None:
    found = pb.assess(CRATE, turn_radius_m=0.0, overrides={"robot.noise_m_s": 0.15})
    assert found.verdict == "no"
    assert min(one.failure_interval[0] for one in found.counts) > 0.5
    assert found.answers.controllers.verdict == "no"


def test_scene_whose_properties_fail_is_a_no_with_the_reason() -> None:
    found = pb.assess(CRATE, turn_radius_m=0.0, overrides={"object.com_m": [0.05, 0.1]})
    assert found.answers.carried.verdict == "no" and "slide" in found.answers.carried.text


def test_tightest_margin_is_that_of_analyze() -> None:
    found = pb.assess(turn_radius_m=0.0, overrides={"task.distance_m": 0.2})
    assert pb.analyze(found.scene).ranking[0].sentence() in found.answers.carried.text


def test_object_that_tips_the_robots_is_a_no() -> None:
    found = pb.assess(turn_radius_m=0.0, overrides={"object.mass_kg": 500})
    assert found.verdict == found.answers.load.verdict == "no"
    assert "kg" in found.answers.load.text


def test_angles_that_cost_carries_are_found_and_judged_on_other_seeds() -> None:
    scene = pb.load_scene(
        CRATE, {"palm.shallow_deg": 8, "palm.steep_deg": 10, "robot.noise_m_s": 0.03}
    )
    trial = try_angles(scene, "shared-sign")
    assert trial is not None and trial.is_better
    assert trial.best_failures < trial.own_failures
    shallow, steep = trial.best_deg
    better = pb.load_scene(scene, {"palm.shallow_deg": shallow, "palm.steep_deg": steep})
    own = count_outcomes(scene, "shared-sign", seeds=3000).failure_interval
    assert count_outcomes(better, "shared-sign", seeds=3000).failure_interval[1] < own[0]


def test_turn_is_tried_in_mujoco(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("palmbots.assessment.assess.CURVE_CARRIES", 1)
    found = pb.assess(turn_radius_m=1.0, overrides={"task.distance_m": 0.2})
    assert found.curve is not None and found.curve.counts is not None
    assert found.curve.changes["task.distance_m"] == 2.03  # the whole turn
    assert found.answers.curve.verdict == "likely"
    # Every command that the page names has these options.
    for name in QUESTIONS:
        words = shlex.split(getattr(found.answers, name).command)
        assert words[0] == "palmbots" and run([*words[1:], "--help"]) == 0


@pytest.mark.parametrize("as_json", [False, True])
def test_command_names_commands_that_run(
    as_json: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / ("page.pdf" if as_json else "page.html")
    words = ["assess", "paper", "--set", "task.distance_m=0.5", "--turn-radius-m", "0"]
    assert run([*words, "--out", str(page), *(["--json"] if as_json else [])]) == 0
    if as_json:
        assert page.read_bytes().startswith(b"%PDF")
    else:
        text = page.read_text()
        assert text.count("<img") == 2 and not re.search(r"(src|href)=\"(?!data:)", text)
    shown = capsys.readouterr().out
    if as_json:
        table = json.loads(shown)
        commands = [one["command"] for one in table["answers"].values()]
        assert len(commands) == len(set(commands)) == 7
        for one in commands[:1]:
            assert run(shlex.split(one)[1:]) == 0
    else:
        assert shown.startswith("YES")

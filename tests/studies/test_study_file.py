# SPDX-License-Identifier: Apache-2.0
"""Study files: their meaning, and the one-line error message for an invalid one."""

from pathlib import Path
from typing import Any

import pytest

from palmbots.studies.points import Points, design_points
from palmbots.studies.study_file import built_in_studies, load_plan
from sampled import in_soak


def points(**table: Any) -> Points:
    return design_points(load_plan(table))


def test_scene_file_is_relative_to_the_study_file(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "mine.toml").write_text("[task]\ndistance_m = 0.7\n")
    file = tmp_path / "deep" / "study.toml"
    file.write_text('scene = "mine.toml"\n[set]\nradio.loss = 0.1\n')
    base = load_plan(file).base
    assert (base.task.distance_m, base.radio.loss) == (0.7, 0.1)


def test_argument_carries_replaces_the_count_of_the_file() -> None:
    table = {"seeds": {"first": 3, "count": 900}, "stop": {"block": 100, "drop_rate": 0.1}}
    study_ = load_plan(table, 50).study
    assert (study_.seeds.first, study_.seeds.count) == (3, 50)
    assert study_.stop is not None
    assert study_.stop.block == 50


WHOLE: dict[str, Any] = {
    "controllers": ["centralized", "distributed"],
    "vary": {"radio.latency_s": [0.0, 0.1]},
    "seeds": {"first": 3, "count": 9},
    "stop": {"block": 3, "drop_rate": 0.1},
}


@pytest.mark.parametrize(
    "change",
    [
        {"scene": "paper-offset"},
        {"set": {"radio.loss": 0.1}},
        {"controllers": ["distributed", "centralized"]},
        {"precision": "float"},
        {"vary": {"radio.latency_s": [0.1, 0.0]}},
        {"vary": {"radio.jitter_s": [0.0, 0.1]}},
        {"seeds": {"first": 4, "count": 9}},
        {"seeds": {"first": 3, "count": 10}},
        {"stop": {"block": 4, "drop_rate": 0.1}},
        {"stop": {"block": 3, "drop_rate": 0.2}},
        {"stop": {"block": 3, "drop_rate": 0.1, "rms": 0.1}},
    ],
    ids=str,
)
def test_identity_changes_with_everything_that_matters(change: dict[str, Any]) -> None:
    """So that a folder is refused where any of it has changed; a remark is no part of it."""
    assert points(**WHOLE | change).identity != points(**WHOLE).identity
    assert points(**WHOLE, about="a remark").identity == points(**WHOLE).identity


# Nearly 5,000 scenes.
LONG = "what-matters"


@pytest.mark.parametrize(
    "name", [in_soak(name) if name == LONG else name for name in built_in_studies()]
)
def test_built_in_studies_are_valid(name: str) -> None:
    plan = load_plan(name)
    assert plan.name == name
    assert plan.study.about
    assert design_points(plan).values

# SPDX-License-Identifier: Apache-2.0
"""Study files: their meaning, and the one-line error message for an invalid one."""

import sys
from pathlib import Path
from typing import Any

import pytest

from palmbots.cli import main as cli
from palmbots.studies.points import Points, design_points
from palmbots.studies.study_file import built_in_studies, load_plan
from study_fixtures import refused, study


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


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("vary = [", ["bad.toml", "not valid TOML"]),
        ("about = 3", ["bad.toml", "about: 3 is not a string; allowed: a string"]),
        ("[vary]\nradio.loss = [0, 2]", ["bad.toml: point 1", "radio.loss"]),
    ],
)
def test_invalid_file_is_reported_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, words: list[str]
) -> None:
    (tmp_path / "bad.toml").write_text(text)
    refused(study("bad.toml", cwd=tmp_path), *words)
    assert {path.name for path in tmp_path.iterdir()} == {"bad.toml"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], ["nowhere", "built-in studies"]),
        (["."], ["folder"]),
        ([], ["FILE"]),
        (["STUDY", "--chunk-size", "0"], ["--chunk-size: value is 0; allowed: 1 to 10000000"]),
        (["STUDY", "--threads", "0"], ["threads: value is 0; allowed: 1 to 1024"]),
        (["STUDY", "-n", "0"], ["carries: value is 0; allowed: 1 to"]),
        (["STUDY", "--out", "/proc/nothing"], ["/proc/nothing", "cannot be written"]),
    ],
)
def test_invalid_arguments_are_refused(
    arguments: list[str],
    words: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "study.toml").write_text('scene = "paper"\n')
    monkeypatch.chdir(tmp_path)
    assert cli.run(["study", *("study.toml" if a == "STUDY" else a for a in arguments)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    for word in words:
        assert word in said.err


@pytest.mark.parametrize(
    ("missing", "arguments", "extra"),
    [
        ("zarr", [], "study"),
        ("distributed", ["--local-cluster", "1"], "cluster"),
        ("scipy.stats.qmc", [], "study"),
        ("SALib.sample.sobol", [], "study"),
    ],
)
def test_missing_package_is_reported(
    missing: str,
    arguments: list[str],
    extra: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    kind = {"scipy.stats.qmc": "sobol", "SALib.sample.sobol": "sobol-indices"}.get(missing)
    text = f'[design]\nkind = "{kind}"\npoints = 2\n' if kind else ""
    file = tmp_path / "study.toml"
    vary = "[vary]\nrobot.noise_m_s = { from = 0.01, to = 0.02 }\n"
    file.write_text(vary + text if kind else 'scene = "paper"\n')
    monkeypatch.setitem(sys.modules, missing, None)
    out = tmp_path / "out"
    assert cli.run(["study", str(file), "--out", str(out), *arguments]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert f"{extra}: the package {missing.split('.')[0]} is missing; run: " in said
    assert not out.exists()


@pytest.mark.parametrize("name", built_in_studies())
def test_built_in_studies_are_valid(name: str) -> None:
    plan = load_plan(name)
    assert plan.name == name
    assert plan.study.about
    assert design_points(plan).values

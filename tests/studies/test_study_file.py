# SPDX-License-Identifier: Apache-2.0
"""Study files: their meaning, and the one-line error message for an invalid one."""

import sys
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.cli import main as cli
from palmbots.errors import SceneError
from palmbots.studies.points import Points, design_points
from palmbots.studies.study_file import built_in_studies, load_plan
from study_fixtures import refused, study


def points(**table: Any) -> Points:
    return design_points(load_plan(table))


def test_curved_path_is_refused_before_writing(tmp_path: Path) -> None:
    table = {"vary": {"task.path": [{"kind": "straight"}, {"kind": "arc", "radius_m": 3.0}]}}
    with pytest.raises(SceneError, match=r"^study: point 1 \(task.path = .*is a curved path"):
        pb.study(table, tmp_path / "study")
    assert not (tmp_path / "study").exists()


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


SPAN = {"from": 0.0, "to": 1.0}


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"vari": {}}, "vari: .*did you mean vary"),
        ({"controllers": []}, "controllers: .*0 items.*a list of one or more"),
        ({"controllers": ["both"]}, r"controllers\[0\]: .*distributed"),
        (
            {"controllers": ["none", "none"]},
            "controllers: .none. is given twice; allowed: each once",
        ),
        ({"precision": "half"}, "precision: .*float"),
        ({"seeds": {"count": 0}}, "seeds.count: 0 is too small"),
        ({"seeds": {"count": 1.5}}, "seeds.count: 1.5 is a number"),
        ({"seeds": {"cuont": 1}}, "seeds.cuont: .*did you mean seeds.count"),
        ({"vary": 3}, "vary: 3 is not a table"),
        ({"vary": {"radio.latency_s": 3}}, "vary.radio.latency_s: 3 is neither"),
        ({"vary": {"radio.latency_s": []}}, "vary.radio.latency_s: .*0 values"),
        ({"vary": {"radio.latency_s": [0, 0.0]}}, "vary.radio.latency_s: .*twice"),
        ({"vary": {"radio.latency_s": SPAN}}, "vary: .*radio.latency_s.* has no steps"),
        ({"vary": {"radio.latency_s": {"from": 1}}}, "vary.radio.latency_s: .*has no to"),
        ({"vary": {"radio.latency_s": {**SPAN, "step": 3}}}, "step.* unknown key of a range"),
        ({"vary": {"radio.latency_s": {**SPAN, "steps": 1}}}, "latency_s.steps: 1 is too small"),
        ({"vary": {"radio.latency_s": {"from": 1, "to": 0, "steps": 3}}}, "latency_s.to: .*more"),
        ({"vary": {"radio.latency_s": {**SPAN, "steps": 3, "scale": "log"}}}, "no logarithm"),
        ({"vary": {"radio.latency_s": {**SPAN, "steps": 3, "scale": "cube"}}}, "scale: .*log"),
        ({"vary": {"radio.latency_s": {}}}, "vary.radio.latency_s: .*is empty"),
        (
            {"vary": {"radio": {"latency_s": [0]}, "radio.latency_s": [1]}},
            "latency_s.* is given twice",
        ),
        (
            {"vary": {"object.com_m[0]": [0.1], "object.com_m": [[0.1, 0.05]]}},
            r"com_m\[0\]: .*object.com_m.* is given beside object.com_m\[0\]",
        ),
        (
            {"vary": {"radio.latency_s": {"from": 1, "to": 1, "steps": 3}}},
            "latency_s.to: 1 is not more than from",
        ),
        (
            {"set": {"radio": {"latency_s": 0.1}}, "vary": {"radio.latency_s": [0.1, 0.2]}},
            "vary: .*radio.latency_s.* is set, and varies",
        ),
        ({"scene": {"task": {"distanc_m": 3}}}, "^study: scene: task.distanc_m: 3"),
        ({"vary": {"radio.latncy_s": [0]}}, r"study: point 0 .*did you mean radio.latency_s"),
        ({"vary": {"radio.latency_s": [0, -1]}}, r"study: point 1 \(radio.latency_s = -1\):"),
        ({"vary": {"object.com_m[2]": [0]}}, r"object.com_m\[2\]: there is no such entry"),
        ({"vary": {"object.comm[0]": [0]}}, r"object.comm\[0\]: there is no such entry"),
        ({"set": {"radio.latncy_s": 0}}, "study: set: radio.latncy_s"),
        ({"scene": "nowhere"}, "study: scene: nowhere"),
        ({"scene": 3}, "study: scene: value is 3; allowed: a built-in name"),
        ({"design": {"kind": "magic"}}, "design.kind: .*sobol"),
        ({"design": {"points": 3}}, "design.points: 3 is given for a grid"),
        ({"design": {"kind": "random"}, "vary": {"radio.loss": SPAN}}, "how many points"),
        ({"design": {"kind": "random", "points": 4}}, "vary: .* is empty"),
        ({"design": {"kind": "sobol", "points": 12}, "vary": {"radio.loss": SPAN}}, "power of 2"),
        (
            {
                "design": {"kind": "random", "points": 4},
                "vary": {"radio.loss": {**SPAN, "steps": 3}},
            },
            "vary: .*has steps",
        ),
        ({"stop": {"block": 10}}, "stop.block: .*drop_rate or rms"),
        ({"stop": {"drop_rate": 0.1}}, "stop.block: is missing"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_invalid_study_is_refused(table: dict[str, Any], words: str) -> None:
    with pytest.raises(SceneError, match=words) as caught:
        design_points(load_plan(table))
    assert "\n" not in str(caught.value)


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
    ("text", "is_a_scene"),
    [
        ("[object]\nkind = 'box'", True),
        ("about = 'mine'\n[robot]\nnoise_m_s = 0.01\n[palm]\nfriction = 0.4", True),
        ("[task]\ndistance_m = 1\n[vary]\nradio.loss = [0, 0.1]", False),
        ("controllers = ['none']\n[robot]\nnoise_m_s = 0.01", False),
    ],
)
def test_scene_passed_as_a_study_is_recognized(tmp_path: Path, text: str, is_a_scene: bool) -> None:
    """A study with a key of a scene in the wrong place is still a study."""
    file = tmp_path / "crate.toml"
    file.write_text(text)
    hint = 'this looks like a scene; a study names it with scene = "crate.toml"'
    with pytest.raises(SceneError) as caught:
        load_plan(file)
    assert (str(caught.value) == f"{file}: {hint}") == is_a_scene
    if not is_a_scene:
        assert "unknown key" in str(caught.value)


def test_scene_object_and_scene_name_are_recognized() -> None:
    scene = pb.load_scene("paper")
    for source in (scene, scene.model_dump()):
        with pytest.raises(SceneError, match=r"^study: this looks like a scene; a study names it"):
            load_plan(source)  # type: ignore[arg-type]
    with pytest.raises(SceneError, match=r'^paper: this is a scene; .* with scene = "paper"$'):
        load_plan("paper")
    with pytest.raises(SceneError, match="study: value is 3; allowed: the name of a study"):
        load_plan(3)  # type: ignore[arg-type]


@pytest.mark.parametrize("carries", [0, 1.5, True, "many"])
def test_invalid_number_of_carries_is_refused(carries: Any) -> None:
    with pytest.raises(SceneError, match=r"^carries: value is .*; allowed: 1 to 1000000000$"):
        load_plan({}, carries)


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

# SPDX-License-Identifier: Apache-2.0
"""Bad input of any command: exit status 2, nothing on stdout, one line with what is allowed."""

import importlib
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

from commands import FUNCTIONS, Run, assert_refused
from palmbots.cli.main import build_app

BAD: list[tuple[list[str], list[str]]] = [
        (["carry", "nowhere.toml"], ["nowhere.toml", "paper"]),
        (["schema", "scenery"], ["NAME", "scene, log"]),
        (["calibrate", "p.toml", "--side", "middle"], ["--side", "left, right"]),
        (["calibrate", "p.toml", "--side", "left", "--only", "palm,x"], ["--only", "dead-zone"]),
        (["calibrate", "p.toml", "--side", "left", "--length", "0"], ["--length", "allowed"]),
        (["calibrate", "nowhere.toml", "--side", "left"], ["nowhere.toml", "no such file"]),
        (["world", "--imperfect", "trm=1"], ["--imperfect trm", "trim"]),
        (["world", "--imperfect", "trim"], ["--imperfect trim", "KEY=VALUE"]),
        (["world", "--imperfect", "trim=0.1", "--lockstep"], ["--imperfect", "--lockstep"]),
        (["world", "--bench", "--lockstep"], ["--bench", "--lockstep"]),
        (["carry", "--set", "radio.los=0.1"], ["--set radio.los:", "radio.loss"]),
        (["modes", "--set", "radio.los=0.1"], ["--set radio.los:", "radio.loss"]),
        (["compare", "--set", "radio.los=0.1"], ["--set radio.los:", "radio.loss"]),
        (["carry", "--set", "radio.loss=nan"], ["radio.loss", "allowed"]),
        (["carry", "--set", "radio.loss"], ["radio.loss"]),
        (["carry", "--set", "palm.length_m=-1"], ["palm.length_m", "allowed"]),
        (["carry", "--controller", "magic"], ["controller", "distributed"]),
        (["carry", "--world", "moon"], ["world", "quasistatic"]),
        (["carry", "--precision", "half"], ["precision", "float"]),
        (["carry", "--seed", "-1"], ["seed", "allowed"]),
        (["carry", "--seed", "x"], ["--seed"]),
        (["carry", "--fork", "2"], ["--fork", "TIME:SEED"]),
        (["carry", "--fork", "2:1", "--fork", "1:1"], ["--fork", "more than the one before"]),
        (["carry", "--controller", "nowhere.toml@station"], ["nowhere.toml"]),
        (["carry", "--animation", "avi"], ["--animation", "gif"]),
        (["carry", "--animation", "mp4"], ["--animation mp4 needs --out DIR"]),
        (["carry", "--animation", "gif"], ["--animation gif needs --out DIR"]),
        (["carry", "--frobnicate"], ["--frobnicate", "--help"]),
        (["frobnicate"], ["frobnicate", "--help"]),
        (["modes", "--p-left-m", "0.2"], ["--p-left-m: value is", "allowed"]),
        (["modes", "--theta-left-deg", "95"], ["--theta-left-deg: value is", "allowed"]),
        (["modes", "--p-left-m", "nan"], ["--p-left-m: value is", "allowed"]),
        (["compare", "--sweep", "robot.noise_m_s"], ["--values"]),
        (["compare", "--values", "1,b"], ["--values", "1,b"]),
        (["compare", "--carries", "0"], ["carries", "allowed"]),
        (["compare", "--seed", "-1"], ["seed", "allowed"]),
        (["world", "--seed", "-1"], ["seed", "allowed"]),
        (["compare", "--controllers", "none,magic"], ["controller", "magic"]),
        (["compare", "--controllers", "none, none"], ["controllers", "none", "twice"]),
        (["compare", "--values", "0.1,0.10"], ["values", "0.1", "twice"]),
        (["compare", "--sweep", "object.vertices_m", "--values", "1"], ["object.vertices_m"]),
        (["replay", "nothing.mcap"], ["nothing.mcap"]),
        (["replay", "/dev/null"], ["/dev/null"]),
    (["carry", "--seed", "1.5"], ['--seed: value is "1.5"; allowed: a whole number']),
    (["carry", "--seed", ""], ['--seed: value is ""; allowed: a whole number']),
    (["modes", "--p-left-m", "1cm"], ['--p-left-m: value is "1cm"; allowed: a number']),
    (["certify", "--friction", "0.1", "x"], ['--friction: value is "x"; allowed: a number']),
    (["certify", "--friction", "0.1"], ["--friction", "requires 2 arguments"]),
    (["carry", "--view"], ["--view needs --world mujoco"]),
    (["carry", "--video"], ["--video needs --world mujoco"]),
    (["carry", "--world", "mujoco", "--video"], ["--video needs --out DIR"]),
    (["analyze", "--p-left-m", "0.1"], ["need --figures DIR"]),
    (["analyze", "--format", "gif"], ["--format", "png, svg, pdf"]),
    (["design", "--region", "0.1;0.2"], ["--region", "implied, palm"]),
    (["design", "--maximize", "speed"], ["maximize", "com"]),
    (["export"], ["export needs --mjcf FILE, --urdf FILE or both"]),
    (["export", "--mjcf", "a", "--urdf", "a"], ["--urdf", "another file"]),
    (["export", "--mjcf", "a", "--urdf", "../EMPTY/a"], ["--urdf: value is", "another file"]),
    (["export", "--mjcf", "a", "--urdf", "none/b"], ["none/b: cannot be written: none does not"]),
    (["export", "--urdf", "a", "--robot", "top"], ["--robot", "left, right"]),
    (["noise-limit", "--relative-error-percent", "50"], ["--relative-error-percent", "0.1 to 10"]),
    (["bound", "--drop-rate-percent", "0"], ["--drop-rate-percent", "0.1 to 50"]),
    (["bound", "--speeds", "any"], ["speeds", "corrections, stopping"]),
    (["bound", "--set", "bumps.rate_per_m=1"], ["bumps", "allowed: no bumps"]),
    (["carry", "-c", "optimal", "--world", "mujoco"], ["optimal", "quasistatic"]),
    (["drop-rate", "-c", "optimal"], ["optimal", "robots can run"]),
    (["noise-limit", "--drop-rate-percent", "0"], ["--drop-rate-percent", "0.1 to 50"]),
    (["drop-rate", "--relative-error-percent", "0"], ["--relative-error-percent", "1 to 100"]),
    (["derive", "--policy", "x"], ["--policy", "table-1"]),
    (["derive", "--controllers", "x"], ["--controllers", "distributed"]),
    (["check", "nothing.json"], ["nothing.json"]),
    (["check", ""], ["CERTIFICATE", 'value is ""; allowed: the name of a file']),
    (["replay", ""], ["LOG", 'value is ""; allowed: the name of a file']),
    (["design", "--slope-deg", "3", "-3"],
     ["palmbots: --slope-deg: value is [3.0, -3.0]; allowed", "from -45 to 45"]),
    (["certify", "--com-y-m", "3", "-3"], ["palmbots: --com-y-m: value is [3.0, -3.0]; allowed"]),
    (["study", "nothing"], ["nothing", "no such study or file"]),
    (["study", "centralized-vs-distributed", "--scheduler", "a", "--local-cluster", "2"],
     ["--scheduler and --local-cluster exclude each other"]),
    (["keys", "nonsense"], ["nonsense", "matches no key"]),
    (["init", "scene"], ["FILE"]),
    (["init", "scene", "none/x.toml"], ["palmbots: none/x.toml: cannot be written: none does not"]),
    (["init", "scene", "/dev/null/x.toml"], ["palmbots: /dev/null/x.toml:", "is not a folder"]),
    (["init", "scene", "/dev/full"], ["FILE: value is /dev/full", "ends in .toml"]),
    (["init", "trio", "x.toml"], ["trio", "--help"]),
    (["init", "pair", "x.txt"], ["x.txt", ".toml"]),
    (["robot", "no.toml", "--side", "left"], ["no.toml", "no such file"]),
    (["robot", "no.toml", "--side", "top"], ["--side", "top", "left"]),
    (["station", "no.toml"], ["no.toml", "no such file"]),
    (["station", "no.toml", "--no-screen", "--watch"], ["--no-screen", "without --attach"]),
    (["replay", "no.mcap", "no2.mcap"], ["no.mcap", "cannot be read"]),
    (["view", "no.mcap"], ["no.mcap", "cannot be read"]),
    (["view", "/dev/null", "--serve", "here"], ["--serve", "here", "HOST:PORT"]),
    (["up", "--lockstep", "--live", "127.0.0.1:0"], ["--live has no effect", "without it"]),
    (["doctor", "no.toml"], ["no.toml", "no such file"]),
    (["doctor", "no.toml", "--seconds", "0"], ["--seconds", "1 to 3600"]),
    (["firmware", "no.toml"], ["no.toml", "no such file"]),
    (["flash", "no.hex"], ["no.hex", "cannot be read"]),
    (["world", "--serve", "here"], ["here", "HOST:PORT"]),
    (["up", "--plain", "--live", "foo"], ["--live", '"foo"', "HOST:PORT"]),
    (["up", "--link", "lost=1"], ["--link", "lost=1", "delay_ms"]),
    (["up", "--rate", "0"], ["--rate", "0.01 to 100"]),
    (["init"], ["init", "--help"]),
    (["ros2", "no.toml", "--side", "left"], ["no.toml", "no such file"]),
    (["ros2", "no.toml", "--side", "top"], ["--side", "top", "left"]),
    (["ros2", "no.toml", "--side", "left", "--seconds", "0"], ["--seconds", "0.1 to 1000000"]),
]  # fmt: skip


BLIND = ["--set", "tactile.zero_half_width_m=0.3"]  # a scene that `carry` warns about
BAD += [
    (["carry", *BLIND, "-c", "resilient"], ["palmbots: radio.lease_s: "]),
    (["carry", *BLIND, "--world", "moon"], ["palmbots: --world: "]),
    (["carry", *BLIND, "--precision", "half"], ["palmbots: --precision: "]),
    (["carry", *BLIND, "--seed", "-1"], ["palmbots: --seed: "]),
    *(
        (arguments, ["palmbots: --seed: "])
        for arguments in (  # nothing is set in /dev/null
            ["carry", "/dev/null", "--seed", "-1"],
            ["compare", "/dev/null", "--seed", "-1"],
            ["design", "/dev/null", "--seed", "-1"],
            ["drop-rate", "/dev/null", "--seed", "-1"],
            ["noise-limit", "/dev/null", "--seed", "-1"],
        )
    ),
    (["modes", "/dev/null", "--p-left-m", "1"], ["palmbots: --p-left-m: "]),
    (["validate", "/dev/null", "-c", "magic"], ["palmbots: --controller: "]),
    (["study", "/dev/null", "--threads", "0"], ["palmbots: --threads: "]),
    (["study", "/dev/null", "--plot"], ["palmbots: --plot needs a study that varies"]),
]


@pytest.mark.parametrize(("arguments", "words"), BAD, ids=lambda x: " ".join(x)[:40])
def test_bad_input_is_one_line_and_exit_status_2(
    arguments: list[str],
    words: list[str],
    here: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    place = tmp_path / "EMPTY"
    place.mkdir()
    monkeypatch.chdir(place)
    assert_refused(here(*arguments), *words)
    assert list(place.iterdir()) == []


def test_every_command_refuses_an_unknown_option(here: Run) -> None:
    group: Any = get_command(build_app())
    for command in group.commands:
        assert_refused(here(command, "--frobnicate"), command, "--frobnicate", "--help")


def _outputs() -> list[tuple[str, str]]:
    """Every option of every command that names a file or a folder to write."""
    group: Any = get_command(build_app())
    return [
        (name, option)
        for name, command in group.commands.items()
        for parameter in command.params
        if parameter.metavar in ("DIR", "FILE") and parameter.param_type_name == "option"
        for option in parameter.opts
    ]


def test_outputs_are_found() -> None:
    known = {("carry", "--out"), ("certify", "-o"), ("analyze", "--figures"), ("export", "--urdf")}
    assert known <= set(_outputs())


@pytest.mark.parametrize(("command", "option"), _outputs())
def test_empty_output_name_is_refused(
    command: str, option: str, here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``--out "$DIR"`` with DIR unset must not mean the working directory."""
    monkeypatch.chdir(tmp_path)
    argument = ["study.toml"] if command == "study" else []
    assert_refused(here(command, *argument, option, ""), option, 'value is ""; allowed: a name')
    assert list(tmp_path.iterdir()) == []


# Command with an output, and the function that does the work.
WORK = {
    **{
        (one.name, "--out"): (one.module, one.function_name)
        for one in FUNCTIONS
        if one.declaration.figure
    },
    ("carry", "--out"): ("palmbots.simulation.single", "carry"),
    ("design", "--out"): ("palmbots.stability.palm_angles", "design"),
    ("analyze", "--figures"): ("palmbots.stability.analysis", "analyze"),
}
PROOF = ("palmbots.stability.certificates.prover", "certify")


def forbid_work(command: tuple[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    def work(*_: object, **__: object) -> None:
        pytest.fail("worked before the output was checked")

    module, function = WORK.get(command, PROOF)
    monkeypatch.setattr(importlib.import_module(module), function, work)


@pytest.mark.parametrize("command", WORK, ids=" ".join)
def test_impossible_folder_is_refused_before_the_work(
    command: tuple[str, str], here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A misspelt --out must not cost hours of carries."""
    forbid_work(command, monkeypatch)
    taken = tmp_path / "file"
    taken.write_text("mine")
    assert_refused(here(*command, str(taken)), "file", "cannot be used as a folder")
    assert taken.read_text() == "mine"


@pytest.mark.parametrize("name", ["none/box.json", "file/box.json", ".", "/dev/full"])
def test_impossible_certificate_file_is_refused_before_the_proof(
    name: str, here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    certify = ("certify", "--out")
    forbid_work(certify, monkeypatch)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("mine")
    assert_refused(here(*certify, name), f"palmbots: {name}: cannot be written: ")


def test_scene_passed_as_study_is_named(here: Run, tmp_path: Path) -> None:
    scene = tmp_path / "crate.toml"
    scene.write_text("[object]\nmass_kg = 1.2\n")
    assert_refused(here("study", str(scene)), "crate.toml", "looks like a scene", "scene = ")


def test_unwritable_folder_is_refused(here: Run, tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    assert_refused(here("carry", "--out", str(blocked)), "file")
    assert blocked.read_text() == "not a folder"

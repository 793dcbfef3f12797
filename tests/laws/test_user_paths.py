# SPDX-License-Identifier: Apache-2.0
"""`~` is the user's home folder wherever a path is named: in options, keys and arguments."""

import dataclasses
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from commands import Run
from palmbots.pair.pair_file import load_pair
from palmbots.scene.path_section import read_points
from palmbots.studies.study_file import load_plan

pytestmark = pytest.mark.slow

SHORT = {"task.distance_m": 0.1}


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The home folder; the working directory is another one, in which nothing may appear."""
    home, elsewhere = tmp_path / "home", tmp_path / "elsewhere"
    home.mkdir()
    elsewhere.mkdir()
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.chdir(elsewhere)
    return home


def test_functions_write_and_read_in_the_home_folder(home: Path) -> None:
    carry = pb.carry("paper", overrides=SHORT)
    pb.write_log(carry, "~/carry.mcap")
    pb.save_carry(carry, "~/all", animation="none")
    assert pb.read_log("~/carry.mcap").trace_hash == carry.trace_hash
    assert pb.replay("~/all/carry.mcap")
    carry.save_figure("~/carry.pdf")
    pb.certify("paper").save("~/box.json")
    assert pb.check("~/box.json")
    pb.export(urdf="~/left.urdf")
    (home / "crate.toml").write_text("[object]\nvertices_m = [[0,0],[0.4,0],[0.4,0.1],[0,0.1]]\n")
    (home / "scene.toml").write_text('object = "~/crate.toml"\n')
    assert pb.load_scene("~/scene.toml").object.vertices_m[1] == (0.4, 0)
    (home / "points.csv").write_text("0,0\n1,0\n2,1\n")
    assert len(read_points("~/points.csv")) == 3
    table: dict[str, Any] = {"controllers": ["none"], "set": SHORT, "seeds": {"count": 2}}
    pb.studies.run_study(load_plan(table), "~/s")
    assert pb.open_study("~/s").sizes["seed"] == 2
    assert [*Path().iterdir()] == []
    assert {"all", "box.json", "carry.pdf", "left.urdf", "s"} <= {p.name for p in home.iterdir()}


def test_commands_write_in_the_home_folder(home: Path, here: Run) -> None:
    for arguments in (("init", "scene", "~/s.toml"), ("init", "pair", "~/pair.toml")):
        assert here(*arguments).returncode == 0
    run = here("analyze", "~/s.toml", "--out=~/figures")
    assert run.returncode == 0, run
    assert [*Path().iterdir()] == []
    assert (home / "figures").is_dir()
    pair = load_pair("~/pair.toml", with_key=False)
    table = pair.settings.pair.model_copy(update={"log_folder": "~/logs"})
    changed = dataclasses.replace(pair, settings=pair.settings.model_copy(update={"pair": table}))
    assert changed.log_folder() == home / "logs"

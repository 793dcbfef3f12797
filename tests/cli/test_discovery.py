# SPDX-License-Identifier: Apache-2.0
"""What a user finds from the shell: scenes, objects, keys, controllers, a scene to start from."""

import json
import os
import subprocess
import sys
import tomllib
from inspect import signature
from pathlib import Path

import pytest

from commands import Run
from palmbots.cli.commands.up_command import up
from palmbots.cli.commands.world_command import world
from palmbots.control.registry import describe, shipped_names
from palmbots.control.tolerated_noise import RECOMMENDED, tolerated_noise
from palmbots.scene.error_messages import dotted_keys
from palmbots.scene.key_reference import scene_keys
from palmbots.scene.overrides import HOLDERS
from palmbots.scene.scene import Scene, load_scene

ROOT = Path(__file__).parent.parent.parent
DATA = ROOT / "src" / "palmbots" / "scene" / "data"


@pytest.mark.parametrize("kind", ["scenes", "objects"])
def test_list_has_every_built_in_file_with_a_meaning(kind: str, here: Run) -> None:
    rows = json.loads(here(kind, "--json").stdout)[kind]
    assert [row["name"] for row in rows] == sorted(f.stem for f in (DATA / kind).glob("*.toml"))
    assert all(len(row["meaning"]) > 10 for row in rows)
    text = here(kind).stdout
    for row in rows:
        assert row["name"] in text
        assert row["meaning"].split()[0] in text


def test_keys_lists_every_key_once(here: Run) -> None:
    rows = json.loads(here("keys", "--json").stdout)["keys"]
    one_side = tuple(f"{s}.{side}." for s in HOLDERS for side in ("left", "right", "station"))
    wanted = {key for key in dotted_keys(Scene) if not key.startswith(one_side)}
    assert len(rows) == len({row["name"] for row in rows})
    assert {row["name"] for row in rows} == wanted
    units = {row["name"]: row["unit"] for row in rows}
    assert (units["robot.speed_m_s"], units["task.timeout_s"]) == ("m/s", "s")
    assert units["radio.loss"] == ""


def test_keys_prints_defaults_that_a_scene_accepts(here: Run) -> None:
    shown = here("keys").stdout.splitlines()
    for key in scene_keys():
        if key.default is None:
            assert any(line.startswith(f"{key.name}  (not set)") for line in shown)
        elif key.name != "object.vertices_m":  # unless given, the keys below follow from it
            assert load_scene("paper", {key.name: key.default}) == Scene()


def test_keys_takes_a_part_or_a_pattern(here: Run) -> None:
    def names(*words: str) -> list[str]:
        return [row["name"] for row in json.loads(here("keys", *words, "--json").stdout)["keys"]]

    assert names("latency") == ["radio.latency_s"]
    assert names("start.*_m") == ["start.left_m", "start.right_m"]
    assert names("NOISE") == [
        "robot.noise_m_s",
        "robot.noise_tau_s",
        "robot.standing_noise_m_s",
        "robot.white_noise_m_per_sqrt_s",
    ]


def test_controllers_lists_those_of_the_help(here: Run) -> None:
    rows = json.loads(here("controllers", "--json").stdout)["controllers"]
    names = [row["name"] for row in rows]
    assert names == [*shipped_names()]
    text = here("controllers").stdout
    for row in rows:
        noise = tolerated_noise(row["name"])
        assert noise is not None
        assert row["sigma_star_m_s"] == noise.sigma_star_m_s
        assert f"palmbots noise-limit -c {row['name']} " in row["sigma_star_command"]
        assert f"{row['name']}  σ* {100 * noise.sigma_star_m_s:.2f} cm/s" in text
        assert row["messages"] == [*describe(row["name"]).messages]
        assert all(need in " ".join(text.split()) for need in row["requirements"])
    needs = {row["name"]: row["requirements"] for row in rows}
    assert needs["none"] == []
    assert all("sensor" in own[0] for name, own in needs.items() if name != "none")
    assert "station" in needs["centralized"][1] and "lockstep" in needs["centralized"][2]
    assert "agree" in needs["silent"][1]


def test_init_scene_writes_the_default_scene(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = here("init", "scene", "my.toml")
    assert (result.returncode, result.stderr) == (0, "")
    assert "wrote my.toml" in result.stdout
    text = Path("my.toml").read_text()
    assert load_scene("my.toml") == Scene()
    given = {f"{s}.{key}" for s, table in tomllib.loads(text).items() for key in table}
    of_the_box = {f"object.{key}" for key in ("vertices_m", "contacts", "com_m", "mass_kg")}
    assert {
        k.name for k in scene_keys() if k.default is not None and k.name.count(".") == 1
    } - of_the_box <= given
    # Who writes only an outline does not keep the centre of mass of another object.
    assert not of_the_box & given
    assert max(map(len, text.splitlines())) <= 80
    for key in scene_keys():
        assert key.meaning.split(" ")[0] in text


def test_keys_that_are_not_set_are_shown_as_comments(here: Run, tmp_path: Path) -> None:
    here("init", "scene", str(tmp_path / "my.toml"))
    lines = (tmp_path / "my.toml").read_text().splitlines()
    for key in scene_keys():
        if key.default is None:
            assert f"# {key.name.rpartition('.')[2]} =" in lines


def test_shell_completion_knows_the_commands() -> None:
    words = {"COMP_WORDS": "palmbots dr", "COMP_CWORD": "1", "_PALMBOTS_COMPLETE": "complete_bash"}
    result = subprocess.run(
        [sys.executable, "-m", "palmbots"],
        env=os.environ | words, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert result.stdout.split() == ["drop-rate"]


def test_help_states_where_the_lists_are(here: Run) -> None:
    assert "--install-completion" in here("--help").stdout
    text = " ".join(here("carry", "--help").stdout.split())
    for command in ("palmbots scenes", "palmbots keys", "palmbots controllers"):
        assert command in text


def test_help_imports_nothing_that_only_the_work_needs() -> None:
    code = (
        "import contextlib, io, sys\n"
        "from palmbots.cli import main\n"
        "from palmbots.cli.declared_commands import declared_commands\n"
        "with contextlib.redirect_stdout(io.StringIO()):\n"
        "    assert {main.run([name, '--help']) for name in declared_commands()} == {0}\n"
        "slow = {'numpy', 'scipy', 'mujoco', 'xarray', 'matplotlib', 'flint', 'textual'}\n"
        "assert not slow & set(sys.modules), slow & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_robots_run_the_recommended_controller_by_default() -> None:
    """Their defaults are literals, because the help reads them as text."""
    for command in (up, world):
        assert signature(command).parameters["controller"].default == RECOMMENDED

# SPDX-License-Identifier: Apache-2.0
"""What the commands write and print: files, exit status, reports, warnings, help."""

import importlib
import json
import re
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

from coarse_pictures import COARSE
from commands import Run, assert_refused, unwrapped
from palmbots._util.atomic_files import write_whole
from palmbots.cli import main as cli
from palmbots.cli.main import build_app
from palmbots.control.registry import shipped_names
from palmbots.simulation import register_world, unregister_world
from shell import palmbots

DONE, FAILED = cli.DONE, cli.FAILED
WITH_CHART = ("distributed", "resilient", "shared-sign")  # their robots send each other messages
SHORT = ("--set", "task.distance_m=0.05")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with all files of one carry."""
    out = tmp_path_factory.mktemp("carry") / "out"
    result = palmbots("carry", "--set", "task.distance_m=0.1", "--out", str(out), "--json")
    assert (result.returncode, result.stderr) == (DONE, "")
    return out


@pytest.mark.slow
@pytest.mark.parametrize("controller", shipped_names())
def test_carry_writes_the_same_files_for_every_controller(
    controller: str, here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also with a bad radio, faults and damaged packets."""
    keys = (
        "radio.loss=0.05", "radio.corruption=0.02", "radio.duplicate=0.05",
        "faults.random_reboots=1", "task.distance_m=0.03",
    )  # fmt: skip
    for name, value in COARSE.items():
        monkeypatch.setattr(name, value)
    out = tmp_path / "out"
    options = (
        "--seeds=1",
        *(f"--set={key}" for key in keys),
        "--animation",
        "gif",
        "--out",
        str(out),
    )
    result = here("carry", "-c", controller, *options)
    assert result.returncode in (DONE, FAILED), result.stderr
    files = {"carry.png", "carry.mcap", "carry.gif"}
    chart = {"message_sequence.png"} if controller in WITH_CHART else set()
    assert {path.name for path in out.iterdir()} - chart == files


@pytest.mark.slow
def test_written_files_have_their_formats(written: Path) -> None:
    heads = {path.name: path.read_bytes()[:8] for path in written.iterdir()}
    assert heads["carry.png"].startswith(b"\x89PNG")
    assert heads["carry.gif"].startswith(b"GIF89a")
    assert heads["carry.mcap"] == b"\x89MCAP0\r\n"
    assert heads["message_sequence.png"].startswith(b"\x89PNG")
    assert len(heads) == 4


def test_dropped_object_is_exit_status_1(here: Run) -> None:
    result = here("carry", "-c", "none", "--set", "robot.left.bias_m_s=0.02", "--json")
    assert result.returncode == FAILED
    table = json.loads(result.stdout)
    assert (table["outcome"], table["reason"]) == ("dropped", "off-palm")


def test_replay_finds_the_log_identical(here: Run, written: Path) -> None:
    result = here("replay", str(written / "carry.mcap"), "--json")
    assert result.returncode == DONE
    assert json.loads(result.stdout)["identical"] is True
    assert "IDENTICAL" in here("replay", str(written / "carry.mcap")).stdout


def test_modes_reports_properties_1_and_2(here: Run) -> None:
    table = json.loads(here("contact-modes", "--json", "--theta-left-deg", "5").stdout)
    assert (table["closing"], table["opening"]) == (["SL", "ST"], ["ST", "SL"])
    assert len(table["feasible"]) == 3
    assert len(table["consistent_closing"]) == len(table["consistent_opening"]) == 5
    text = here("contact-modes", "--theta-left-deg", "5").stdout
    assert "closing: left SL, right ST\nThe left contact slides up, the right one sticks.\n" in text
    assert "opening: left ST, right SL\n" in text


def test_compare_writes_its_figure(here: Run, tmp_path: Path) -> None:
    few = ("--values", "0,0.2", "-n", "2", *SHORT)
    result = here("compare", *few, "--out", str(tmp_path), "--json")
    assert len(json.loads(result.stdout)["rows"]) == 2 * len(shipped_names())
    assert (tmp_path / "compare.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    "words", [("compare", "--values", "0", "-n", "2", "--controllers", "none"), ("carry",)]
)
def test_out_with_the_name_of_a_picture_is_that_picture(
    here: Run, tmp_path: Path, words: tuple[str, ...]
) -> None:
    """Of a folder with such a name the figure is put into the folder."""
    file, folder = tmp_path / "one.pdf", tmp_path / "folder.pdf"
    folder.mkdir()
    assert f"wrote {file}" in " ".join(here(*words, *SHORT, "--out", str(file)).stdout.split())
    assert file.read_bytes().startswith(b"%PDF-")
    if words[0] == "compare":
        here(*words, *SHORT, "--out", str(folder))
        assert [path.name for path in folder.iterdir()] == ["compare.png"]


def test_compare_sweeps_a_key_of_whole_numbers(here: Run) -> None:
    result = here(
        *("compare", "--sweep", "faults.random_reboots", "--values", "0,1", "--json"),
        *("--carries", "2", "--controllers", "distributed"),
    )
    assert [row["value"] for row in json.loads(result.stdout)["rows"]] == [0, 1]


def test_single_carry_has_no_interval_of_means(here: Run, tmp_path: Path) -> None:
    text = here("compare", "--values", "0", "-n", "1", "--controllers", "none,distributed").stdout
    assert "±" not in text and "nan" not in text and "[mm]" in text
    study = tmp_path / "one.toml"
    study.write_text("[vary]\nrobot.noise_m_s = [0.02]\n[seeds]\ncount = 1\n")
    text = here("study", str(study), "--out", str(tmp_path / "one")).stdout
    assert "nan" not in text and "[mm]" in text


@pytest.mark.parametrize(
    ("sweep", "values"),
    [("robot.noise_m_s", ("0.01", "0.02", "0.03")), ("radio.latency_s", ("0.3", "0.4", "0.5"))],
)
def test_refusal_of_several_values_appears_once(
    sweep: str, values: tuple[str, ...], here: Run
) -> None:
    """The reason is the same for each noise; for each latency, only its numbers differ."""
    late = ("--set", "radio.latency_s=0.4") if sweep == "robot.noise_m_s" else ()
    few = ("--controllers", "none,resilient", "-n", "1", *SHORT, *late)
    result = here("compare", "--sweep", sweep, "--values", ",".join(values), *few)
    text = " ".join(result.stdout.split())
    assert text.count("resilient refuses") == text.count("radio.lease_s") == 1
    assert f"resilient refuses {sweep} = {', '.join(values)}: " in text


def test_column_of_swept_values_is_headed_by_the_key(here: Run) -> None:
    text = here("compare", "--values", "0.1", "--controllers", "none", "-n", "1", *SHORT).stdout
    assert re.search(r"\ncontroller +radio.latency_s +dropped +rms \[mm\] +per m +B/s\n", text)


def test_unanswered_requests_are_reported(here: Run) -> None:
    text = here("carry", "--set", "radio.loss=1", "--seeds", "1").stdout
    assert "(2 unanswered)" in text
    assert "warning: the left robot has waited since 0.9 s" in text
    assert "unanswered" not in here("carry", "--seeds", "1").stdout


def test_stalled_carry_states_the_time_limit(here: Run) -> None:
    result = here("carry", "--set", "task.timeout_s=3", "--seeds", "1")
    assert result.returncode == FAILED
    assert "STALLED" in result.stdout
    assert "\n  time limit reached: task.timeout_s is 3 s\n" in result.stdout
    result = here("carry", "-c", "resilient", "--set", "radio.loss=1", "--seeds", "1")
    assert "task.timeout_s is 50 s, the default: twice the" in result.stdout


def test_long_carry_reports_the_number_of_all_corrections(here: Run) -> None:
    """Not the number of those that are listed."""
    long = ("carry", "--set", "task.distance_m=40")
    table = json.loads(here(*long, "--json").stdout)
    assert len(table["corrections"]) == 512 < table["correction_count"]
    assert f"\n{table['correction_count']} corrections; the first 512:   p: " in here(*long).stdout


def test_one_is_singular(here: Run) -> None:
    changes = ("robot.noise_m_s=0", "start.left_m=0.006", "radio.loss=1")
    script = "bumps.script=[{robot='left', at_s=0, shift_m=0.001}]"
    text = here("carry", *(f"--set={change}" for change in (*changes, script))).stdout
    assert "\n1 correction   p: " in text
    assert "\n1 message, 1 lost   1 bump   trace" in text


def test_files_of_another_carry_at_the_same_time_stay(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other one writes while this one draws: one file anew, and one over an older one."""

    def save(result: Any, path: Path, **_: Any) -> None:
        path.write_text("new")
        (tmp_path / "plan.png").write_text("of the other carry")
        write_whole(tmp_path / "carry.mp4", "of the other carry")

    monkeypatch.setattr("palmbots.viz.carry_figure.save", save)
    for name in ("carry.mp4", "carry.gif"):
        (tmp_path / name).write_text("of an earlier carry")
    options = ("carry", *SHORT, "--out", str(tmp_path), "--controller", "none", "--seeds", "1")
    text = here(*options, "--animation", "none").stdout
    assert f"removed {tmp_path / 'carry.gif'}" in text and text.count("removed") == 1
    for name in ("plan.png", "carry.mp4"):
        assert (tmp_path / name).read_text() == "of the other carry"


def test_files_of_an_earlier_carry_are_removed(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writers = {"animation": "save_animation", "carry_figure": "save"}
    for name, writer in writers.items():  # what they draw does not matter here
        module = importlib.import_module(f"palmbots.viz.{name}")
        monkeypatch.setattr(module, writer, lambda result, path, **_: path.write_text("new"))
    earlier = ("carry.mp4", "message_sequence.png", "plan.png", "carry-3d.png", "carry-3d.gif")
    for name in earlier:
        (tmp_path / name).write_text("of an earlier carry")
    (tmp_path / "other.gif").write_text("not ours")
    options = ("carry", *SHORT, "--out", str(tmp_path), "--controller", "none", "--seeds", "1")
    text = here(*options).stdout
    for name in earlier:
        assert f"removed {tmp_path / name} of an earlier carry" in text
    names = {p.name for p in tmp_path.iterdir()}
    assert names == {"carry.png", "carry.mcap", "carry.gif", "other.gif"}
    text = here(*options, "--animation", "none").stdout
    assert f"removed {tmp_path / 'carry.gif'}" in text
    assert {p.name for p in tmp_path.iterdir()} == names - {"carry.gif"}
    (tmp_path / "carry.gif").mkdir()
    assert_refused(here(*options, "--animation", "none"), "carry.gif: cannot be removed")


def test_carry_that_fails_to_write_keeps_the_earlier_animation(here: Run, tmp_path: Path) -> None:
    (tmp_path / "carry.mp4").write_text("an animation")
    (tmp_path / "carry.gif").mkdir()  # where the new one cannot be written
    assert_refused(here("carry", *SHORT, "--out", str(tmp_path)), "carry.gif")
    assert (tmp_path / "carry.mp4").read_text() == "an animation"


def test_no_animation_needs_no_folder(here: Run) -> None:
    assert here("carry", "--animation", "none").returncode == DONE


def test_dead_band_warning_comes_before_the_carry_and_in_json(here: Run) -> None:
    keys = {
        "tactile.zero_half_width_m": 0.0001,
        "robot.noise_m_s": 0,
        "robot.acceleration_m_s2": 20,
        "start.right_m": 0.02,
    }
    result = here("carry", *(f"--set={key}={value}" for key, value in keys.items()), "--json")
    assert result.stderr.startswith("palmbots: warning: ")
    assert "zero zone" in result.stderr
    warnings = json.loads(result.stdout)["warnings"]
    assert any("zero zone" in text for text in warnings)
    assert any("limit cycle" in text for text in warnings)


def test_limits_that_the_scene_exceeds_are_in_json_too(here: Run) -> None:
    result = here("carry", *SHORT, "--set=robot.acceleration_m_s2=5", "--json")
    warnings = json.loads(result.stdout)["warnings"]
    assert any(text.startswith("robot.acceleration_m_s2 is 5, but") for text in warnings)
    for text in warnings:
        assert f"palmbots: warning: {text}\n" in unwrapped(result.stderr)
    assert max(map(len, result.stderr.splitlines())) <= 80


def test_help_lists_the_registered_worlds(here: Run) -> None:
    register_world("moon", "nowhere:WORLD")
    try:
        assert "quasistatic or mujoco or moon" in " ".join(here("carry", "--help").stdout.split())
    finally:
        unregister_world("moon")


def test_every_help_has_an_example_and_imperative_options(here: Run) -> None:
    group: Any = get_command(build_app())
    for name in group.commands:
        result = here(name, "--help")
        assert result.returncode == DONE
        assert f"Example: palmbots {name}" in " ".join(result.stdout.split())
        assert max(map(len, result.stdout.splitlines())) <= 80


def test_help_lists_the_main_command_first(here: Run) -> None:
    text = here("--help").stdout.split("Commands:")[1]
    listed = re.findall(r"^  ([a-z0-9-]+)  ", text, re.MULTILINE)
    assert listed[:3] == ["carry", "assess", "contact-modes"]
    group: Any = get_command(build_app())
    assert sorted(listed) == sorted(group.commands)
    assert "..." not in text  # no sentence is truncated
    assert "Commands:" in here().stdout
    assert here("--version").stdout.startswith("palmbots 0.")

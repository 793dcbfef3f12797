"""The command line as a user meets it: its exit status, stdout and stderr.

Of real processes where they matter; what is asked of many texts is run here, without their starts.
"""

import importlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

from palmbots import cli
from palmbots.cli_options import app
from shell import palmbots

DONE, FAILED, BAD_INPUT = 0, 1, 2
Here = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def here(capsys: pytest.CaptureFixture[str]) -> Here:
    """`palmbots`, run in this process."""

    def ran(*arguments: str) -> subprocess.CompletedProcess[str]:
        capsys.readouterr()
        status = cli.run(list(arguments))
        said = capsys.readouterr()
        return subprocess.CompletedProcess(arguments, status, said.out, said.err)

    return ran


def refused(result: subprocess.CompletedProcess[str], *words: str) -> None:
    """Exit status 2, nothing on stdout, one line on stderr that has these words."""
    assert result.returncode == BAD_INPUT, result
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1, result.stderr
    for word in words:
        assert word in result.stderr


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with everything that one carry writes."""
    out = tmp_path_factory.mktemp("carry") / "out"
    result = palmbots("carry", "figure8", "--out", str(out), "--json")
    assert result.returncode == DONE, result.stderr
    return out


@pytest.mark.parametrize("controller", ["none", "centralized", "distributed", "resilient"])
def test_carry_out_writes_the_same_files_for_every_controller(
    controller: str, here: Here, tmp_path: Path
) -> None:
    """Through a bad radio, faults and damaged packets too."""
    bad = ["radio.loss=0.05", "radio.corruption=0.02", "radio.duplicate=0.05", "faults.reboots=1"]
    keys = [word for key in [*bad, "task.distance_m=0.3"] for word in ("--set", key)]
    out = tmp_path / "out"
    result = here("carry", "-c", controller, *keys, "--animation", "gif", "--out", str(out))
    assert result.returncode in (DONE, FAILED), result.stderr
    files = {"carry.png", "carry.mcap", "carry.gif"}
    letters = {"message_sequence.png"} if controller in ("distributed", "resilient") else set()
    assert {path.name for path in out.iterdir()} == files | letters


def test_carry_json_has_the_contract() -> None:
    result = palmbots("carry", "--json", "--seed", "3")
    assert result.returncode == DONE
    assert result.stderr == ""
    said = json.loads(result.stdout)
    assert {
        "outcome", "reason", "time_s", "distance_m", "contact_rms_m", "contact_peak_m",
        "corrections", "messages", "waiting_s", "warnings", "trace_hash", "scene",
    } <= set(said)  # fmt: skip
    assert set(said["contact_rms_m"]) == {"left", "right"}
    assert set(said["corrections"][0]) == {
        "label", "robot", "case", "assistant", "start_s", "end_s",
    }  # fmt: skip


def test_a_dropped_object_is_exit_status_1() -> None:
    result = palmbots("carry", "-c", "none", "--set", "robot.left.bias_m_s=0.02", "--json")
    assert result.returncode == FAILED
    said = json.loads(result.stdout)
    assert (said["outcome"], said["reason"]) == ("dropped", "off-palm")


def test_carry_writes_picture_animation_and_log(written: Path) -> None:
    heads = {path.name: path.read_bytes()[:8] for path in written.iterdir()}
    assert heads["carry.png"].startswith(b"\x89PNG")
    assert heads["carry.gif"].startswith(b"GIF89a")
    assert heads["carry.mcap"] == b"\x89MCAP0\r\n"
    assert heads["message_sequence.png"].startswith(b"\x89PNG")
    assert len(heads) == 4


def test_replay_proves_the_log_identical(here: Here, written: Path) -> None:
    result = palmbots("replay", str(written / "carry.mcap"), "--json")
    assert result.returncode == DONE
    assert json.loads(result.stdout)["identical"] is True
    assert "IDENTICAL" in here("replay", str(written / "carry.mcap")).stdout


def test_replay_refuses_a_truncated_log(here: Here, written: Path, tmp_path: Path) -> None:
    whole = (written / "carry.mcap").read_bytes()
    for size in (0, 5, 100, len(whole) // 2, len(whole) - 1):
        (tmp_path / "cut.mcap").write_bytes(whole[:size])
        refused(here("replay", str(tmp_path / "cut.mcap")), "cut.mcap")


def test_modes_json_has_the_contract() -> None:
    said = json.loads(palmbots("modes", "--json", "--theta-left-deg", "5").stdout)
    assert said["closing"] == ["SL", "ST"]  # property 1
    assert said["opening"] == ["ST", "SL"]  # property 2
    assert len(said["feasible"]) == 3
    assert len(said["consistent_closing"]) == len(said["consistent_opening"]) == 5
    assert set(said) >= {"wedged", "squeeze", "margin_rad", "scene"}


def test_compare_json_has_the_contract(tmp_path: Path) -> None:
    result = palmbots("compare", "--values", "0,0.2", "-n", "5", "--out", str(tmp_path), "--json")
    assert result.returncode == DONE
    rows = json.loads(result.stdout)["rows"]
    assert len(rows) == 8
    assert {"controller", "key", "value", "n", "drop_rate", "interval", "rms_m"} <= set(rows[0])
    assert (tmp_path / "compare.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["carry", "nowhere.toml"], ["nowhere.toml", "paper"]),
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
        (["carry", "--animation", "avi"], ["--animation", "gif"]),
        (["carry", "--animation", "mp4"], ["--animation: mp4 needs --out"]),
        (["carry", "--animation", "gif"], ["--animation: gif needs --out"]),
        (["carry", "--frobnicate"], ["--frobnicate", "--help"]),
        (["frobnicate"], ["frobnicate", "--help"]),
        (["modes", "--p-left-m", "0.2"], ["p_left_m", "allowed"]),
        (["modes", "--theta-left-deg", "95"], ["theta_left_deg", "allowed"]),
        (["modes", "--p-left-m", "nan"], ["p_left_m", "allowed"]),
        (["compare", "--sweep", "robot.noise_m_s"], ["--values"]),
        (["compare", "--values", "1,b"], ["--values", "1,b"]),
        (["compare", "--carries", "0"], ["carries", "allowed"]),
        (["compare", "--seed", "-1"], ["seed", "allowed"]),
        (["compare", "--controllers", "none,magic"], ["controller", "magic"]),
        (["compare", "--controllers", "none, none"], ["controllers", "none", "twice"]),
        (["compare", "--values", "0.1,0.10"], ["values", "0.1", "twice"]),
        (["compare", "--sweep", "object.vertices_m", "--values", "1"], ["object.vertices_m"]),
        (["replay", "nothing.mcap"], ["nothing.mcap"]),
        (["replay", "/dev/null"], ["/dev/null"]),
    ],
)
def test_bad_input_is_one_line_and_exit_status_2(
    arguments: list[str], words: list[str], here: Here
) -> None:
    refused(here(*arguments), *words)


def test_compare_sweeps_a_key_of_whole_numbers(here: Here) -> None:
    result = here(
        *("compare", "--sweep", "faults.reboots", "--values", "0,1", "--json"),
        *("--carries", "2", "--controllers", "distributed"),
    )
    assert [row["value"] for row in json.loads(result.stdout)["rows"]] == [0, 1]
    refused(
        here("compare", "--sweep", "faults.reboots", "--values", "0.5"), "0.5", "a whole number"
    )


def test_of_one_carry_no_interval_is_told(here: Here, tmp_path: Path) -> None:
    few = ("--values", "0", "--carries", "1", "--out", str(tmp_path))
    said = here("compare", *few, "--controllers", "none,distributed").stdout
    assert "±" not in said and "nan" not in said and " mm" in said
    study = tmp_path / "one.toml"
    study.write_text("[vary]\nrobot.noise_m_s = [0.02]\n[seeds]\ncount = 1\n")
    said = here("study", str(study), "--out", str(tmp_path / "one")).stdout
    assert "nan" not in said and " mm" in said


def test_a_comparison_of_which_all_is_refused_is_bad_input(here: Here, tmp_path: Path) -> None:
    out = tmp_path / "out"
    late = ("--values", "0.4,0.5", "--controllers", "resilient", "--out", str(out))
    refused(here("compare", *late), "resilient refused radio.latency_s = 0.4", "lease_s")
    assert not out.exists()


def test_a_carry_by_robots_that_hang_says_so(here: Here) -> None:
    result = here("carry", "--set", "radio.loss=1")
    assert "(2 unanswered)" in result.stdout
    assert "warning: left has waited since 0.9 s for an Ack that does not come" in result.stdout
    assert "unanswered" not in here("carry").stdout


def test_a_stalled_carry_says_that_time_is_up(here: Here) -> None:
    result = here("carry", "--set", "task.timeout_s=3")
    assert result.returncode == FAILED
    assert "STALLED" in result.stdout
    assert "\n  time is up: task.timeout_s is 3 s\n" in result.stdout
    result = here("carry", "-c", "resilient", "--set", "radio.loss=1")
    assert "task.timeout_s is 50 s, the default: twice the time" in result.stdout


def test_a_long_carry_tells_how_many_corrections_there_were(here: Here) -> None:
    """Not how many of them are listed."""
    long = ("carry", "--set", "task.distance_m=40")
    told = json.loads(here(*long, "--json").stdout)
    assert len(told["corrections"]) == 512 < told["correction_count"]
    said = here(*long).stdout
    assert f"\n{told['correction_count']} corrections, of the first 512:\n" in said


def test_one_is_no_plural(here: Here) -> None:
    changes = ("robot.noise_m_s=0", "start.left_m=0.006", "radio.loss=1")
    script = "bumps.script=[{robot='left', at_s=0, shift_m=0.001}]"
    once = here("carry", *(f"--set={change}" for change in (*changes, script))).stdout
    for said in ("\n1 correction\n", "\n1 message, 1 lost   1 bump   trace"):
        assert said in once


def test_modes_report_names_the_sides(here: Here) -> None:
    said = here("modes", "--theta-left-deg", "5").stdout
    assert "closing: left SL, right ST\nopening: left ST, right SL\n" in said


def test_an_animation_of_an_earlier_carry_is_removed(here: Here, tmp_path: Path) -> None:
    short = ("carry", "--set", "task.distance_m=0.05", "--out", str(tmp_path))
    (tmp_path / "carry.mp4").write_text("a film")
    (tmp_path / "message_sequence.png").write_text("letters, where none are sent now")
    said = here(*short, "--controller", "none").stdout
    assert f"removed {tmp_path / 'message_sequence.png'}" in said
    assert {p.name for p in tmp_path.iterdir()} == {"carry.png", "carry.mcap", "carry.gif"}
    assert f"removed {tmp_path / 'carry.mp4'}" in said
    (tmp_path / "other.gif").write_text("not ours")
    said = here(*short, "--controller", "none", "--animation", "none").stdout
    assert {p.name for p in tmp_path.iterdir()} == {"carry.png", "carry.mcap", "other.gif"}
    assert f"removed {tmp_path / 'carry.gif'}" in said
    (tmp_path / "carry.gif").mkdir()
    refused(here(*short, "--animation", "none"), "carry.gif: cannot be removed")


def test_a_carry_that_fails_to_write_leaves_the_earlier_animation(
    here: Here, tmp_path: Path
) -> None:
    (tmp_path / "carry.mp4").write_text("a film")
    (tmp_path / "carry.gif").mkdir()  # where the new one cannot be written
    out = ("--out", str(tmp_path))
    refused(here("carry", "--set", "task.distance_m=0.05", *out), "carry.gif")
    assert (tmp_path / "carry.mp4").read_text() == "a film"


def test_no_animation_needs_no_folder() -> None:
    assert palmbots("carry", "--animation", "none").returncode == DONE


def test_an_unwritable_folder_is_refused(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    refused(palmbots("carry", "--out", str(blocked)), "file")
    assert blocked.read_text() == "not a folder"


@pytest.mark.parametrize(
    ("arguments", "works"),
    [
        (("compare", "--out"), "palmbots.compare"),
        (("design", "--out"), "palmbots.stability.design"),
        (("analyze", "--figures"), "palmbots.stability.analysis"),
    ],
)
def test_a_folder_that_is_none_is_refused_before_the_work(
    arguments: tuple[str, ...],
    works: str,
    here: Here,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Hours of carries are not lost for a misspelt --out."""

    def worked(*_: object, **__: object) -> None:
        pytest.fail("worked first")

    monkeypatch.setattr(importlib.import_module(works), arguments[0], worked)
    taken = tmp_path / "file"
    taken.write_text("mine")
    refused(here(*arguments, str(taken)), "file", "cannot be used as a folder")
    assert taken.read_text() == "mine"


def test_the_dead_band_is_warned_of_before_and_reported_after() -> None:
    keys = {
        "tactile.zero_half_width_m": 0.0001,
        "robot.noise_m_s": 0,
        "robot.acceleration_m_s2": 20,
        "start.right_m": 0.02,
    }
    changes = [part for key, value in keys.items() for part in ("--set", f"{key}={value}")]
    result = palmbots("carry", *changes, "--json")
    assert "zero zone" in result.stderr
    warnings = json.loads(result.stdout)["warnings"]
    assert any("zero zone" in w for w in warnings)
    assert any("limit cycle" in w for w in warnings)


def test_interrupted_it_leaves_nothing_half_written(tmp_path: Path) -> None:
    """Ctrl-C while it writes: every file in the folder is whole."""
    out = tmp_path / "out"
    process = subprocess.Popen(
        [sys.executable, "-m", "palmbots", "carry", "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )
    deadline = time.monotonic() + 60
    while not (out / "carry.mcap").exists() and time.monotonic() < deadline:
        time.sleep(0.02)  # the animation comes next and takes a while
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=60)
    assert process.returncode in (130, DONE)
    assert "Traceback" not in error
    names = {path.name for path in out.iterdir()}
    assert names <= {"carry.png", "carry.mcap", "carry.gif", "message_sequence.png"}
    if process.returncode == 130:
        assert "carry.gif" not in names
    assert palmbots("replay", str(out / "carry.mcap")).returncode == DONE


def test_help_shows_an_example(here: Here) -> None:
    for command in ("carry", "modes", "compare", "replay"):
        result = here(command, "--help")
        assert result.returncode == DONE
        assert f"Example: palmbots {command}" in result.stdout
    assert "numeric scene key" in here("compare", "--help").stdout


def test_help_begins_with_the_main_command_and_has_them_all(here: Here) -> None:
    said = here("--help").stdout.split("Commands:")[1]
    listed = re.findall(r"^  ([a-z]+)  ", said, re.MULTILINE)
    assert listed[:3] == ["carry", "modes", "analyze"]
    assert listed[-1] == "derive" and len(listed) == len(set(listed)) == 14
    assert "..." not in said  # no sentence is cut short
    assert "Commands:" in here().stdout
    assert palmbots("--version").stdout.startswith("palmbots 0.")


def _outputs() -> list[tuple[str, str]]:
    """Every option of every command that names a file or a folder to write."""
    commands: Any = get_command(app)
    return [
        (name, option)
        for name, command in commands.commands.items()
        for parameter in command.params
        if parameter.metavar in ("DIR", "FILE") and parameter.param_type_name == "option"
        for option in parameter.opts
    ]


def test_every_output_is_among_those_asked() -> None:
    known = {("carry", "--out"), ("certify", "-o"), ("analyze", "--figures"), ("export", "--urdf")}
    assert known <= set(_outputs())


@pytest.mark.parametrize(("command", "option"), _outputs())
def test_an_empty_name_does_not_mean_the_working_directory(
    command: str, option: str, here: Here, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``--out "$DIR"`` with DIR unset."""
    monkeypatch.chdir(tmp_path)
    argument = ["study.toml"] if command == "study" else []
    refused(here(command, *argument, option, ""), option, 'value is ""; allowed: a name')
    assert list(tmp_path.iterdir()) == []

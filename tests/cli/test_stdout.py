# SPDX-License-Identifier: Apache-2.0
"""stdout: 80 columns, no trailing blanks, no shortened numbers, full disks, other encodings, closed
streams, and closed pipes."""

import io
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from commands import Run
from palmbots.cli import main as cli
from palmbots.cli.console import plain_table, print_report, report_console
from shell import palmbots

DONE, BAD_INPUT, CLOSED_PIPE = 0, 2, 141
SHORT = ("--set", "task.distance_m=0.1")

# All reports, also with long keys, warnings and several contacts.
REPORTS = [
    ("carry",),
    ("carry", "-c", "resilient", "--set", "radio.loss=0.2", "--seeds", "20"),
    ("carry", "--set", "robot.left.bias_m_s=0.05", "-c", "none"),
    ("carry", "--set", "task.timeout_s=3", "--seeds", "20"),
    ("contact-modes", "--theta-left-deg", "5"),
    ("contact-modes", "--theta-left-deg", "0"),
    ("analyze",),
    ("analyze", "--set", "palm.shallow_deg=4", "--set", "palm.friction=2"),
    ("analyze", "--set", "palm.friction=0.05"),
    ("certify",),
    ("certify", "--friction", "0.1", "0.9"),
    ("design", "--maximize", "com", "--resolution-deg", "5", "--set", "task.distance_m=0.1"),
    ("compare", "-n", "2", *SHORT),
    ("compare", "--sweep", "robot.left.acceleration_m_s2", "--values", "0.5,0.50000000001",
     "-n", "1", *SHORT),
    ("study", "STUDY", "--out", "results"),
    ("study", "centralized-vs-distributed", "--estimate-cost"),
    ("drop-rate", "--set", "robot.noise_m_s=0.03", "--effort", "20",
     "--relative-error-percent", "100"),
    ("derive", "--counterexamples"),
    ("scenes",),
    ("objects",),
    ("keys",),
    ("controllers",),
    ("init", "scene", "my.toml"),
]  # fmt: skip

STUDY = """
controllers = ["centralized", "distributed", "resilient"]
[set]
"task.distance_m" = 0.2
[vary]
"robot.left.acceleration_m_s2" = [0.5, 0.50000000001]
"tactile.zero_half_width_m" = [0.005, 0.006]
"radio.latency_s" = [0.1, 0.5]
[seeds]
count = 20
[stop]
block = 5
drop_rate = 0.2
"""


@pytest.mark.parametrize("arguments", REPORTS, ids=lambda words: " ".join(words)[:40])
def test_report_fits_80_columns_without_trailing_blanks(
    arguments: tuple[str, ...], here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("COLUMNS", raising=False)
    (tmp_path / "study.toml").write_text(STUDY)
    result = here(*("study.toml" if word == "STUDY" else word for word in arguments))
    assert result.stdout
    for line in result.stdout.splitlines():
        is_command = "run: palmbots" in line or "palmbots analyze" in line  # to be copied whole
        assert len(line) <= 80 or is_command, line
        assert line == line.rstrip(), line
    assert "…" not in re.sub(r" … ", "", result.stdout)


def test_numbers_are_not_shortened_in_a_narrow_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    long = ("--sweep", "robot.left.acceleration_m_s2", "--values", "0.5,0.50000000001")
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "30")
    text = palmbots("compare", *long, "-n", "1", "--controllers", "none").stdout
    plain = re.sub("\x1b[^m]*m", "", text)
    assert "…" not in plain
    assert re.search(r"\n +0\.50000000001 +< 95 % +26\.4 +0 +0\n", plain)


def test_running_text_is_as_narrow_as_columns_in_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tables keep 80 columns, and commands are never broken."""
    wide = palmbots("load").stdout
    monkeypatch.setenv("COLUMNS", "40")
    narrow = palmbots("load").stdout
    prose, table = narrow.split("   anywhere")[0], narrow.partition("   anywhere")[2]
    assert max(map(len, prose.splitlines()[:-1])) <= 40
    assert table == wide.partition("   anywhere")[2]
    assert "".join(narrow.split()) == "".join(wide.split())
    monkeypatch.setenv("COLUMNS", "0")
    assert palmbots("load").stdout == wide


@pytest.mark.parametrize("option", [(), ("--json",)])
def test_full_disk_under_stdout_is_reported_in_one_line(option: tuple[str, ...]) -> None:
    with open("/dev/full", "w") as full:
        result = subprocess.run(
            [sys.executable, "-m", "palmbots", "contact-modes", *option],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
            check=False,
        )
    assert result.returncode == BAD_INPUT
    assert result.stderr == "palmbots: the output cannot be written: No space left on device\n"


def test_file_that_vanishes_is_named_in_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def vanished(_: list[str]) -> int:
        raise FileNotFoundError(2, "No such file or directory", "part.mcap")

    monkeypatch.setattr(cli, "run", vanished)
    with pytest.raises(SystemExit) as stop:
        cli.main()
    assert stop.value.code == BAD_INPUT
    assert capsys.readouterr().err == "palmbots: part.mcap: No such file or directory\n"


def with_streams(
    redirections: str, *arguments: str, cwd: Path | None = None
) -> subprocess.CompletedProcess[str]:
    """`palmbots` with redirections of the shell, such as ``>&-`` for a closed stdout."""
    command = f'exec "$0" -m palmbots "$@" {redirections}'
    return subprocess.run(
        ["sh", "-c", command, sys.executable, *arguments],
        capture_output=True, text=True, cwd=cwd, timeout=120, check=False,
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("redirections", [">&-", "2>&-", "<&- >&- 2>&-"])
def test_closed_streams_discard_the_output(redirections: str) -> None:
    result = with_streams(redirections, "keys")
    assert (result.returncode, result.stderr) == (DONE, "")
    assert bool(result.stdout) == (redirections == "2>&-")


@pytest.mark.parametrize("redirections", ["2>&-", "2>/dev/full"])
def test_refusal_without_stderr_has_its_status_and_nothing_on_stdout(redirections: str) -> None:
    result = with_streams(redirections, "carry", "nowhere.toml")
    assert (result.returncode, result.stdout, result.stderr) == (BAD_INPUT, "", "")


def test_file_is_the_same_with_closed_streams(tmp_path: Path) -> None:
    """The first file that is opened would get the number of the closed stdout."""
    for name, redirections in (("open.toml", ""), ("closed.toml", "<&- >&- 2>&-")):
        assert with_streams(redirections, "init", "scene", name, cwd=tmp_path).returncode == DONE
    assert (tmp_path / "closed.toml").read_text() == (tmp_path / "open.toml").read_text()


PIPED = [
    ("--help",),
    ("keys",),
    ("contact-modes", "--json"),
    ("carry", *SHORT),
]


@pytest.mark.slow
@pytest.mark.parametrize("arguments", PIPED, ids=" ".join)
def test_closed_pipe_ends_the_command_quietly(arguments: tuple[str, ...]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with open(writer, "w") as stdout:
        result = subprocess.run(
            [sys.executable, "-m", "palmbots", *arguments],
            stdout=stdout, stderr=subprocess.PIPE, text=True, timeout=120, check=False,
        )  # fmt: skip
    assert (result.returncode, result.stderr) == (CLOSED_PIPE, "")


def test_warning_that_nobody_reads_does_not_stop_the_command() -> None:
    narrow = ("--set", "tactile.zero_half_width_m=0.0001", "--json")
    result = with_streams("2>/dev/full", "carry", *narrow, *SHORT)
    assert '"warnings": ["the zero zone is' in result.stdout


def test_encoding_without_a_character_prints_a_question_mark(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PYTHONIOENCODING", "ascii")
    result = palmbots("contact-modes")
    assert (result.returncode, result.stderr) == (DONE, "")
    assert "palms 15?, 15?" in result.stdout


def test_units_in_brackets_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    """Rich takes text in brackets for markup, unless markup is off."""
    table = plain_table("speed [m/s]", "rms [mm]")
    table.add_row("0.1 [m/s]", "2 [mm]")
    console = report_console()
    console.print(table)
    console.print("largest [m/s²]")
    assert [line.split() for line in capsys.readouterr().out.splitlines()] == [
        ["speed", "[m/s]", "rms", "[mm]"],
        ["0.1", "[m/s]", "2", "[mm]"],
        ["largest", "[m/s²]"],
    ]


@pytest.mark.parametrize(("columns", "between"), [(60, "  "), (54, "\n")])
def test_what_a_report_is_about_stands_beside_the_first_line_if_both_fit(
    columns: int, between: str
) -> None:
    stream, head = io.StringIO(), f"{20 * 'x'} {24 * 'y'}"
    print_report([head], "crate.toml", Console(file=stream, width=columns))
    printed = "\n".join(line.rstrip() for line in stream.getvalue().splitlines())
    assert printed == f"{head}{between}crate.toml"

# SPDX-License-Identifier: Apache-2.0
"""Environment variables with odd values: one line if nothing can use them, else no difference."""

from pathlib import Path

import pytest
from typer._completion_shared import Shells

from commands import Run, assert_refused
from palmbots.cli._environment import SHELLS, environment_fault
from shell import palmbots

COMPLETE = "_PALMBOTS_COMPLETE"
WORDS = {"COMP_WORDS": "palmbots ca", "COMP_CWORD": "1"}


@pytest.mark.parametrize("command", [("carry",), ("replay", "x.mcap"), ("design",)])
@pytest.mark.parametrize("value", ["nonsense", "", "1e9", "-5", "9" * 20, "253402300800", "5\n"])
def test_date_that_is_no_number_of_seconds_is_refused(
    value: str, command: tuple[str, ...], here: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise NumPy and matplotlib fail while they are imported or write a file."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", value)
    assert_refused(
        here(*command), "palmbots: SOURCE_DATE_EPOCH: value is ", "a whole number from 0"
    )


@pytest.mark.parametrize(
    ("variables", "words"),
    [
        ({COMPLETE: "nonsense"}, [f'{COMPLETE}: value is "nonsense"', "complete_SHELL"]),
        ({COMPLETE: "source_csh"}, [f'{COMPLETE}: value is "source_csh"', "bash, zsh, fish"]),
        ({COMPLETE: "complete_bash"}, ["COMP_WORDS: is not set"]),
        ({COMPLETE: "complete_bash", "COMP_WORDS": "x"}, ['COMP_CWORD: value is ""']),
        ({COMPLETE: "complete_bash", **WORDS, "COMP_CWORD": "x"}, ['COMP_CWORD: value is "x"']),
    ],
)
def test_completion_of_a_shell_that_does_not_exist_is_refused(
    variables: dict[str, str], words: list[str], here: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in (COMPLETE, *WORDS):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert_refused(here(), *words)


def test_legal_values_are_accepted() -> None:
    assert set(SHELLS) == set(Shells)
    for shell in SHELLS:
        for what in ("source", "complete"):
            assert environment_fault({COMPLETE: f"{what}_{shell}", **WORDS}) is None
    for value in ("0", "1700000000", "253402300799"):
        assert environment_fault({"SOURCE_DATE_EPOCH": value}) is None
    assert environment_fault({COMPLETE: ""}) is None
    assert environment_fault({}) is None


def test_variables_that_describe_no_terminal_and_no_home_change_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    odd = {
        "COLUMNS": "abc",
        "LINES": "-3",
        "TERM": "nonsense",
        "NO_COLOR": "1",
        "LC_ALL": "C",
        "PYTHONIOENCODING": "ascii",
        "TMPDIR": str(tmp_path / "missing"),
        "MATPLOTLIBRC": str(tmp_path / "missing"),
        "OMP_NUM_THREADS": "abc",
        "TZ": "nonsense",
        "SOURCE_DATE_EPOCH": "0",
    }
    for name, value in odd.items():
        monkeypatch.setenv(name, value)
    monkeypatch.delenv("HOME", raising=False)
    short = ("--set", "task.distance_m=0.1", "--animation", "none")
    result = palmbots("carry", *short, "--out", str(tmp_path / "out"))
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.startswith("DELIVERED")
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"carry.png", "carry.mcap"}


def test_settings_that_matplotlib_cannot_read_are_not_blamed_on_the_backend(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = tmp_path / "matplotlibrc"
    settings.write_bytes(b"\xff\xfe\x00")
    monkeypatch.setenv("MATPLOTLIBRC", str(settings))
    monkeypatch.delenv("MPLBACKEND", raising=False)
    result = palmbots("carry", "--out", str(tmp_path / "out"))
    assert (result.returncode, result.stdout) == (2, "")
    own, line = result.stderr.splitlines()  # matplotlib names the file
    assert str(settings) in own
    assert line.startswith("palmbots: matplotlibrc: matplotlib rejects this file: ")
    assert not (tmp_path / "out").exists()

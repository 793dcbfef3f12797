"""What a report is written to: narrow terminals, pipes, full disks, poor encodings."""

import re
import subprocess
import sys

import pytest

from shell import palmbots

DONE, BAD_INPUT = 0, 2


def test_compare_cuts_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither in a pipe nor in a terminal that is too narrow."""
    long = ("--sweep", "robot.left.acceleration_m_s2", "--values", "0.5,0.50000000001")
    for terminal in ("", "1"):
        monkeypatch.setenv("FORCE_COLOR", terminal)
        monkeypatch.setenv("COLUMNS", "30" if terminal else "80")
        told = palmbots("compare", *long, "-n", "1", "--controllers", "none").stdout
        plain = re.sub("\x1b[^m]*m", "", told)
        title, *rows = plain.splitlines()
        assert title.strip() == "robot.left.acceleration_m_s2: 1 carry a value, seeds from 0"
        assert "…" not in plain
        for word in ("controller", "value", "dropped (95 %)", "rms (95 %)", "messages/m", "B/s"):
            assert word in rows[1]
        assert "0.50000000001 │ 0.0 % (0.0–79.3) │    26.4 mm │          0 │   0 │" in plain


@pytest.mark.parametrize("command", ["analyze", "certify", "modes", "carry"])
def test_no_report_cuts_numbers(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither in a terminal that is too narrow, nor breaks it a line in a pipe."""
    flush = ("--theta-left-deg", "0") if command == "modes" else ()
    for terminal in ("", "1"):
        monkeypatch.setenv("FORCE_COLOR", terminal)
        monkeypatch.setenv("COLUMNS", "30")
        told = palmbots(command, *flush, "--set", "palm.shallow_deg=4").stdout
        table = [line for line in told.splitlines() if "squeeze" not in line]
        assert told and not any("…" in line for line in table)
        if not terminal and command == "analyze":
            assert re.search(
                r"\n  first: left palm, flush .*, p -?[0-9.]+ mm, -?[0-9.]+ mm\n", told
            )


@pytest.mark.parametrize("json_too", [(), ("--json",)])
def test_a_full_disk_under_stdout_is_told_in_one_line(json_too: tuple[str, ...]) -> None:
    with open("/dev/full", "w") as full:
        result = subprocess.run(
            [sys.executable, "-m", "palmbots", "modes", *json_too],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
            check=False,
        )
    assert result.returncode == BAD_INPUT
    assert result.stderr == "palmbots: the output cannot be written: No space left on device\n"


def test_an_encoding_that_lacks_a_sign_is_no_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONIOENCODING", "ascii")
    result = palmbots("modes")
    assert (result.returncode, result.stderr) == (DONE, "")
    assert "palms 15?, 15?" in result.stdout

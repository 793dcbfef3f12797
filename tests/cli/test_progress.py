# SPDX-License-Identifier: Apache-2.0
"""Progress in a log file: one line a minute, with an estimate of the time left."""

import importlib
import io
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from commands import Run, unwrapped
from palmbots.cli._progress import Estimate, LineProgress, progress, staged_progress
from palmbots.cli._warnings import hold_warnings, warn
from palmbots.errors import PalmbotsError


class Clock:
    def __init__(self) -> None:
        self.now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


def test_one_line_a_minute() -> None:
    stream, clock = io.StringIO(), Clock()
    lines = LineProgress(stream, clock)
    for second in range(301):
        clock.now_s = 1000.0 + second
        lines.report("carrying", second / 600)
    assert stream.getvalue().splitlines() == [
        "palmbots: carrying: 10 % after 1:00 min, about 9:00 min left",
        "palmbots: carrying: 20 % after 2:00 min, about 8:00 min left",
        "palmbots: carrying: 30 % after 3:00 min, about 7:00 min left",
        "palmbots: carrying: 40 % after 4:00 min, about 6:00 min left",
        "palmbots: carrying: 50 % after 5:00 min, about 5:00 min left",
    ]


def test_time_left_counts_from_the_start_of_the_stage() -> None:
    stream, clock = io.StringIO(), Clock()
    lines = LineProgress(stream, clock)
    clock.now_s += 50
    lines.report("checking scenes", 1.0)
    lines.report("carrying", 0.0)
    clock.now_s += 100
    lines.report("carrying", 0.25)
    clock.now_s += 7200
    lines.report("carrying", 0.5)
    assert stream.getvalue().splitlines() == [
        "palmbots: carrying: 25 % after 1:40 min, about 5:00 min left",
        "palmbots: carrying: 50 % after 2:01 h, about 2:01 h left",
    ]


def test_time_left_is_not_claimed_where_nothing_moves() -> None:
    """Not "0:00 min left" for work that goes on."""
    stream, clock = io.StringIO(), Clock()
    lines = LineProgress(stream, clock)
    for fraction in (0.0, 0.5, 0.5, 1.0, 1.0):
        lines.report("carrying", fraction)
        clock.now_s += 61
    assert [line.split(", ")[1] for line in stream.getvalue().splitlines()] == [
        "about 1:01 min left", "takes longer than expected", "finishing", "finishing",
    ]  # fmt: skip


def test_time_left_counts_down_between_reports() -> None:
    """Also where a step takes minutes, as a carry in MuJoCo does."""
    stream, clock = io.StringIO(), Clock()
    lines = LineProgress(stream, clock)
    for minute in range(9):
        clock.now_s = 1001.0 + 60 * minute
        lines.report("carrying", minute // 3 / 4)  # a step of a quarter takes three minutes
    assert [line.split(", ")[1] for line in stream.getvalue().splitlines()] == [
        "time left unknown", "time left unknown", "about 9:03 min left", "about 8:03 min left",
        "about 7:03 min left", "about 6:01 min left", "about 5:01 min left", "about 4:01 min left",
    ]  # fmt: skip


def test_time_left_counts_from_the_beginning_of_the_work() -> None:
    """Not from the first report: what comes before it is work, too."""
    stream, clock = io.StringIO(), Clock()
    lines = LineProgress(stream, clock, " of this part")
    clock.now_s += 100
    lines.report("splitting", 0.5)
    line = "palmbots: splitting: 50 % after 1:40 min, about 1:40 min left of this part\n"
    assert stream.getvalue() == line


def test_bar_in_a_terminal_says_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    from palmbots.cli import _progress

    clock, stream = Clock(), io.StringIO()
    monkeypatch.setattr(stream, "isatty", lambda: True, raising=False)
    monkeypatch.setattr("sys.stderr", stream)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(_progress, "Estimate", lambda of: Estimate(clock, of))
    with progress("carrying") as report:
        for fraction, left in ((0.0, "unknown"), (0.5, "about 0:10 min left"), (1.0, "finishing")):
            clock.now_s += 10 * (fraction == 0.5)
            report(fraction)
            time.sleep(0.15)  # the bar is drawn ten times a second
            assert left in stream.getvalue()
    assert "of this part" not in stream.getvalue()
    with staged_progress() as report_stage:
        clock.now_s += 30
        report_stage("checking scenes", 0.5)
        report_stage("carrying", 0.0)
        clock.now_s += 20
        report_stage("carrying", 0.5)
        time.sleep(0.15)
    assert "about 0:20 min left of this part" in stream.getvalue()


def test_moment_that_is_left_is_not_none() -> None:
    clock = Clock()
    estimate = Estimate(clock)
    clock.now_s += 100
    estimate.report(0.999)
    assert estimate.text() == "about 0:01 min left"


@pytest.mark.parametrize("quiet", [True, False])
def test_short_work_prints_nothing(quiet: bool, capsys: pytest.CaptureFixture[str]) -> None:
    with progress("carrying", quiet) as report:
        for k in range(100):
            report(k / 100)
    with staged_progress(quiet) as report_stage:
        report_stage("carrying", 0.5)
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == ("", "")


def test_study_prints_a_line_about_each_lost_worker(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runner = importlib.import_module("palmbots.studies.study_runner")

    def run_study(*_: object, notify: Callable[[str], None], **__: object) -> None:
        notify("the worker tcp://10.0.0.1:1 was lost")
        notify("the worker tcp://10.0.0.2:1 was lost")
        raise PalmbotsError("stop here")

    monkeypatch.setattr(runner, "run_study", run_study)
    result = here("study", "centralized-vs-distributed", "--out", str(tmp_path / "s"))
    assert result.stderr.splitlines() == [
        "palmbots: warning: the worker tcp://10.0.0.1:1 was lost",
        "palmbots: warning: the worker tcp://10.0.0.2:1 was lost",
        "palmbots: stop here",
    ]


def test_warnings_are_held_until_the_work_begins(capsys: pytest.CaptureFixture[str]) -> None:
    line = "palmbots: warning: the palms overlap\n"
    with hold_warnings(), staged_progress() as report:
        warn("the palms overlap")
        report("checking scenes", 1.0)
        assert capsys.readouterr().err == ""
        report("carrying", 0.0)
        assert capsys.readouterr().err == line
        warn("the palms overlap")
        assert capsys.readouterr().err == line  # at once
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("asked", [None, 40, 100])
def test_warnings_are_as_wide_as_reports(
    asked: int | None, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if asked is not None:
        monkeypatch.setenv("COLUMNS", str(asked))
    name = "a-folder/" + 10 * "with-a-long-name-"  # which can be copied in one piece
    warn(text := f"{30 * 'word '}{name}: {30 * 'more '}end")
    printed = capsys.readouterr().err
    assert unwrapped(printed) == f"palmbots: warning: {text}\n"
    widths = [len(line) for line in printed.splitlines() if name not in line]
    assert min(80, asked or 80) - 5 < max(widths) <= min(80, asked or 80)


def test_warnings_of_refused_input_are_not_printed(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(PalmbotsError), hold_warnings():
        warn("the palms overlap")
        raise PalmbotsError("seed: value is -1")
    assert capsys.readouterr().err == ""
    with hold_warnings():  # and none of them is printed later
        pass
    assert capsys.readouterr().err == ""


def test_warnings_are_printed_before_the_output(here: Run, tmp_path: Path) -> None:
    scene = tmp_path / "s.toml"
    scene.write_text("[radio]\n[palm]\nlength_m = 0.15\n")
    for command in (
        ("contact-modes",),
        ("contact-modes", "--json"),
        ("export", "--mjcf", str(tmp_path / "m.xml")),
    ):
        result = here(command[0], str(scene), *command[1:])
        assert result.returncode == 0
        line = (
            "palmbots: warning: s.toml: [radio] sets nothing; it has the values of the scene paper"
        )
        assert unwrapped(result.stderr).replace(f"{tmp_path}/", "") == f"{line}\n"

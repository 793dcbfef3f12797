# SPDX-License-Identifier: Apache-2.0
"""`--controller FILE.py:Class` and `module:Class` in the commands that take a controller."""

import json
import os
from pathlib import Path

import pytest

from commands import Run, assert_refused
from shell import palmbots

SHORT = ("--set", "task.distance_m=0.1")
SOURCE = '''
from palmbots.control import StepOutput


class Level:
    """Drives straight on."""

    def step(self, seen):
        return StepOutput()
'''


@pytest.fixture
def level(tmp_path: Path) -> str:
    """A controller in a file."""
    (tmp_path / "level.py").write_text(SOURCE)
    return f"{tmp_path / 'level.py'}:Level"


def test_carry_takes_a_class_in_a_file(level: str, here: Run) -> None:
    own = json.loads(here("carry", "-c", level, *SHORT, "--json").stdout)
    none = json.loads(here("carry", "-c", "none", *SHORT, "--json").stdout)
    assert own["contact_peak_m"] == none["contact_peak_m"]
    assert own["messages"] == 0


def test_carry_takes_a_class_in_a_module(here: Run) -> None:
    shipped = "palmbots.control:DistributedController"
    own = json.loads(here("carry", "-c", shipped, *SHORT, "--json").stdout)
    compiled = json.loads(here("carry", "-c", "distributed", *SHORT, "--json").stdout)
    assert own["contact_peak_m"] == compiled["contact_peak_m"]
    assert own["messages"] == compiled["messages"]


def test_compare_takes_a_class_in_a_file(level: str, here: Run) -> None:
    few = ("--values", "0.1", "-n", "2", *SHORT)
    rows = json.loads(here("compare", "--controllers", f"none,{level}", *few, "--json").stdout)[
        "rows"
    ]
    assert [row["controller"] for row in rows] == ["none", "Level"]
    assert rows[0]["rms_m"] == pytest.approx(rows[1]["rms_m"], rel=1e-12)


def test_logged_carry_of_an_own_controller_is_replayed(
    level: str, here: Run, tmp_path: Path
) -> None:
    out = str(tmp_path / "out")
    here("carry", "-c", level, *SHORT, "--animation", "none", "--out", out)
    assert here("replay", f"{out}/carry.mcap").returncode == 0


@pytest.mark.parametrize("command", ["carry", "drop-rate", "validate"])
def test_missing_class_is_refused_before_the_work(command: str, level: str, here: Run) -> None:
    assert_refused(here(command, "-c", level.replace(":Level", ":Nothing")), "Nothing")
    assert_refused(here(command, "-c", "no_such_module:Level"), "no_such_module")


def test_drop_rate_refuses_a_controller_that_cannot_be_copied(level: str, here: Run) -> None:
    assert_refused(here("drop-rate", "-c", level), "Level")


# What a class in the file broken.py does, and words of the refusal.
BROKEN = [
    ("raise SystemExit(7)", "broken.py cannot be loaded: SystemExit: 7"),
    ("def f(): f()\nf()", "broken.py cannot be loaded: RecursionError"),
    ("def f(:", "broken.py cannot be loaded: SyntaxError"),
    ("# coding: nonsense", "broken.py cannot be loaded: SyntaxError: unknown encoding"),
    ("import sys\ndel sys.modules[__name__]\nraise OSError", "broken.py cannot be loaded: OSError"),
    ("class E(Exception):\n def __str__(self): raise OSError\nraise E", "be loaded: E\n"),
    ("def __getattr__(name): raise OSError(name)", "C of broken.py cannot be used: OSError: C"),
    ("", "broken.py has no C"),
    ("C = 5", "value is 5"),
    ("C = int", "int has no step"),
    ("class C:\n def __init__(self): raise SystemExit", "C() failed: SystemExit\n"),
    ("class C:\n def step(self, s): raise SystemExit(0)", "C.step failed: SystemExit: 0\n"),
    ("class C:\n def step(self, s): raise GeneratorExit", "C.step failed: GeneratorExit\n"),
    ("class C:\n def step(self, s): self.step(s)", "C.step failed: RecursionError"),
    ("class C:\n def step(self, s): raise OSError('x' * 9999)", "C.step failed: OSError: xxx"),
    ("class C:\n async def step(self, s): pass", "C.step returned"),
    ("class C:\n def step(self, s): return StepOutput.__new__(StepOutput)", "C.step failed: Attr"),
    ("class C:\n @property\n def step(self): raise OSError", "C cannot be used: OSError"),
    ("class C:\n def __getattr__(self, n): return getattr(self, n)", "C cannot be used: Recursion"),
    ("class M(type):\n def __getattribute__(c, n): raise OSError\nclass C(metaclass=M): pass",
     "C of broken.py cannot be used: OSError"),
    ("class C(Level): cases = 5", "cases is 5; allowed: a dictionary of strings"),
    ("class C(Level): cases = {2: 'x'}", "cases is { 2 = \"x\" }; allowed: a dictionary of"),
    ("class C(Level): assisted_cases = 5", "assisted_cases is 5; allowed: a list of strings"),
]  # fmt: skip


@pytest.mark.parametrize(("code", "words"), BROKEN)
def test_controller_that_fails_is_named_in_one_line(
    code: str, words: str, here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where it would end the program, with a status of its own."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken.py").write_text(f"{code}\n" if code.startswith("#") else SOURCE + code)
    result = here("carry", "-c", "broken.py:C", *SHORT)
    assert_refused(result, words)
    assert len(result.stderr) < 400


@pytest.mark.parametrize("method", ["", "def __init__(self)", "def step(self, seen)"])
def test_ctrl_c_in_a_controller_is_ctrl_c(
    method: str, here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code = f"class C(Level):\n {method or 'if True'}: raise KeyboardInterrupt"
    (tmp_path / "slow.py").write_text(SOURCE + code)
    result = here("carry", "-c", "slow.py:C", *SHORT)
    assert (result.returncode, result.stdout) == (130, "")
    assert result.stderr.startswith("palmbots: interrupted")
    assert result.stderr.count("\n") == 1


def test_source_of_another_encoding_is_refused(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "utf16.py").write_bytes(SOURCE.encode("utf-16"))
    (tmp_path / "latin1.py").write_bytes(b"name = '\xe4'\n")
    for name in ("utf16.py", "latin1.py"):
        assert_refused(here("carry", "-c", f"{name}:Level"), f"{name} cannot be loaded")


def test_place_that_is_no_file_is_refused(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.py").mkdir()
    (tmp_path / "loop.py").symlink_to("loop.py")
    os.mkfifo(tmp_path / "pipe.py")
    for place, words in (
        ("folder.py", "Is a directory"),
        ("loop.py", "Too many levels of symbolic links"),
        ("pipe.py", "is not a regular file"),
        ("missing.py", "No such file or directory"),
        ("no.such.module", "cannot be imported: ModuleNotFoundError"),
        ("..", "cannot be imported"),
    ):
        assert_refused(here("carry", "-c", f"{place}:Level"), place, words)
    assert_refused(here("carry", "-c", "sys:exit"), "exit() failed: SystemExit")


# Failures that no caller can catch, in a process of its own because it replaces Python's hooks.
UNCAUGHT = """
import atexit, threading

class C(Level):
    def __init__(self):
        thread = threading.Thread(target=self.work, name="listener")
        thread.start()
        thread.join()

    def work(self): raise OSError("in a thread")

    def __del__(self): raise OSError("at the end")

def goodbye(): raise OSError("at exit")

atexit.register(goodbye)
"""


def test_failure_in_a_thread_or_in_del_is_one_warning(tmp_path: Path) -> None:
    """The carry goes on, as Python does; three robots are made, and each failure is reported
    once."""
    lines = (SOURCE + UNCAUGHT).splitlines()
    (tmp_path / "own.py").write_text("\n".join(lines))

    def place(text: str) -> str:
        return f"(own.py, line {next(k for k, line in enumerate(lines, 1) if text in line)})"

    result = palmbots("carry", "-c", "own.py:C", *SHORT, cwd=tmp_path)
    assert result.returncode == 0
    assert result.stdout.startswith("DELIVERED")
    assert sorted(result.stderr.splitlines()) == [
        f"palmbots: warning: C.__del__ failed: OSError: at the end {place('at the end')}",
        f"palmbots: warning: goodbye failed: OSError: at exit {place('at exit')}",
        f"palmbots: warning: thread listener failed: OSError: in a thread {place('in a thread')}",
    ]


@pytest.mark.parametrize("deed", ["sys.stdout.close()", "sys.stdout = None"])
def test_controller_that_closes_stdout_is_refused(deed: str, tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(f"{SOURCE}import sys\n{deed}\n")
    result = palmbots("carry", "-c", "own.py:Level", *SHORT, cwd=tmp_path)
    assert_refused(result, "palmbots: the output cannot be written", "closed stdout")


def test_policy_that_is_a_pipe_is_refused(here: Run, tmp_path: Path) -> None:
    """It would wait for somebody who writes to it twice."""
    os.mkfifo(tmp_path / "pipe.toml")
    assert_refused(here("carry", "-c", str(tmp_path / "pipe.toml")), "is not a regular file")

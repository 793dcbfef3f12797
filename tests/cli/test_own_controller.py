# SPDX-License-Identifier: Apache-2.0
"""`--controller FILE.py:Class` and `module:Class` in the commands that take a controller."""

import json
from pathlib import Path

import pytest

from commands import Run, assert_refused, unwrapped
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
    assert sorted(unwrapped(result.stderr).splitlines()) == [
        f"palmbots: warning: C.__del__ failed: OSError: at the end {place('at the end')}",
        f"palmbots: warning: goodbye failed: OSError: at exit {place('at exit')}",
        f"palmbots: warning: thread listener failed: OSError: in a thread {place('in a thread')}",
    ]


@pytest.mark.parametrize("deed", ["sys.stdout.close()", "sys.stdout = None"])
def test_controller_that_closes_stdout_is_refused(deed: str, tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(f"{SOURCE}import sys\n{deed}\n")
    result = palmbots("carry", "-c", "own.py:Level", *SHORT, cwd=tmp_path)
    assert_refused(result, "palmbots: the output cannot be written", "closed stdout")

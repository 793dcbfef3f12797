# SPDX-License-Identifier: Apache-2.0
"""`--controller FILE.py:Class` and `module:Class` in the commands that take a controller."""

import json
from pathlib import Path

import pytest

from commands import Run, assert_refused

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

# SPDX-License-Identifier: Apache-2.0
"""The lists of docs/guide/two-robots.md: every fault code, and only lines that a program prints."""

import ast
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import get_args

import pytest

import palmbots as pb
from palmbots.wire import FaultCode

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "guide" / "two-robots.md").read_text(encoding="utf-8")


def first_column(name: str) -> list[str]:
    """The first column of the table between the markers of this name."""
    block = PAGE.partition(f"<!-- {name} -->")[2].partition(f"<!-- end of {name} -->")[0]
    cells = re.findall(r"^\| `([^`]+)` \|", block, re.MULTILINE)
    assert cells
    return cells


@cache
def templates() -> set[str]:
    """All texts in the sources, with … where a value is inserted."""
    found = set()
    for file in (ROOT / "src" / "palmbots").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                parts = (p.value if isinstance(p, ast.Constant) else "…" for p in node.values)
                found.add("".join(map(str, parts)))
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                found.add(node.value)
    return found


def is_printed(line: str) -> bool:
    """Whether a text of the sources is this line, where … stands for anything."""
    pattern = re.compile(".*".join(map(re.escape, line.split("…"))))
    return any(pattern.fullmatch(text) for text in templates())


def test_every_fault_code_is_explained_once() -> None:
    assert sorted(first_column("fault codes")) == sorted(set(get_args(FaultCode)) - {"none"})


@pytest.mark.parametrize("line", first_column("printed lines"))
def test_programs_print_the_lines(line: str) -> None:
    assert is_printed(line)


def test_other_lines_are_noticed() -> None:
    assert not is_printed("…: the boot counter is tired; …")


def test_the_page_installs_what_its_commands_need() -> None:
    named = set(re.findall(r"pip install '\.\[([a-z0-9,]+)\]'", PAGE)[0].split(","))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert named <= project["optional-dependencies"].keys()
    assert "palmbots calibrate pair.toml" in PAGE
    assert "calibrate" in named  # `palmbots.pair.calibration_run` requires it


def test_the_page_quotes_the_load_that_the_default_servo_holds() -> None:
    limits = pb.load_limits("paper")
    torque = limits.scene.mujoco.palm_torque_n_m
    assert f"Its default, {torque:g} N m, is assumed" in PAGE
    mass = re.search(r"heaviest object ([0-9.]+) kg", limits.sentence())
    assert mass is not None
    assert f"finds {mass[1]} kg" in " ".join(PAGE.split())

# SPDX-License-Identifier: Apache-2.0
"""Every file of the tree: its length, and the line that states its licence."""

import subprocess
from pathlib import Path

import pytest

from cxx import ROOT

LICENCE = "SPDX-License-Identifier: Apache-2.0"
LONGEST = 400
GENERATED = "registers.hpp"
CODE = {".cpp", ".hpp", ".pml", ".py"}
LICENSED = CODE | {".cff", ".cmake", ".sh", ".toml", ".yaml", ".yml"}
LICENSED_NAMES = {"CMakeLists.txt", "Makefile", "lock", "setup"}


def tracked_files() -> list[Path]:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if listed.returncode:
        pytest.skip("not a git clone")
    files = [ROOT / name for name in listed.stdout.split("\0") if name]
    return [path for path in files if path.is_file()]


def test_no_source_or_test_has_more_than_400_lines() -> None:
    # GENERATED is written by a script, from files that have their own licence.
    lengths = {
        str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines())
        for path in tracked_files()
        if path.suffix in CODE and path.name != GENERATED
    }
    assert len(lengths) > 400
    assert {name: n for name, n in lengths.items() if n > LONGEST} == {}


def test_every_source_and_data_file_states_its_licence() -> None:
    """In the first line, or in the second below a ``#!``."""
    missing = []
    for path in tracked_files():
        if path.name == GENERATED:
            continue
        if path.suffix in LICENSED or path.name in LICENSED_NAMES:
            head = path.read_text(encoding="utf-8").splitlines()[:2]
            if not any(LICENCE in line for line in head):
                missing.append(str(path.relative_to(ROOT)))
    assert missing == []

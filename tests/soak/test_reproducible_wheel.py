# SPDX-License-Identifier: Apache-2.0
"""Two builds of a wheel and of the source distribution have the same bytes."""

import hashlib
import subprocess
import sys
from pathlib import Path

import pytest

from cxx import ROOT


@pytest.mark.parametrize("name", ["cp311-x86_64", "cp312-abi3-x86_64", "cp311-aarch64"])
def test_two_builds_have_the_same_bytes(name: str, tmp_path: Path) -> None:
    """In two folders, one of them with another name: no path reaches the files."""
    found = []
    for folder in ("one", "another"):
        out = tmp_path / folder / "dist"
        work = tmp_path / folder / "work"
        command = [sys.executable, ROOT / "scripts" / "build_wheels.py", "--only", name]
        command += ["--out", out, "--work", work]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(
            {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted(out.iterdir())}
        )
    assert len(found[0]) == 2
    assert found[0] == found[1]

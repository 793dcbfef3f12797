# SPDX-License-Identifier: Apache-2.0
"""The programs of robots on aarch64: the wheel of this tree is built, and tried under emulation."""

import os
import subprocess
import sys
from pathlib import Path

from cxx import ROOT


def test_programs_on_aarch64_carry_the_same_bits(tmp_path: Path) -> None:
    build = [sys.executable, ROOT / "scripts" / "build_wheels.py", "--only", "cp311-aarch64"]
    subprocess.run([*build, "--out", tmp_path], check=True, timeout=3000)
    tests = [sys.executable, "-m", "pytest", "tests/wheels", "-k", "bookworm-3.11-aarch64"]
    environment = os.environ | {"PALMBOTS_DIST": str(tmp_path)}
    done = subprocess.run(tests, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0 and "3 passed" in done.stdout, done.stdout  # none was skipped

# SPDX-License-Identifier: Apache-2.0
"""`make soak` starts: its parts are found and its summary is printed."""

import subprocess
import sys
from pathlib import Path

SOAK = Path(__file__).resolve().parent.parent / "soak" / "soak.py"


def test_a_soak_of_no_time_runs_no_round_and_passes():
    run = subprocess.run(
        [sys.executable, SOAK, "0"], capture_output=True, text=True, check=False, timeout=60
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines() == ["soak: 0 rounds in 0 min", "soak: no failure"]

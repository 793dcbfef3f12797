# SPDX-License-Identifier: Apache-2.0
"""The command line as a shell runs it: in a process of its own."""

import subprocess
import sys
from pathlib import Path


def palmbots(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "palmbots", *arguments],
        capture_output=True,
        text=True,
        cwd=cwd,
        timeout=120,
        check=False,
    )

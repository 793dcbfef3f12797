# SPDX-License-Identifier: Apache-2.0
"""Small studies for the tests, and real `palmbots study` processes."""

import contextlib
import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import palmbots as pb
from palmbots.cli import main as cli

SMALL: dict[str, Any] = {
    "controllers": ["centralized", "distributed"],
    "vary": {"radio.latency_s": [0.0, 0.2], "robot.noise_m_s": [0.01, 0.02, 0.03]},
    "seeds": {"first": 7, "count": 30},
}

# Long enough to be killed several times: 960 carries, in twelve chunks of `CHUNK`.
CHUNK = 80
LONG = """
controllers = ["centralized", "distributed"]
[set]
task.distance_m = 0.25
[vary]
radio.latency_s = [0, 0.1, 0.2]
robot.noise_m_s = { from = 0.01, to = 0.025, steps = 4 }
[seeds]
count = 40
"""


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "palmbots", "study", *map(str, arguments)]


def study(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command(*arguments), capture_output=True, text=True, timeout=300, check=False, **options
    )


def said(*arguments: object, **options: Any) -> dict[str, Any]:
    """What a study says with --json; it must succeed."""
    done = study(*arguments, "--json", **options)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def study_here(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Run the same command in this process, for tests that leave the process unharmed."""
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        status = cli.run(["study", *map(str, arguments)])
    return subprocess.CompletedProcess([], status, out.getvalue(), error.getvalue())


def said_here(*arguments: object) -> dict[str, Any]:
    """What a study in this process says with --json; it must succeed."""
    done = study_here(*arguments, "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def refused(done: subprocess.CompletedProcess[str], *words: object) -> None:
    """Exit status 2, nothing on stdout, one line on stderr that has these words."""
    assert done.returncode == 2, done
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1, done.stderr
    for word in words:
        assert str(word) in done.stderr


def marks(root: Path) -> set[str]:
    """The chunks that are kept."""
    return {path.name for path in (root / "chunks").glob("*.npz")} if root.exists() else set()


def hash_of(root: Path) -> str:
    """What its folder says of a finished study."""
    return pb.open_study(root).attrs["hash"]

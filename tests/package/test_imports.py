# SPDX-License-Identifier: Apache-2.0
"""What importing the public rooms costs: no package that takes long is loaded."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import palmbots as pb

SLOW = {
    "SALib", "distributed", "flint", "gymnasium", "matplotlib", "mujoco", "pettingzoo", "scipy",
    "xarray", "zarr",
}  # fmt: skip


def test_rooms_leave_slow_packages_alone() -> None:
    rooms = [f"palmbots.{name}" for name in dir(pb) if inspect.ismodule(getattr(pb, name))]
    program = f"import sys, {', '.join(rooms)}; print(*({SLOW} & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert len(rooms) > 8 and done.stdout == "\n"


def test_child_processes_import_nothing_from_the_working_folder() -> None:
    """Every process of the package starts with Python's -P; only pip's command line, which is
    printed for the user, does not."""
    found = []
    for file in Path(str(pb.__file__)).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_bytes())):
            words = [ast.unparse(word) for word in getattr(node, "elts", [])]
            if isinstance(node, ast.List | ast.Tuple) and "sys.executable" in words:
                assert words[:2] == ["sys.executable", "'-P'"], (file, words)
                found.append(file.name)
    assert sorted(found) == ["carry_worker.py", "guard.py", "processes.py", "station_process.py"]


@pytest.mark.slow
def test_programs_of_a_pair_ignore_modules_in_the_working_folder(tmp_path: Path) -> None:
    for name in ("random", "json", "socket", "tomllib"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('taken from the working folder')\n")
    words = ["up", "--lockstep", "--set", "task.distance_m=0.05"]
    done = subprocess.run(
        [sys.executable, "-P", "-m", "palmbots", *words],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("DELIVERED")

# SPDX-License-Identifier: Apache-2.0
"""The C++ programs of the tests: tests/cpp/CMakeLists.txt says what there is.

python tests/support/cxx.py     builds all that the tests need, on all cores
"""

import functools
import os
import shutil
import subprocess
import sys
from pathlib import Path

from waiting import locked

ROOT = Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / "build" / "tests"


def _tool(name: str) -> str:
    """A program of this environment, or else of the system."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
    found = shutil.which(name, path=path)
    assert found, f"{name} is not installed"
    return found


def build(*targets: str) -> subprocess.CompletedProcess[str]:
    """Bring targets up to date: a program's path below build/tests, or a target of CMake."""
    BUILD.mkdir(parents=True, exist_ok=True)
    ninja = _tool("ninja")
    with locked(BUILD / "lock"):
        if not (BUILD / "build.ninja").exists():
            options = ["-G", "Ninja", f"-DCMAKE_MAKE_PROGRAM={ninja}", f"-DPYTHON={sys.executable}"]
            configure = [_tool("cmake"), "-S", ROOT / "tests" / "cpp", "-B", BUILD, *options]
            done = subprocess.run(configure, capture_output=True, text=True)
            assert done.returncode == 0, done.stdout + done.stderr
        command = [ninja, "-C", BUILD, "-k", "0", *targets]
        return subprocess.run(command, capture_output=True, text=True)


@functools.cache
def program(name: str) -> Path:
    """The program build/tests/NAME, compiled first if a source of it has changed.

    Raises AssertionError with the compiler's messages when it does not compile.
    """
    done = build(name)
    assert done.returncode == 0, done.stdout + done.stderr
    return BUILD / name


if __name__ == "__main__":
    print("Building the test programs (minutes when they are new)", flush=True)
    done = build()
    if done.returncode:
        sys.exit(done.stdout + done.stderr)

"""The C++ core by itself: its own tests under sanitizers, and its controllers without a system."""

import os
import subprocess
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from cxx import ROOT, SANITIZERS, compile_cxx

CORE = ROOT / "tests" / "core"
PROGRAMS = sorted(CORE.glob("*_test.cpp"))
# What runs longer unoptimized than it takes to optimize, all else being -O0: lanes_test compiles in
# 97 s with -O1, or in 24 s and then runs in 5 s. The sanitizers look for the same at every level.
OPTIMIZED = {
    # 29 s and 8 s; inlined 70 s and 3 s, with -O0 23 s and 21 s.
    "carry_test": ["-O1", "-fno-inline"],
    "endpoint_test": ["-O1"],
    "resilient_test": ["-O1"],
    "resilient_world_test": ["-O1"],
    "robot_test": ["-O1"],
    "splitting_test": ["-O1"],
    "wire_test": ["-O1"],
}


def test_there_are_core_tests() -> None:
    assert PROGRAMS


@pytest.fixture(scope="module")
def compilations() -> dict[Path, Future[Path]]:
    """All programs of tests/core with sanitizers, compiled side by side."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return {
            p: pool.submit(compile_cxx, p, [*OPTIMIZED.get(p.stem, ["-O0"]), *SANITIZERS])
            for p in PROGRAMS
        }


@pytest.mark.parametrize("source", PROGRAMS, ids=lambda path: path.stem)
def test_core_under_sanitizers(source: Path, compilations: dict[Path, Future[Path]]) -> None:
    """Each program of tests/core passes, with neither memory errors nor undefined behaviour."""
    program = compilations[source].result()
    environment = os.environ | {"UBSAN_OPTIONS": "print_stacktrace=1"}
    done = subprocess.run([program], capture_output=True, text=True, env=environment, timeout=300)
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout}{done.stderr}"


# Compilers call these four by themselves, also in a freestanding program.
FREESTANDING_SYMBOLS = {"memcpy", "memmove", "memset", "memcmp"}


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_controllers_are_freestanding(compiler: str) -> None:
    """Robots run the controllers: no library, no heap, no exceptions, no type information."""
    flags = ["-O2", "-c", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-Wdouble-promotion"]
    compiled = compile_cxx(CORE / "freestanding.cpp", flags, compiler)
    listing = ["nm", "--undefined-only", "--format=posix", str(compiled)]
    symbols = subprocess.run(listing, check=True, capture_output=True, text=True).stdout
    needed = {line.split()[0] for line in symbols.splitlines()}
    assert needed <= FREESTANDING_SYMBOLS

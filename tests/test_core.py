"""The C++ core by itself: its own tests under sanitizers, and its controllers without a system."""

import os
import subprocess
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from cxx import ROOT, SANITIZERS, compile_cxx

CORE = ROOT / "tests" / "core"
PROGRAMS = sorted(CORE.glob("*_test.cpp"))
# These take longer to optimize than to run: team compiles in 11 s, or in 4 s and then runs in 2 s.
BRIEF = {"faults_test", "parcel_test", "radio_test", "team_test"}


def test_there_are_core_tests() -> None:
    assert PROGRAMS


@pytest.fixture(scope="module")
def compilations() -> dict[Path, Future[Path]]:
    """All programs of tests/core with sanitizers, compiled side by side."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return {
            p: pool.submit(compile_cxx, p, ["-O0" if p.stem in BRIEF else "-O1", *SANITIZERS])
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

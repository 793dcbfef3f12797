# SPDX-License-Identifier: Apache-2.0
"""The C++ core by itself: its own tests under sanitizers, and its controllers without a system."""

import os
import subprocess

import pytest

from cxx import ROOT, program

CORE = ROOT / "tests" / "cpp"
PROGRAMS = [
    path.relative_to(CORE).with_suffix("").as_posix() for path in sorted(CORE.glob("*/*_test.cpp"))
]


def test_there_are_core_tests() -> None:
    assert PROGRAMS


@pytest.mark.parametrize("name", PROGRAMS)
def test_core_under_sanitizers(name: str) -> None:
    """Each program of tests/cpp passes, with neither memory errors nor undefined behaviour."""
    environment = os.environ | {"UBSAN_OPTIONS": "print_stacktrace=1"}
    command = [program(name)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300)
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout}{done.stderr}"


# Compilers call these four by themselves, also in a freestanding program.
FREESTANDING_SYMBOLS = {"memcpy", "memmove", "memset", "memcmp"}


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_controllers_are_freestanding(compiler: str) -> None:
    """Robots run the controllers: no library, no heap, no exceptions, no type information."""
    compiled = program(f"control/freestanding-{compiler}.o")
    listing = ["nm", "--undefined-only", "--format=posix", str(compiled)]
    symbols = subprocess.run(listing, check=True, capture_output=True, text=True).stdout
    needed = {line.split()[0] for line in symbols.splitlines()}
    assert needed <= FREESTANDING_SYMBOLS

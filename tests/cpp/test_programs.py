# SPDX-License-Identifier: Apache-2.0
"""The C++ core by itself: its own tests under sanitizers, and its controllers without a system."""

import os
import platform
import subprocess

import pytest

from cxx import ROOT, program

pytestmark = pytest.mark.slow

CORE = ROOT / "tests" / "cpp"
PROGRAMS = [
    path.relative_to(CORE).with_suffix("").as_posix() for path in sorted(CORE.glob("*/*_test.cpp"))
]


def test_there_are_core_tests() -> None:
    assert PROGRAMS


# What a program with random cases, or a search, is given for many more of them than it does by
# itself.
MANY = {
    "batch/bitslice_table_test": "100000",
    "batch/bitslice_test": "200000",
    "batch/lane_carries_test": "60",
    "control/lifting_test": "20000",
    "control/resilient_test": "400",
    "control/resilient_world_test": "20000",
    "runtime/mode_search_test": "2",
    "sim/carry_test": "20",
    "sim/multilevel_splitting_test": "2000",
    "wire/endpoint_test": "1000000",
    "world/contact_step_test": "1000",
    "world/fast_step_test": "600000",
}


def passes(name: str, *arguments: str, timeout_s: float = 300) -> None:
    environment = os.environ | {"UBSAN_OPTIONS": "print_stacktrace=1"}
    command = [program(name), *arguments]
    done = subprocess.run(
        command, capture_output=True, text=True, env=environment, timeout=timeout_s
    )
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout}{done.stderr}"


@pytest.mark.parametrize("name", PROGRAMS)
def test_core_under_sanitizers(name: str) -> None:
    """Each program of tests/cpp passes, with neither memory errors nor undefined behaviour."""
    passes(name)


def test_modes_of_two_robots() -> None:
    """All their states, without sanitizers, with which it takes several times as long."""
    passes("runtime/mode_search-O2", "1")


@pytest.mark.soak
@pytest.mark.parametrize("name", MANY)
def test_many_random_cases_under_sanitizers(name: str) -> None:
    passes(name, MANY[name], timeout_s=1500)


def test_lanes_compile_with_clang() -> None:
    if platform.machine() != "x86_64":
        pytest.skip("untested: lanes of this level are for x86-64")
    program("batch/lanes-clang++.o")


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

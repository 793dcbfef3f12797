# SPDX-License-Identifier: Apache-2.0
"""The same bits on other processors, and why: the core never fuses a multiplication with an
addition.

A fused operation rounds once instead of twice. Processors of the ARM family have it in their base
instruction set, and GCC uses it there by default; x86-64 has it since AVX2. Only
``-ffp-contract=off`` forbids it, so without that flag the results depend on the processor.
"""

import importlib.util
import platform
import re
import shutil
import subprocess
from pathlib import Path

import pytest

import palmbots as pb
from cxx import ROOT, program
from palmbots.control.registry import shipped_names
from palmbots.scene.spec import to_spec

SEEDS = range(5)
QEMU = "qemu-aarch64-static"
CROSS = "aarch64-linux-gnu-g++"
CORE = ROOT / "tests" / "cpp"
# Tests of the core and of the programs of robots that need no other file.
PROGRAMS = [
    path.relative_to(CORE).with_suffix("").as_posix() for path in sorted(CORE.glob("*/*_test.cpp"))
]


def has_fused_multiply_add() -> bool:
    if platform.machine() in ("aarch64", "arm64"):
        return True
    try:
        return " fma " in Path("/proc/cpuinfo").read_text()
    except OSError:
        return False


def lines_of(*command: object) -> list[str]:
    run = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, check=True, timeout=300
    )
    return run.stdout.split()


def expected() -> list[str]:
    return [pb.carry("paper", "silent", seed=seed, record=False).trace_hash for seed in SEEDS]


@pytest.mark.skipif(not has_fused_multiply_add(), reason="this processor has no fused operations")
@pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64", "aarch64"), reason="flags for x86-64 and aarch64"
)
def test_fused_operations_would_change_the_bits_and_are_forbidden() -> None:
    """On one processor, with the same instructions allowed: the flag alone makes the difference."""
    assert lines_of(program("sim/contraction_hash-off")) == expected()
    fused = lines_of(program("sim/contraction_hash-fast"))
    assert all(one != other for one, other in zip(fused, expected(), strict=True))


@pytest.mark.slow
def test_the_extensions_fuse_nothing() -> None:
    """GCC 12 fuses alternating sums of vectors (vfmaddsub) although the flag forbids it, where it
    vectorizes statements one by one. It has not done so in what is shipped."""
    tool = shutil.which("objdump")
    if tool is None or platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("needs objdump, and flags for x86-64")
    for module in ("_core", "_batch", "_batch_v3", "_batch_v4"):
        found = importlib.util.find_spec(f"palmbots.{module}")
        if found is None or found.origin is None:
            continue
        listing = subprocess.run(
            [tool, "--disassemble", "--no-show-raw-insn", found.origin],
            capture_output=True, text=True, check=True,
        ).stdout  # fmt: skip
        assert "\tret" in listing
        fused = re.findall(r"\tvfn?m(?:add|sub)\w+", listing)
        assert fused == [], module


def needs_cross_compiler() -> None:
    for tool in (QEMU, CROSS):
        if shutil.which(tool) is None:
            pytest.skip(f"needs {tool}: scripts/setup soak")


@pytest.mark.soak
def test_aarch64_gives_the_same_bits_and_would_not_without_the_flag() -> None:
    needs_cross_compiler()
    assert lines_of(QEMU, program("aarch64/sim/contraction_hash-off")) == expected()
    fused = lines_of(QEMU, program("aarch64/sim/contraction_hash-fast"))
    assert fused != expected()


@pytest.mark.soak
@pytest.mark.parametrize("controller", shipped_names())
@pytest.mark.parametrize("precision", ["double", "float"])
def test_every_controller_gives_the_same_hash_on_aarch64(controller: str, precision: str) -> None:
    needs_cross_compiler()
    scene = pb.load_scene("paper", {"radio.loss": 0.01, "radio.jitter_s": 0.04})
    executable = program("aarch64/sim/trace_hash")
    for seed in (0, 1, 2**64 - 1):
        run = subprocess.run(
            [QEMU, executable, controller, str(seed), precision],
            input=to_spec(scene).to_bytes(), capture_output=True, check=True, timeout=300,
        )  # fmt: skip
        here = pb.carry(scene, controller, precision=precision, seed=seed, record=False)
        assert run.stdout.decode().strip() == here.trace_hash, seed


@pytest.mark.soak
@pytest.mark.parametrize("name", PROGRAMS)
def test_core_on_aarch64(name: str) -> None:
    """Every C++ test of the core passes, those of the robots' programs (runtime) included."""
    needs_cross_compiler()
    done = subprocess.run(
        [QEMU, program(f"aarch64/{name}")], capture_output=True, text=True, timeout=3000
    )
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout}{done.stderr}"

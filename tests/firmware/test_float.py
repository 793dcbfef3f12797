# SPDX-License-Identifier: Apache-2.0
"""A whole carry in `float` on an emulated Cortex-M4F, world and all (QEMU, machine mps2-an386)."""

import subprocess
from pathlib import Path

import palmbots as pb
from cxx import ROOT

SOURCE = ROOT / "firmware" / "mps2_float"
FLAGS = (
    "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-std=c++20", "-O2",
    "-fno-math-errno", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics",
    "-ffunction-sections", "-fdata-sections", "-Iinclude", "-Itests/cpp", "-nostartfiles",
    "-nostdlib", "-Wl,--gc-sections",
)  # fmt: skip
SEEDS = 3
PATIENCE_S = 400.0  # for a machine that is busy with other work; it takes some seconds


def hashes(contract: str, folder: Path) -> list[str]:
    """What the image prints that was compiled with this -ffp-contract."""
    image = folder / f"{contract}.elf"
    command = [
        "arm-none-eabi-g++", *FLAGS, f"-ffp-contract={contract}", str(SOURCE / "float_carry.cpp"),
        "-T", str(SOURCE / "mps2.ld"), "-lm", "-lc", "-lgcc", "-o", str(image),
    ]  # fmt: skip
    subprocess.run(command, cwd=ROOT, check=True)
    run = [
        "qemu-system-arm", "-M", "mps2-an386", "-nographic", "-monitor", "none", "-semihosting",
        "-serial", "stdio", "-kernel", str(image),
    ]  # fmt: skip
    done = subprocess.run(
        run, capture_output=True, text=True, timeout=PATIENCE_S, stdin=subprocess.DEVNULL
    )
    assert (done.returncode, done.stderr) == (0, "")
    printed = done.stdout.split()
    assert len(printed) == SEEDS
    return printed


def host_hashes() -> list[str]:
    seeds = range(SEEDS)
    return [pb.carry("paper", "resilient", seed=n, precision="float").trace_hash for n in seeds]


def test_it_prints_the_hashes_of_the_host(tmp_path: Path) -> None:
    assert hashes("off", tmp_path) == host_hashes()


def test_fused_operations_change_them(tmp_path: Path) -> None:
    """By default, GCC fuses a multiplication and an addition."""
    assert hashes("fast", tmp_path) != host_hashes()

# SPDX-License-Identifier: Apache-2.0
"""A whole carry in `float` on an emulated Cortex-M4F, world and all (QEMU, machine mps2-an386)."""

import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import palmbots as pb
from cxx import ROOT

SOURCE = ROOT / "firmware" / "mps2_float"
FLAGS = (
    "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-std=c++20", "-O2",
    "-fno-math-errno", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics",
    "-ffunction-sections", "-fdata-sections", "-Iinclude", "-Itests/cpp", "-nostartfiles",
    "-nostdlib", "-Wl,--gc-sections",
)  # fmt: skip
CONTRACTS = ("off", "fast")


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
        run, capture_output=True, text=True, timeout=120, stdin=subprocess.DEVNULL
    )
    return done.stdout.split()


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    folder = tmp_path_factory.mktemp("float")
    with ThreadPoolExecutor() as pool:
        found = pool.map(lambda contract: hashes(contract, folder), CONTRACTS)
        return dict(zip(CONTRACTS, found, strict=True))


def test_it_prints_the_hashes_of_the_host(printed: dict[str, list[str]]) -> None:
    expected = [
        pb.carry("paper", "resilient", seed=seed, precision="float").trace_hash for seed in range(3)
    ]
    assert printed["off"] == expected


def test_fused_operations_change_them(printed: dict[str, list[str]]) -> None:
    """By default, GCC fuses a multiplication and an addition."""
    assert len(printed["fast"]) == 3
    assert printed["fast"] != printed["off"]

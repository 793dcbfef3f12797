# SPDX-License-Identifier: Apache-2.0
"""On a machine of QEMU, mps2-an386, which is no emulator of this project: the program of a robot
gives the same trace, and a whole carry in `float`, world and all, has the hashes of the host.
"""

import subprocess
from pathlib import Path

import pytest

import palmbots as pb
from cxx import ROOT
from emulator.lockstep import LockstepBoard, carry_on_boards
from emulator.qemu import MACHINE, QemuBoard
from palmbots.boards.settings_page import BoardSettings

pytestmark = pytest.mark.soak

HARD = {
    "task.distance_m": 0.5, "radio.loss": 0.1, "radio.latency_s": 0.03, "radio.jitter_s": 0.04,
    "radio.reorder": True, "radio.duplicate": 0.1,
    "robot.left.clock_ppm": 20000.0, "robot.right.clock_ppm": -15000.0,
}  # fmt: skip
FLOAT = (
    "-DPALMBOTS_REAL=float", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16",
    "-std=c++20", "-O2", "-w", "-fno-math-errno", "-fno-exceptions", "-fno-rtti",
    "-fno-threadsafe-statics", "-Iinclude", "-Itests/cpp", "--specs=rdimon.specs",
    "-Wl,--section-start=.vectors=0,-Tdata=0x20000000",
)  # fmt: skip
PATIENCE_S = 400.0  # for a machine that is busy with other work; it takes a second


@pytest.mark.parametrize("controller", ["resilient", "distributed"])
def test_it_carries_as_one_program(second_program: Path, controller: str) -> None:
    made: list[QemuBoard] = []

    def make(image: Path, settings: BoardSettings, table: bytes, seed: int) -> LockstepBoard:
        made.append(QemuBoard(image, settings, table, seed))
        return made[-1]

    overrides = HARD if controller == "resilient" else {"task.distance_m": 0.5}
    scene = pb.load_scene("paper", overrides)
    try:
        result, _ = carry_on_boards(second_program, scene, controller, 3, make)
    finally:
        for board in made:
            board.close()
    host = pb.carry(scene, controller, seed=3)
    assert result.trace_hash == host.trace_hash
    assert result.summary() == host.summary()


def test_a_carry_in_float_has_the_hashes_of_the_host_unless_operations_are_fused(
    tmp_path: Path,
) -> None:
    """By default, GCC fuses a multiplication and an addition."""

    def hashes(contract: str) -> list[str]:
        image = tmp_path / f"{contract}.elf"
        sources = ("tests/cpp/sim/contraction_hash.cpp", "tests/firmware/cortex_m4f.cpp")
        command = ("arm-none-eabi-gcc", *FLOAT, f"-ffp-contract={contract}", *sources, "-lm", "-o")
        subprocess.run([*command, str(image)], cwd=ROOT, check=True)
        run = (*MACHINE, "-semihosting", "-serial", "null", "-kernel", str(image))
        done = subprocess.run(
            run, capture_output=True, text=True, timeout=PATIENCE_S, stdin=subprocess.DEVNULL
        )
        assert (done.returncode, done.stderr) == (0, "")
        return done.stdout.split()

    host = [pb.carry("paper", "silent", seed=n, precision="float").trace_hash for n in range(5)]
    assert hashes("off") == host
    assert hashes("fast") != host

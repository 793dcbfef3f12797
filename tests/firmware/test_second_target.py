# SPDX-License-Identifier: Apache-2.0
"""The same program on a second board, QEMU's mps2-an386, gives the same trace."""

import re
from pathlib import Path

import pytest

import palmbots as pb
from cxx import ROOT
from emulator.lockstep import LockstepBoard, carry_on_boards
from emulator.qemu import QemuBoard
from palmbots.boards.settings_page import BoardSettings

NRF, MPS2 = (ROOT / "firmware" / "board" / name for name in ("nrf52833", "mps2"))
HARD = {
    "task.distance_m": 0.5, "radio.loss": 0.1, "radio.latency_s": 0.03, "radio.jitter_s": 0.04,
    "radio.reorder": True, "radio.duplicate": 0.1,
    "robot.left.clock_ppm": 20000.0, "robot.right.clock_ppm": -15000.0,
}  # fmt: skip


def names(folder: Path) -> set[str]:
    return {file.name for file in folder.glob("*.cpp")}


def test_it_replaces_the_files_that_the_page_lists() -> None:
    page = (ROOT / "docs" / "reference" / "board.md").read_text()
    listed = {line.split("`")[1] for line in page.splitlines() if line.startswith("| `")}
    assert names(NRF) == listed
    assert names(MPS2) == listed | {"line.cpp"}


def test_the_page_lists_each_function_that_a_board_offers() -> None:
    """In the row of the file that declares it."""
    page = (ROOT / "docs" / "reference" / "board.md").read_text()
    rows = [line.split("|") for line in page.splitlines() if line.startswith("| `")]
    listed = {row[1].strip(" `"): set(re.findall(r"`(\w+)`", row[2])) for row in rows}
    declared: dict[str, set[str]] = {}
    file = ""
    for line in (ROOT / "firmware" / "board" / "board.hpp").read_text().splitlines():
        if title := re.match(r"// --- (\w+\.cpp)", line):
            file = title[1]
        elif function := re.match(r"[a-z].*?[ *](\w+)\(.*\);", line):
            declared.setdefault(file, set()).add(function[1])
    assert sum(map(len, declared.values())) > 30
    assert listed == declared


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

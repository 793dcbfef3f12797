# SPDX-License-Identifier: Apache-2.0
"""Permanent memory: the supply is cut at every word of every write."""

import random
import re

import pytest

from cxx import ROOT
from emulator.board import Image, PowerFailed
from emulator.lockstep import LockstepBoard, lockstep_settings
from emulator.wear import records_of_a_carry, wear
from flash_records import flash_record, flash_records
from palmbots.control.registry import resolve
from palmbots.scene.scene import load_scene

WORDS_PER_RECORD = 3


def epochs(board: LockstepBoard) -> list[int]:
    return [record.epoch for record in flash_records(board.board.storage())]


def made(image: Image) -> LockstepBoard:
    settings = lockstep_settings(load_scene("paper"), resolve("centralized"), 0)
    return LockstepBoard(image, settings, b"", 1)


@pytest.mark.parametrize("word", range(2 * WORDS_PER_RECORD + 1))
def test_a_cut_at_every_word_of_a_boot(image: Image, word: int) -> None:
    """The board has the old or the new count, and no epoch in which it has sent is used again."""
    robot = made(image)
    before = epochs(robot)[-1]
    robot.board.cut_power()
    robot.board.nvmc.power_fails_in = word
    used = {before}
    try:
        robot.power_up()
        used.add(epochs(robot)[-1])
        robot.board.cut_power()
    except PowerFailed:
        robot.board.cut_power()
    found = epochs(robot)[-1]
    assert found in (before, before + 1)
    robot.power_up()
    after = epochs(robot)[-1]
    assert after not in used
    assert after == found + 1


@pytest.mark.parametrize("seed", range(10))
def test_a_cut_in_an_erase(image: Image, seed: int) -> None:
    """It leaves anything in the page that is erased, which is the older one."""
    robot = made(image)
    board = robot.board
    board.cut_power()
    board.set_bytes(0x7E000, b"".join(flash_record(n, 1) for n in range(1, 342)))
    board.set_bytes(0x7F000, b"".join(flash_record(n, 2) for n in range(342, 342 + 200)))
    old = board.bytes_at(0x7E000, 0x1000)
    board.nvmc.chance = random.Random(seed)
    board.nvmc.power_fails_in = 0
    with pytest.raises(PowerFailed):
        robot.power_up()
    board.cut_power()
    assert board.bytes_at(0x7E000, 0x1000) not in (old, b"\xff" * 0x1000)
    assert epochs(robot)[-1] == 2
    robot.power_up()
    assert epochs(robot)[-1] == 3
    assert board.bytes_at(0x7E000, 0x1000) == b"\xff" * 0x1000


def test_a_full_page_is_followed_by_the_other(image: Image) -> None:
    """760 boots: the pages take turns, and the count never goes back."""
    robot = made(image)
    for expected in range(2, 760):
        robot.board.cut_power()
        robot.power_up()
        assert epochs(robot)[-1] == expected
    erases = robot.board.nvmc.erases
    assert sum(erases.values()) >= 1
    assert max(erases.values()) - min(erases.get(page, 0) for page in (0x7E000, 0x7F000)) <= 1


def test_the_docs_give_the_life_of_the_memory(image: Image) -> None:
    """The numbers of docs/reference/board.md are those that two boards need in the emulator."""
    boot, carry = records_of_a_carry(image)
    text = " ".join((ROOT / "docs" / "reference" / "board.md").read_text().split())
    start = text.index("- **Wear.**")
    said = [
        float(number.replace(" ", ""))
        for number in re.findall(
            r"\d+(?: \d{3})*(?:\.\d+)?", text[start : text.index("years", start)]
        )
    ]
    records = 2 * (4096 // 12) * 10_000
    years = records / (100 * (boot + carry)) / 365.25
    assert said == [
        341, 10_000, records, boot, carry, round((boot + carry) / 341, 4),
        records // (boot + carry), 100, round(years, 1),
    ]  # fmt: skip
    assert wear(boot, carry)["years"] == round(years, 1) > 10

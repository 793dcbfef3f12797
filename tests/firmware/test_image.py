# SPDX-License-Identifier: Apache-2.0
"""Size, instructions and stores of the images."""

import re
import subprocess
from pathlib import Path

import pytest
from elftools.elf.elffile import ELFFile

from cxx import ROOT
from emulator.board import Board, Image
from emulator.lockstep import LockstepBoard, lockstep_settings
from palmbots.control.registry import resolve
from palmbots.scene.scene import load_scene

IMAGES = ROOT / "build" / "firmware"
PROGRAMS = ("robot", "dongle")
PACKAGE = ROOT / "src" / "palmbots" / "boards" / "data"
MOST_FLASH, MOST_RAM = 64 * 1024, 8 * 1024
# Of the floating-point unit, and of a library that computes in its place.
UNIT = re.compile(r"\t(v(?:add|sub|mul|div|sqrt|cvt|mov|ldr|str|cmp|neg|abs|push|pop|mrs|msr)\S*)")
LIBRARY = re.compile(r"__aeabi_(?:[fd](?:add|sub|mul|div|cmp|2)|[u]?[il]2[fd])|__\w+[sd]f[23]")


def sections(program: str) -> dict[str, int]:
    with (IMAGES / f"{program}.elf").open("rb") as stream:
        return {s.name: s["sh_size"] for s in ELFFile(stream).iter_sections()}


@pytest.mark.parametrize("program", PROGRAMS)
def test_it_fits(image: Image, program: str) -> None:
    size = sections(program)
    flash = size[".vectors"] + size[".text"] + size[".data"] + size.get(".ARM.exidx", 0)
    assert 0 < flash + 0x1000 <= MOST_FLASH  # with the page of the settings
    assert 0 < size[".data"] + size[".bss"] + size[".stack"] <= MOST_RAM


def test_the_package_has_the_notice_of_the_registers() -> None:
    """Binary copies have to come with it."""
    header = (ROOT / "firmware" / "board" / "nrf52833" / "registers.hpp").read_text()
    words = header.split("#pragma")[0].replace("//", "").split()
    notice = words[words.index("Copyright") :]
    assert len(notice) > 200
    assert " ".join(notice) in " ".join((PACKAGE / "NOTICE.txt").read_text().split())


@pytest.mark.parametrize("program", PROGRAMS)
def test_the_package_has_these_programs(image: Image, program: str) -> None:
    """After a change of the core or of the firmware, `make firmware` replaces them."""
    command = ["arm-none-eabi-g++", "-dumpfullversion"]
    version = subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    if version != "12.2.1":
        pytest.skip(f"compiler {version} makes other bytes")
    assert (PACKAGE / f"{program}.hex").read_text() == (IMAGES / f"{program}.hex").read_text()


def disassembly(file: Path) -> str:
    command = ["arm-none-eabi-objdump", "-d", str(file)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@pytest.mark.parametrize("folder", ["", "clang"])
@pytest.mark.parametrize("program", PROGRAMS)
def test_it_has_no_floating_point_instruction(
    image: Image, clang_image: Image, program: str, folder: str
) -> None:
    text = disassembly(IMAGES / folder / f"{program}.elf")
    assert len(text) > 10_000
    assert UNIT.findall(text) == []
    assert LIBRARY.findall(text) == []


def test_floating_point_would_be_found(tmp_path: Path) -> None:
    for flags, pattern in (
        ("-mfloat-abi=hard -mfpu=fpv4-sp-d16", UNIT),
        ("-mfloat-abi=soft", LIBRARY),
    ):
        source = tmp_path / "float.cpp"
        source.write_text("float twice(float x) { return 2.5f * x + 1; }\n")
        compiled = tmp_path / "float.o"
        subprocess.run(
            ["arm-none-eabi-g++", "-mcpu=cortex-m4", "-mthumb", *flags.split(), "-c", str(source),
             "-o", str(compiled)], check=True,
        )  # fmt: skip
        text = subprocess.run(
            ["arm-none-eabi-objdump", "-dr", str(compiled)],
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        assert pattern.findall(text)


class CountingBoard(Board):
    """Counts the stores to peripherals."""

    stores = 0

    def written(self, address: int, size: int, value: int) -> None:
        type(self).stores += 1
        super().written(address, size, value)


NO_JOB = (False, False, False, 0, False)  # what a robot knows in a job on the floor


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_each_store_is_made_once(
    image: Image, clang_image: Image, compiler: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A compiler may emit a volatile store twice. The stores of a quiet tick, counted by hand:

    five slots with 6 for the LEDs, 3 for the timer and 1 for its time (50), the time at which the
    tick begins (1), the switches (6), and the watchdog (1).
    """
    monkeypatch.setattr("emulator.lockstep.Board", CountingBoard)
    scene = load_scene("paper")
    settings = lockstep_settings(scene, resolve("silent"), 0)  # which sends nothing
    program = {"gcc": image, "clang": clang_image}[compiler]
    robot = LockstepBoard(program, settings, b"", 1)
    for _ in range(20):
        robot.step(1, 0, True, [], NO_JOB)
    before = CountingBoard.stores
    for _ in range(10):
        robot.step(1, 0, True, [], NO_JOB)
    assert CountingBoard.stores - before == 10 * (5 * (6 + 3 + 1) + 1 + 6 + 1)


def test_the_watchdog_is_fed_from_one_place(image: Image) -> None:
    settings = lockstep_settings(load_scene("paper"), resolve("silent"), 0)
    robot = LockstepBoard(image, settings, b"", 1)
    feeds = robot.board.watchdog.feeds
    for _ in range(10):
        robot.step(1, 0, True, [], NO_JOB)
    assert robot.board.watchdog.feeds - feeds == 10
    (place,) = robot.board.watchdog.fed_by
    begin, size = image.symbols["_ZN8palmbots5board13feed_watchdogEv"]
    assert begin & ~1 <= place < (begin & ~1) + size
    callers = re.findall(r"\tbl?\S*\s+\w+ <_ZN8palmbots5board13feed_watchdogEv>",
                         disassembly(IMAGES / "robot.elf"))  # fmt: skip
    assert len(callers) == 1

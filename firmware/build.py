# SPDX-License-Identifier: Apache-2.0
"""Compiles the firmware.

    python firmware/build.py [--compiler gcc|clang] [--target nrf52833] [--out build/firmware]
                             [--package]

It writes robot.elf, robot.hex, dongle.elf and dongle.hex. `palmbots firmware` makes the images of a
pair from the .hex files of the package; no compiler is needed for that.
"""

import argparse
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from intelhex import IntelHex

HERE = Path(__file__).parent
ROOT = HERE.parent
PROGRAMS = {"robot": ("robot", "memory"), "dongle": ("dongle", "memory")}
"""The files of each program in app/. All files of the board belong to both."""
COMMON = (
    "-mthumb", "-std=c++20", "-Os", "-ffreestanding", "-fno-exceptions", "-fno-rtti",
    "-fno-threadsafe-statics", "-fno-unwind-tables", "-fno-asynchronous-unwind-tables",
    "-ffunction-sections", "-fdata-sections", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror",
    "-Wdouble-promotion", "-Wshadow", "-Iinclude",
)  # fmt: skip
# Without -fno-move-loop-stores, GCC 12 may emit a volatile store twice.
GCC = ("-mcpu=cortex-m4", "-mfloat-abi=soft", "-fno-move-loop-stores", "-fstack-usage")
# Zig brings clang and a C++ library; the target of Linux is the one for which it has headers.
CLANG = (
    "-target", "thumb-linux-musleabi",
    "-mcpu=cortex_m4-vfp4d16sp-vfp4sp-vfp3d16sp-vfp3sp-vfp2sp-fp64", "-fno-sanitize=all",
    "-fno-stack-protector", "-fomit-frame-pointer", "-Wno-unused-command-line-argument",
)  # fmt: skip


PINNED_GCC = "12.2.1"
"""The compiler of the ready-made programs. Another one makes programs with other bytes."""
PACKAGE = ROOT / "src" / "palmbots" / "boards" / "data"


def version() -> str:
    """The version of GCC."""
    command = ["arm-none-eabi-g++", "-dumpfullversion"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def run(*command: str) -> None:
    """Run a command, and end with what it reports if it fails."""
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")


def compiler(name: str) -> tuple[str, ...]:
    """The command of a compiler, with its own flags."""
    if name == "gcc":
        return ("arm-none-eabi-g++", *GCC)
    return (sys.executable, "-m", "ziglang", "c++", *CLANG)


def build(name: str, target: str, out: Path, extra: tuple[str, ...] = ()) -> dict[str, Path]:
    """Compile all programs for a board; returns the .hex file of each."""
    out.mkdir(parents=True, exist_ok=True)
    board = HERE / "board" / target
    sources = [*sorted(board.glob("*.cpp")), *sorted((HERE / "app").glob("*.cpp"))]
    objects = {source: out / f"{source.parent.name}-{source.stem}.o" for source in sources}

    def compile_one(source: Path) -> None:
        flags = (*compiler(name), *COMMON, *extra)
        run(*flags, "-c", str(source.relative_to(ROOT)), "-o", str(objects[source]))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(compile_one, sources))
    made = {}
    for program, files in PROGRAMS.items():
        if program == "dongle" and target == "mps2":  # which has no radio
            continue
        parts = [str(o) for s, o in objects.items() if s.parent == board or s.stem in files]
        elf = out / f"{program}.elf"
        script = ("-Wl,-T,firmware/board/board.ld", "-Wl,--gc-sections")
        # The linker of GCC for both: what clang leaves out is in libgcc, for whole numbers only.
        run("arm-none-eabi-g++", *GCC[:2], "-mthumb", "-nostdlib", "-nostartfiles", *script,
            "-Wl,--no-warn-mismatch", *parts, "-lgcc", "-o", str(elf))  # fmt: skip
        binary = elf.with_suffix(".hex")
        run("arm-none-eabi-objcopy", "-O", "ihex", str(elf), str(binary))
        IntelHex(str(binary))  # it is one
        made[program] = binary
    return made


def main() -> None:
    """Compile, and print what has been made."""
    assert __doc__
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--compiler", choices=("gcc", "clang"), default="gcc")
    parser.add_argument("--target", default="nrf52833")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "firmware")
    parser.add_argument(
        "--package", action="store_true", help="replace the ready-made programs of the package"
    )
    given = parser.parse_args()
    is_pinned = version() == PINNED_GCC
    for program, file in build(given.compiler, given.target, given.out).items():
        if given.package and is_pinned:
            shutil.copy(file, PACKAGE / file.name)
        print(f"{program}: {file.relative_to(ROOT) if file.is_relative_to(ROOT) else file}")
    if given.package and not is_pinned:
        print(
            f"note: GCC {version()} makes other bytes than GCC {PINNED_GCC}, which has made the "
            "programs of the package; these are left as they are"
        )


if __name__ == "__main__":
    main()

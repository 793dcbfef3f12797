# SPDX-License-Identifier: Apache-2.0
"""The cost of a radio packet: its bytes, and the instructions that write and check one.

    .venv/bin/python benchmarks/bench_wire.py

Prints a table and writes results/wire.csv. The instructions are counted by Valgrind's Callgrind, so
they do not depend on how busy the machine is; they do on compiler and processor.
"""

import csv
import datetime
import platform
import re
import subprocess
import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from _machine import compiler
from palmbots.wire import PACKET_SIZE

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "wire.csv"
SOURCE = HERE / "bench_wire.cpp"
LEVELS = ("-O2", "-Os")


def compiled(level: str, folder: str) -> Path:
    """The program that calls everything, as firmware would be compiled."""
    program = Path(folder) / f"wire{level}"
    options = ["-std=c++20", level, "-g", "-fno-exceptions", "-fno-rtti"]
    include = ["-I", str(HERE.parent / "include")]
    subprocess.run(["g++", *options, *include, str(SOURCE), "-o", str(program)], check=True)
    return program


def instructions(program: Path, function: str, calls: int) -> float:
    """Instructions of one call, those of everything called by it included."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
               f"--toggle-collect={function}", str(program)]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found = re.search(r"Collected : (\d+)", done.stderr)
    assert found, done.stderr
    return int(found[1]) / calls


def main() -> None:
    """Count, print, write."""
    console = Console(highlight=False, soft_wrap=True)
    source = SOURCE.read_text()
    functions = re.findall(r"void (count_\w+)", source)
    (calls,) = re.findall(r"calls = (\d+);", source)
    with tempfile.TemporaryDirectory() as folder:
        programs = [compiled(level, folder) for level in LEVELS]
        rows = [
            (name.removeprefix("count_").replace("_", " "),
             *(instructions(program, name, int(calls)) for program in programs))
            for name in functions
        ]  # fmt: skip
    table = Table("instructions of one", *LEVELS)
    for what, *counts in rows:
        table.add_row(what, *(f"{count:.0f}" for count in counts))
    console.print(table)
    console.print(f"{PACKET_SIZE} bytes a packet; {platform.machine()}, {compiler()}")
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["instructions of one", *LEVELS, "bytes", "processor", "compiler", "date"])
        for what, *counts in rows:
            cells = (f"{count:.0f}" for count in counts)
            today = datetime.date.today().isoformat()
            out.writerow([what, *cells, PACKET_SIZE, platform.machine(), compiler(), today])
    console.print(f"wrote {RESULTS}")


if __name__ == "__main__":
    main()

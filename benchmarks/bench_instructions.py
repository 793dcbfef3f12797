# SPDX-License-Identifier: Apache-2.0
"""Instructions of one carry with each controller, and of radio packets, version by version.

    .venv/bin/python benchmarks/bench_instructions.py

Writes the rows of this version to results/instructions.csv; those of earlier versions stay.
Valgrind's Callgrind counts, so the figures do not depend on how busy the machine is. They do on the
compiler, which each row names. The carries are those of the default scene with seed 0, in double
precision, with their trace hash; the program is that of tests/cpp/sim/trace_hash.cpp with -O2. The
start of the program is not counted.
"""

import csv
import platform
import re
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

import bench_wire
import palmbots as pb
from _machine import compiler
from palmbots.control.registry import shipped_names
from palmbots.scene.spec import to_spec

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "instructions.csv"
SOURCE = HERE.parent / "tests" / "cpp" / "sim" / "trace_hash.cpp"
FIELDS: tuple[str, ...] = ("benchmark", "version", "instructions", "processor", "compiler")


def compiled(folder: str) -> Path:
    """The program that runs one carry."""
    program = Path(folder) / "carry"
    options = ["-std=c++20", "-O2", "-ffp-contract=off", "-fno-math-errno"]
    include = ["-I", str(HERE.parent / "include"), "-I", str(HERE.parent / "tests" / "cpp")]
    subprocess.run(["g++", *options, *include, str(SOURCE), "-o", str(program)], check=True)
    return program


def instructions(program: Path, *words: str, spec: bytes = b"") -> int:
    """Instructions of a whole run of the program."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", str(program)]
    done = subprocess.run([*command, *words], input=spec, capture_output=True, check=False)
    found = re.search(rb"Collected : (\d+)", done.stderr)
    assert found, done.stderr
    return int(found[1])


def counts(kinds: Sequence[str] = ("carry", "packet")) -> dict[str, int]:
    """The instructions of each benchmark of these kinds."""
    found: dict[str, int] = {}
    with tempfile.TemporaryDirectory() as folder:
        if "carry" in kinds:
            spec = to_spec(pb.load_scene("paper")).to_bytes()
            program = compiled(folder)
            start = instructions(program)
            for name in shipped_names():
                whole = instructions(program, name, "0", "double", spec=spec)
                found[f"carry, {name}"] = whole - start
        if "packet" not in kinds:
            return found
        wire = bench_wire.compiled("-O2", folder)
        source = bench_wire.SOURCE.read_text()
        (calls,) = re.findall(r"calls = (\d+);", source)
        for function in re.findall(r"void (count_\w+)", source):
            count = bench_wire.instructions(wire, function, int(calls))
            found[f"packet, {function.removeprefix('count_').replace('_', ' ')}"] = round(count)
    return found


def main() -> None:
    """Count, print, write."""
    rows: list[dict[str, str]] = []
    if RESULTS.exists():
        with RESULTS.open(newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["version"] != pb.__version__]
    table = Table("benchmark", "instructions")
    for name, count in counts().items():
        table.add_row(name, f"{count:,}")
        values = (name, pb.__version__, str(count), platform.machine(), compiler())
        rows.append(dict(zip(FIELDS, values, strict=True)))
    Console(highlight=False, soft_wrap=True).print(table)
    with RESULTS.open("w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS)
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()

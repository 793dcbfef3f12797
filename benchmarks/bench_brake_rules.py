#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does it help if a robot of shared-sign brakes earlier? Drops and time of such variants.

    .venv/bin/python benchmarks/bench_brake_rules.py

In shared-sign a robot brakes while both contacts are off centre in the same direction. In the
variants it also brakes once a single contact has been off centre for some time
(bench_brake_rules.cpp makes their tables from the shipped one). Writes
benchmarks/results/brake_rules.csv: 20 000 carries for each row, the same seeds in all of them.
"""

import csv
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import palmbots as pb
from palmbots.scene.spec import to_spec

HERE = Path(__file__).parent
RESULT = HERE / "results" / "brake_rules.csv"
SOURCE = HERE / "bench_brake_rules.cpp"
CARRIES = 20_000
PATIENCE_S = (0.05, 0.1, 0.2, 0.3, 0.6, 1.0, 100.0)  # the last one: never, which is shared-sign
NOISE_M_S = (0.03, 0.052)


def compiled(folder: str) -> Path:
    """The program that carries with a variant."""
    program = Path(folder) / "brake_rules"
    options = ["-std=c++20", "-O2", "-ffp-contract=off", "-fno-math-errno"]
    include = ["-I", str(HERE.parent / "include"), "-I", str(HERE.parent / "tests" / "cpp")]
    subprocess.run(["g++", *options, *include, str(SOURCE), "-o", str(program)], check=True)
    return program


def main() -> None:
    """Run all variants, print and write."""
    with tempfile.TemporaryDirectory() as folder:
        program = compiled(folder)

        def row(cell: tuple[float, float]) -> tuple[float, float, int, float]:
            patience, noise = cell
            spec = to_spec(pb.load_scene("paper", {"robot.noise_m_s": noise}))
            command = [str(program), str(patience), str(CARRIES)]
            done = subprocess.run(command, input=spec.to_bytes(), capture_output=True, check=True)
            dropped, time = done.stdout.split()
            return patience, noise, int(dropped), float(time)

        with ThreadPoolExecutor(2) as pool:
            rows = list(pool.map(row, [(p, n) for p in PATIENCE_S for n in NOISE_M_S]))
    head = ("patience_s", "noise_m_s", "dropped", "time_s")
    print(*head, sep="  ")
    with RESULT.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        for one in rows:
            print(*one, sep="  ")
            writer.writerow(one)


if __name__ == "__main__":
    main()

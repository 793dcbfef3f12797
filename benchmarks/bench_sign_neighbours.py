#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is there a better rule close to shared-sign or silent? The shipped tables with one thing changed.

    .venv/bin/python benchmarks/bench_sign_neighbours.py [CARRIES]      600 by default

bench_sign_neighbours.cpp makes each neighbour from a shipped table. All of them carry the same
seeds in each condition. Writes benchmarks/results/sign_neighbours.csv, in about five minutes on one
core.
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import palmbots as pb
from palmbots.scene.spec import to_spec

HERE = Path(__file__).parent
RESULT = HERE / "results" / "sign_neighbours.csv"
SOURCE = HERE / "bench_sign_neighbours.cpp"
SHARED = (
    "shared-sign", "reverses", "stands-if-steep", "stands-if-shallow", "follower-stands",
    "leader-stands", "stands-shorter", "stands-longer", "partner-holds", "helper-holds",
    "apart-holds", "turns-0.8", "turns-1.5", "turns-2", "turns-never",
)  # fmt: skip
SILENT = ("silent", "silent-patience-0.4", "silent-patience-2", "silent-patience-4")
LOSSY = {"radio.loss": 0.2, "faults.random_reboots": 1}
CREEPS = {"robot.standing_noise_m_s": 1.0}  # counts as robot.noise_m_s
UNEQUAL = {"palm.left.friction": 0.2, "palm.right.friction": 0.4}
CONDITIONS: tuple[tuple[str, float, dict[str, Any]], ...] = (
    ("default scene", 0.06, {}),
    ("default scene", 0.07, {}),
    ("loss 20 % and one reboot", 0.052, LOSSY),
    ("wheels that creep half as much", 0.05, {"robot.standing_noise_m_s": 0.025}),
    ("wheels that creep as they drive", 0.05, CREEPS),
    ("latency 0.2 s", 0.05, {"radio.latency_s": 0.2}),
    ("friction 0.2 and 0.4", 0.03, UNEQUAL),
    ("slope 3°", 0.05, {"task.slope_deg": 3.0}),
)


def compiled(folder: str) -> Path:
    """The program that carries with a neighbour."""
    program = Path(folder) / "neighbours"
    options = ["-std=c++20", "-O2", "-ffp-contract=off", "-fno-math-errno"]
    include = ["-I", str(HERE.parent / "include"), "-I", str(HERE.parent / "tests" / "cpp")]
    subprocess.run(["g++", *options, *include, str(SOURCE), "-o", str(program)], check=True)
    return program


def main() -> None:
    """Run all cells, print and write."""
    carries = sys.argv[1] if len(sys.argv) > 1 else "600"
    head = ("condition", "noise_m_s", "rule", "carries", "dropped", "stalled", "time_s", "messages")
    with (
        tempfile.TemporaryDirectory() as folder,
        RESULT.open("w", newline="", encoding="utf-8") as file,
    ):
        program = compiled(folder)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        for condition, noise, keys in CONDITIONS:
            spec = to_spec(pb.load_scene("paper", {"robot.noise_m_s": noise} | keys)).to_bytes()
            for rule in (*SHARED, *SILENT):
                command = [str(program), rule, carries]
                done = subprocess.run(command, input=spec, capture_output=True, check=True)
                row = (condition, noise, rule, carries, *done.stdout.decode().split())
                print(*row, sep="  ", flush=True)
                writer.writerow(row)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What if the braking robot of shared-sign stands, instead of keeping its correction?

    .venv/bin/python benchmarks/bench_standing.py [CARRIES]      1500 by default

bench_standing.cpp makes the variant from the shipped table. Both rules carry the same seeds, over
the noise and at 5 cm/s under other conditions. Writes benchmarks/results/standing.csv, in a minute
or two on one core.
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
RESULT = HERE / "results" / "standing.csv"
SOURCE = HERE / "bench_standing.cpp"
RULES = ("reverses", "stands")
USUAL = 0.05  # the noise of the other conditions [m/s]
CREEPS = {"robot.standing_noise_m_s": 1.0}  # counts as robot.noise_m_s
CONDITIONS: tuple[tuple[str, float, dict[str, Any]], ...] = (
    *(("default scene", noise, {}) for noise in (0.01, USUAL, 0.0585, 0.07)),
    ("wheels that creep as they drive", USUAL, CREEPS),
    ("wheels that creep half as much", USUAL, {"robot.standing_noise_m_s": USUAL / 2}),
    ("latency 0.2 s", USUAL, {"radio.latency_s": 0.2}),
    ("loss 20 % and one reboot", USUAL, {"radio.loss": 0.2, "faults.random_reboots": 1}),
    ("bias +1.5 cm/s of the left robot", USUAL, {"robot.left.bias_m_s": 0.015}),
    ("bias −1.5 cm/s of the left robot", USUAL, {"robot.left.bias_m_s": -0.015}),
    ("slope 3°", USUAL, {"task.slope_deg": 3.0}),
    ("friction 0.2 and 0.4", USUAL, {"palm.left.friction": 0.2, "palm.right.friction": 0.4}),
    ("object `l-shape`", USUAL, {"object": "l-shape"}),
    ("palms of 10 cm", USUAL, {"palm.length_m": 0.1}),
    ("false readings 2 %", USUAL, {"tactile.false_rate": 0.02}),
    ("beacons every 0.3 s", USUAL, {"radio.beacon_s": 0.3}),
)


def compiled(folder: str) -> Path:
    """The program that carries with both rules."""
    program = Path(folder) / "standing"
    options = ["-std=c++20", "-O2", "-ffp-contract=off", "-fno-math-errno"]
    include = ["-I", str(HERE.parent / "include"), "-I", str(HERE.parent / "tests" / "cpp")]
    subprocess.run(["g++", *options, *include, str(SOURCE), "-o", str(program)], check=True)
    return program


def main() -> None:
    """Run all cells, print and write."""
    carries = sys.argv[1] if len(sys.argv) > 1 else "1500"
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
            for rule in RULES:
                command = [str(program), rule, carries]
                done = subprocess.run(command, input=spec, capture_output=True, check=True)
                row = (condition, noise, rule, carries, *done.stdout.decode().split())
                print(*row, sep="  ", flush=True)
                writer.writerow(row)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How few beacons does shared-sign need? The shipped table with other times between its beacons.

    .venv/bin/python benchmarks/bench_beacons.py [CARRIES]      4000 by default

All rules keep the lease of the default scene, for which the controller is proved, and carry the
same seeds in each condition. Prints the table of docs/reference/measurements.md, in about two
minutes on one core.
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import palmbots as pb
from palmbots.scene.spec import to_spec

HERE = Path(__file__).parent
SOURCE = HERE / "bench_beacons.cpp"
CONDITIONS: tuple[dict[str, Any], ...] = (
    {},
    {"robot.noise_m_s": 0.06},
    {"robot.noise_m_s": 0.07},
    {"robot.noise_m_s": 0.052, "radio.loss": 0.2, "faults.random_reboots": 1},
)
NEVER = 9999
RULES = (  # busy, early, alone, quiet, whether silence is answered, the age that is old; in ticks
    (5, 5, 5, 5, 0, NEVER),
    (10, 10, 10, 10, 0, NEVER),
    (15, 15, 15, 15, 0, NEVER),
    (20, 20, 20, 20, 0, NEVER),
    (50, 50, 50, 50, 0, NEVER),
    (10, 10, 10, 10, 0, 26),
    (10, 10, 5, 200, 1, 28),
    (10, 10, 10, 200, 1, 28),
    (10, 8, 10, 200, 1, 28),
    (10, 8, 10, 200, 1, 26),
    (10, 10, 10, 200, 1, 24),
    (10, 10, 10, 200, 1, NEVER),
)


def compiled(folder: str) -> Path:
    """The program that carries by a rule."""
    program = Path(folder) / "beacons"
    options = ["-std=c++20", "-O2", "-ffp-contract=off", "-fno-math-errno"]
    include = ["-I", str(HERE.parent / "include"), "-I", str(HERE.parent / "tests" / "cpp")]
    subprocess.run(["g++", *options, *include, str(SOURCE), "-o", str(program)], check=True)
    return program


def main() -> None:
    """Run all cells and print them."""
    carries = int(sys.argv[1]) if len(sys.argv) > 1 else 4000
    digits = 1 if carries < 10_000 else 2
    with tempfile.TemporaryDirectory() as folder:
        program = compiled(folder)
        for *times, answers, old in RULES:
            cells = [f"{ticks / 100:g}" for ticks in times]
            cells.append("yes" if answers else "no")
            cells.append("–" if old == NEVER else f"{old / 100:g}")
            for keys in CONDITIONS:
                spec = to_spec(pb.load_scene("paper", keys)).to_bytes()
                words = [str(word) for word in (program, *times, answers, old, carries)]
                done = subprocess.run(words, input=spec, capture_output=True, check=True)
                dropped, _, _, messages = done.stdout.decode().split()
                cells += [f"{100 * int(dropped) / carries:.{digits}f} %, {float(messages):.0f}"]
            print("|", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main()

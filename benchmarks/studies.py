#!/usr/bin/env python3
"""Studies: how they scale over threads, and what memory ten million carries take.

    .venv/bin/python benchmarks/studies.py

Each is a real `palmbots study` process with a new folder. Writes benchmarks/results/studies.csv.
"""

import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from machine import processor

import palmbots as pb

RESULT = Path(__file__).parent / "results" / "studies.csv"

SCALING = """
controllers = ["centralized", "distributed"]
[vary]
robot.noise_m_s = [0.01, 0.015, 0.02]
[seeds]
count = 10_000
"""

# Ten million carries that are short, so that it takes a minute: memory is what is asked.
MANY = """
controllers = ["none", "distributed"]
[set]
task.distance_m = 0.01
[vary]
robot.noise_m_s = [0.01, 0.02, 0.03, 0.04, 0.05]
[seeds]
count = 1_000_000
"""


def run(text: str, threads: int) -> dict[str, Any]:
    """One study: what it says, and the most memory its process had [MB]."""
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "study.toml"
        file.write_text(text)
        words = [sys.executable, "-m", "palmbots", "study", str(file), "--json"]
        words += ["--threads", str(threads), "--out", str(Path(place) / "out")]
        with subprocess.Popen(words, stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            said = json.loads(process.stdout.read())
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    assert isinstance(used, resource.struct_rusage)
    return said | {"memory_mb": used.ru_maxrss / 1e3}


def main() -> None:
    """Measure, print, write."""
    rows = []
    times: dict[int, list[float]] = {1: [], 2: []}
    hashes = set()
    for _ in range(3):
        for threads in times:
            said = run(SCALING, threads)
            times[threads].append(said["seconds"])
            hashes.add(said["hash"])
    assert len(hashes) == 1, "threads must not change results"
    one, two = (min(times[t]) for t in (1, 2))
    rows.append({"what": "60 000 carries, 1 thread", "value": round(one, 2), "unit": "s"})
    rows.append({"what": "60 000 carries, 2 threads", "value": round(two, 2), "unit": "s"})
    rows.append({"what": "scaling, best of 3 each", "value": round(one / two, 3), "unit": "1"})
    said = run(MANY, 2)
    assert said["carries"] == 10_000_000
    rows.append(
        {"what": "10 000 000 carries, memory", "value": round(said["memory_mb"]), "unit": "MB"}
    )
    rows.append({"what": "the same, time", "value": round(said["seconds"], 1), "unit": "s"})
    where = {"machine": processor(), "palmbots": pb.__version__}
    with RESULT.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, [*rows[0], *where])
        writer.writeheader()
        for row in rows:
            print(f"{row['what']:28} {row['value']} {row['unit']}")
            writer.writerow(row | where)


if __name__ == "__main__":
    main()

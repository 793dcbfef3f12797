#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Studies: how they scale over threads, and how much memory ten million carries need.

    .venv/bin/python benchmarks/bench_studies.py

Scaling includes carrying and writing. It is computed from the shortest of many short runs, which
alternate between one thread and two. On a shared machine wall-clock time is not reliable. So two
processes that share nothing are timed beside it, and the processor time that is not spent on
carrying is measured; from it follows the scaling on two free cores. Memory is that of a real
`palmbots study` process. Writes benchmarks/results/studies.csv.
"""

import csv
import json
import multiprocessing
import os
import resource
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import palmbots as pb
from _machine import processor
from palmbots.studies.chunk_task import Block
from palmbots.studies.chunking import Chunk
from palmbots.studies.exact_sums import ExactSums
from palmbots.studies.local_runner import run_locally
from palmbots.studies.points import design_points
from palmbots.studies.schedule import StudySchedule
from palmbots.studies.store import open_store
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import layout_of

RESULT = Path(__file__).parent / "results" / "studies.csv"

SCALING = {
    "controllers": ["centralized", "distributed"],
    "vary": {"robot.noise_m_s": [0.01, 0.015, 0.02]},
    "seeds": {"count": 6000},
}
TURNS = 8

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


@dataclass
class Carried:
    """One run in a new folder, in seconds."""

    wall: float
    total: float
    """Processor time of the whole process."""
    main: float
    """Of that, what the main thread took: while it works, no core carries."""
    writer: float
    """Of that, counting and writing, beside the carrying."""


def carrying(threads: int) -> Carried:
    """Carry and write a study."""
    points = design_points(load_plan(SCALING))
    cut = layout_of(points, None)
    writing = [0.0]

    with (
        tempfile.TemporaryDirectory() as place,
        open_store(Path(place) / "out", points, cut, is_chosen=False) as store,
    ):
        write = store.write

        def timed(chunk: Chunk, block: Block, sums: ExactSums) -> None:
            write(chunk, block, sums)
            writing[0] = time.thread_time()  # the thread does nothing else

        store.write = timed
        schedule = StudySchedule(store)
        began = time.perf_counter(), time.process_time(), time.thread_time()
        run_locally(schedule, threads, lambda _completed, _expected: None)
        now = time.perf_counter(), time.process_time(), time.thread_time()
    wall, total, main = (b - a for a, b in zip(began, now, strict=True))
    return Carried(wall, total, main, writing[0])


def main() -> None:
    """Measure, print, write."""
    times: dict[int, list[Carried]] = {1: [], 2: []}
    both = []  # the same in two processes at once, which share nothing: what the machine can
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        for _ in range(TURNS):
            for threads in times:
                times[threads].append(carrying(threads))
            both.append(max(run.wall for run in pool.map(carrying, (1, 1))))
    one, two = (min(run.wall for run in times[t]) for t in (1, 2))
    alone = min(times[1], key=lambda run: run.total)
    apart = alone.total - alone.main - alone.writer
    possible = (apart + alone.main) / (alone.main + (apart + alone.writer) / 2)
    said = run(MANY, 2)
    assert said["carries"] == 10_000_000
    results = (
        ("36 000 carries, 1 thread", round(one, 3), "s"),
        ("36 000 carries, 2 threads", round(two, 3), "s"),
        ("scaling, by the clock", round(one / two, 2), "1"),
        ("two processes, by the clock", round(2 * one / min(both), 2), "1"),
        ("main thread, of the processor time", round(100 * alone.main / alone.total, 2), "%"),
        ("writer, of the processor time", round(100 * alone.writer / alone.total, 2), "%"),
        ("scaling that these leave", round(possible, 2), "1"),
        ("10 000 000 short carries, memory", round(said["memory_mb"]), "MB"),
        ("10 000 000 short carries, 2 threads", round(said["seconds"], 1), "s"),
    )
    where = {"machine": processor(), "palmbots": pb.__version__}
    with RESULT.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, ["what", "value", "unit", *where])
        writer.writeheader()
        for what, value, unit in results:
            print(f"{what:36} {value} {unit}")
            writer.writerow({"what": what, "value": value, "unit": unit} | where)


if __name__ == "__main__":
    main()

"""What a study will cost, told before it runs: carries, time, disk and memory.

Time is measured, not guessed: a few carries of cells all over the design, on as many threads as the
study would have.
"""

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from palmbots.batch import run_table
from palmbots.lowering import lower
from palmbots.studies.design import Points
from palmbots.studies.layout import Layout
from palmbots.studies.work import VARIABLES

__all__ = ["Cost", "cost_of"]

_POINTS, _SEEDS = 24, 64
_KEPT = 0.75  # of the bytes of results after compression: rms and peak are noise that does not pack
_BESIDES = 900  # bytes a cell and chunk: marks
_WORKING = 110  # bytes a carry while a chunk is carried: the core's columns, and the block twice


@dataclass(frozen=True)
class Cost:
    """What a study takes if no cell stops early."""

    points: int
    cells: int
    """Points × controllers, without those that the resilient algorithm refuses."""
    carries: int
    chunks: int
    carries_a_chunk: int
    seconds: float
    """On this machine, with so many threads."""
    threads: int
    by_controller: dict[str, float]
    """Mean milliseconds a carry on one of the threads."""
    disk_bytes: int
    memory_bytes: int
    """For results; it does not grow with the seeds of a cell."""

    def summary(self) -> dict[str, Any]:
        """What ``palmbots study --explain --json`` prints, besides the scene."""
        return {
            "points": self.points,
            "cells": self.cells,
            "carries": self.carries,
            "chunks": self.chunks,
            "carries_a_chunk": self.carries_a_chunk,
            "seconds": round(self.seconds, 1),
            "threads": self.threads,
            "ms_a_carry": {name: round(ms, 3) for name, ms in self.by_controller.items()},
            "disk_bytes": self.disk_bytes,
            "memory_bytes": self.memory_bytes,
        }


def cost_of(points: Points, cut: Layout, threads: int) -> Cost:
    """Measure a sample of the study and say what all of it will take."""
    study = points.plan.study
    total = len(points.values)
    seconds, cells, each = 0.0, 0, {}
    for controller in study.controllers:
        able = [i for i in range(total) if controller != "resilient" or i not in points.refused]
        cells += len(able)
        if not able:
            continue
        chosen = [able[round(k)] for k in np.linspace(0, len(able) - 1, min(_POINTS, len(able)))]
        table = b"".join(lower(points.scene(i)).to_bytes() for i in chosen)
        seeds = np.arange(max(_SEEDS, 8 * threads), dtype=np.uint64) + study.seeds.first
        which = np.repeat(np.arange(len(chosen), dtype=np.uint32), len(seeds))
        began = time.perf_counter()
        run_table(
            table, which, np.tile(seeds, len(chosen)), controller, study.precision, threads=threads
        )
        one = (time.perf_counter() - began) / len(which)
        each[controller] = 1e3 * one * threads
        seconds += one * len(able) * study.seeds.count
    wide = sum(np.dtype(v.kind).itemsize * (2 if v.by_side else 1) for v in VARIABLES.values())
    carries = cells * study.seeds.count
    rows = math.prod(cut.shape) * len(study.controllers)
    return Cost(
        points=total,
        cells=cells,
        carries=carries,
        chunks=cut.chunks,
        carries_a_chunk=cut.carries_a_chunk,
        seconds=seconds,
        threads=threads,
        by_controller=each,
        disk_bytes=int(_KEPT * wide * carries) + _BESIDES * rows * cut.columns,
        memory_bytes=_WORKING * 2 * cut.carries_a_chunk + 700 * rows,
    )

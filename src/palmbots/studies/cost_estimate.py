# SPDX-License-Identifier: Apache-2.0
"""What a study will cost, estimated before it runs: carries, time, disk and memory.

The time is measured: a few carries of cells all over the design, on as many threads as the study
would use.
"""

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from palmbots._util.results import Result
from palmbots._util.text import data_size, duration, plural
from palmbots.scene.spec import to_spec
from palmbots.studies.chunk_task import ChunkTask, build_id, carry_chunk
from palmbots.studies.chunking import ChunkGrid
from palmbots.studies.points import Points
from palmbots.studies.variables import VARIABLES

_POINTS, _SEEDS, _SEEDS_IN_PYTHON = 24, 64, 1
# Share of the bytes of results that is left after compression: rms and peaks compress badly.
_COMPRESSED = 0.75
_MARK_BYTES = 900  # per cell and chunk
_WORKING_BYTES = 110  # per carry while its chunk runs: the columns of the core, and two blocks


@dataclass(frozen=True, repr=False)
class Cost(Result):
    """The cost of a study in which no cell stops early."""

    points: int
    cells: int
    """Points × controllers, without the cells that a controller refuses."""
    carries: int
    chunks: int
    carries_a_chunk: int
    seconds: float
    """On this machine, with this number of threads."""
    threads: int
    by_controller: dict[str, float]
    """Mean milliseconds per carry on one of the threads."""
    disk_bytes: int
    memory_bytes: int
    """For results; it does not grow with the number of seeds."""

    def headline(self) -> str:
        """One line with the number of carries and the time."""
        on = plural(self.threads, "thread")
        return f"{self.carries:,} carries, about {duration(self.seconds)} on {on}"

    def facts(self) -> dict[str, str]:
        """How the carries are divided, and the disk and memory they need."""
        return {
            "points": f"{self.points:,}",
            "cells": f"{self.cells:,}",
            "chunks": f"{self.chunks:,} of at most {self.carries_a_chunk:,} carries",
            "time per carry": ", ".join(
                f"{name} {ms:.2g} ms" for name, ms in self.by_controller.items()
            ),
            "disk": f"about {data_size(self.disk_bytes)}",
            "memory": f"about {data_size(self.memory_bytes)}",
        }

    def summary(self) -> dict[str, Any]:
        """What ``palmbots study --estimate-cost --json`` prints, besides the scene."""
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


def estimate_cost(points: Points, layout: ChunkGrid, threads: int) -> Cost:
    """Measure a sample of a study, and extrapolate to all of it."""
    study = points.plan.study
    allowed = points.allowed_cells()
    seconds, by_controller = 0.0, {}
    for c, controller in enumerate(points.plan.controllers):
        able = np.nonzero(allowed[:, c])[0]
        if not len(able):
            continue
        is_python = controller.is_python
        places = np.linspace(0, len(able) - 1, min(_POINTS, len(able)))
        scenes = tuple(points.scene(int(able[round(k)])) for k in places)
        task = ChunkTask(
            build=build_id(),
            table=b"".join(to_spec(scene).to_bytes() for scene in scenes),
            points=len(scenes),
            controllers=(controller.name,),
            active=np.ones((len(scenes), 1), bool),
            first_seed=study.seeds.first,
            seeds=max(_SEEDS, 8 * threads) if not is_python else _SEEDS_IN_PYTHON,
            precision=study.precision,
            makers={} if controller.maker is None else {controller.name: controller.maker},
            policies={} if controller.is_compiled or is_python else {controller.name: controller},
            scenes=scenes if is_python else (),
        )
        began = time.perf_counter()
        carry_chunk(task, threads)
        one = (time.perf_counter() - began) / (task.points * task.seeds)
        by_controller[controller.name] = 1e3 * one * (1 if is_python else threads)
        seconds += one * len(able) * study.seeds.count
    width = sum(np.dtype(v.dtype).itemsize * (2 if v.by_side else 1) for v in VARIABLES.values())
    cells = int(allowed.sum())
    carries = cells * study.seeds.count
    stored_cells = math.prod(layout.shape) * len(points.plan.controllers)
    return Cost(
        points=len(points.values),
        cells=cells,
        carries=carries,
        chunks=layout.chunks,
        carries_a_chunk=layout.carries_a_chunk,
        seconds=seconds,
        threads=threads,
        by_controller=by_controller,
        disk_bytes=int(_COMPRESSED * width * carries) + _MARK_BYTES * stored_cells * layout.columns,
        memory_bytes=_WORKING_BYTES * 2 * layout.carries_a_chunk + 700 * stored_cells,
    )

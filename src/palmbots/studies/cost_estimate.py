# SPDX-License-Identifier: Apache-2.0
"""What a study will cost, estimated before it runs: carries, time, disk and memory.

The time is measured: a few carries of cells all over the design, on as many threads as the study
would use.
"""

import math
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Table
from palmbots._util.results import Result
from palmbots._util.text import data_size, duration, plural
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import FEW_SECONDS, SLOW_BUILD, SlowBuildWarning, is_built
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
    ms_a_carry: dict[str, float]
    """Mean milliseconds per carry on one of the threads."""
    disk_bytes: int
    memory_bytes: int
    """For results; it does not grow with the number of seeds."""
    design: Points = field(metadata=NOT_IN_JSON)

    @derived
    def study(self) -> str:
        """The name of the study."""
        return self.design.plan.name

    @derived
    def scene(self) -> Scene:
        """The scene that is varied."""
        return self.design.plan.base

    def lines(self) -> Iterator[Item]:
        """How the carries are divided, and the time, disk and memory they need."""
        plan = self.design.plan
        most = "at most " if plan.study.stop else ""
        yield f"{self.study}: {most}{self.carries:,} carries, about {duration(self.seconds)}"
        rows = [
            ("points", f"{self.points:,} ({self._of_points()})"),
            ("cells", f"{self.cells:,} ({', '.join(plan.controller_names)})"),
            ("carries", f"{most}{self.carries:,}, {plan.study.seeds.count:,} per cell"),
            ("chunks", f"{self.chunks:,} of at most {self.carries_a_chunk:,} carries"),
            ("time", f"{most}about {duration(self.seconds)} on {plural(self.threads, 'thread')}"),
            *(("", f"{name}: {ms:.2g} ms per carry") for name, ms in self.ms_a_carry.items()),
            ("disk", f"{most}about {data_size(self.disk_bytes)}"),
            ("memory", f"about {data_size(self.memory_bytes)} in addition to Python's own"),
        ]
        if self.design.rejected_cells:
            rows.append(("refused", plural(len(self.design.rejected_cells), "cell")))
        yield Table(rows)

    def _of_points(self) -> str:
        plan = self.design.plan
        if self.design.is_grid:
            sizes = zip(plan.keys, self.design.shape, strict=False)
            return " × ".join(f"{n} {key}" for key, n in sizes) or "nothing varies"
        return f"{plan.study.design.kind} over {plural(len(plan.keys), 'key')}"


def estimate_cost(points: Points, layout: ChunkGrid, threads: int) -> Cost:
    """Measure a sample of a study, and extrapolate to all of it.

    Warns:
        SlowBuildWarning: no batch module is built, and the study is large.
    """
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
    can_be_faster = any(one.runs_in_lanes for one in points.plan.controllers)
    if carries > FEW_SECONDS and can_be_faster and not is_built():
        warnings.warn(SLOW_BUILD, SlowBuildWarning, stacklevel=2)
    stored_cells = math.prod(layout.shape) * len(points.plan.controllers)
    return Cost(
        points=len(points.values),
        cells=cells,
        carries=carries,
        chunks=layout.chunks,
        carries_a_chunk=layout.carries_a_chunk,
        seconds=seconds,
        threads=threads,
        ms_a_carry=by_controller,
        disk_bytes=int(_COMPRESSED * width * carries) + _MARK_BYTES * stored_cells * layout.columns,
        memory_bytes=_WORKING_BYTES * 2 * layout.carries_a_chunk + 700 * stored_cells,
        design=points,
    )

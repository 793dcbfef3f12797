# SPDX-License-Identifier: Apache-2.0
"""The schedule of a study: which chunks are due, their sums, and which cells continue.

Every block of points is a row. The cells of a row are carried one block of seeds after another (a
study that does not stop early has a single block). Once all chunks of a block are recorded, the
cells that are precise enough stop, and the others continue. Chunks may be recorded in any order.
"""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palmbots.scene.spec import to_spec
from palmbots.studies.chunk_task import ChunkTask, ResultsHash, build_id, checksum
from palmbots.studies.chunking import Chunk
from palmbots.studies.exact_sums import WIDTH, ExactSums
from palmbots.studies.points import Points
from palmbots.studies.statistics import Values, pooled_counts, statistics_of
from palmbots.studies.stopping import is_precise_enough
from palmbots.studies.store import Store

_CACHED_SPECS = 4096


@dataclass
class _Row:
    active: NDArray[np.bool_]
    """[points, controllers]: the cells that are carried in the present block of seeds."""
    block: int = 0
    open_chunks: set[int] = field(default_factory=set)
    """Chunks of this block that are not recorded yet."""


class StudySchedule:
    """The state of a study while it runs."""

    def __init__(self, store: Store, order: Callable[[Iterable[int]], Iterable[int]] = list):
        """Continue from the marks in the store. `order` may permute the chunks: no result depends
        on it."""
        self.store = store
        self.points: Points = store.points
        self._study = store.points.plan.study
        layout = store.layout
        self._cells = (len(self.points.values), layout.controllers)
        self.sums: ExactSums = np.zeros((*self._cells, WIDTH), np.int64)
        self._specs: dict[int, bytes] = {}
        self._makers = {c.name: c.maker for c in self.points.plan.controllers if c.maker}
        self._policies = {
            c.name: c for c in self.points.plan.controllers if not (c.is_compiled or c.is_python)
        }
        self._rows: dict[int, _Row] = {}
        self._queue: deque[int] = deque()
        self.recorded: dict[int, str | None] = {}
        """Recorded chunks, with the checksum in their mark (None: just written)."""
        self.completed = 0
        """Carries in the recorded chunks."""
        self.resumed = 0
        """Those of them that an earlier run had completed."""
        allowed = self.points.allowed_cells()
        first_chunks: list[int] = []
        for row in range(layout.rows):
            chunk = layout.chunk(row * layout.columns)
            self._rows[row] = _Row(allowed[chunk.points])
            first_chunks += self._begin_block(row)
        # The first seeds of every row come first: a study that is stopped has results of all rows.
        first_chunks.sort(key=lambda number: (number % layout.columns, number // layout.columns))
        self._queue.extend(order(first_chunks))

    @property
    def expected(self) -> int:
        """The completed carries, and at most how many the continuing cells still need."""
        if self._study.stop is None:
            return self.points.max_carries
        layout, remaining = self.store.layout, 0
        for row in self._rows.values():
            remaining += int(row.active.sum()) * max(layout.seeds - row.block * self._block_size, 0)
        return max(remaining, self.completed)

    @property
    def _block_size(self) -> int:
        seeds = self.store.layout.seeds
        return min(self._study.stop.block, seeds) if self._study.stop else seeds

    def _begin_block(self, number: int) -> list[int]:
        """The chunks of the present block of a row; none if all of its cells have stopped."""
        layout, row = self.store.layout, self._rows[number]
        start = row.block * self._block_size
        stop = min(start + self._block_size, layout.seeds)
        if start >= layout.seeds or not row.active.any():
            row.active = np.zeros_like(row.active)
            return []
        first, last = start // layout.seeds_a_chunk, -(-stop // layout.seeds_a_chunk)
        row.open_chunks = {number * layout.columns + column for column in range(first, last)}
        return sorted(row.open_chunks)

    def next(self) -> tuple[Chunk, ChunkTask] | None:
        """A chunk to carry, and its task.

        None: no chunk is ready now; once every chunk that was handed out is recorded, none is left.
        """
        while self._queue:
            chunk = self.store.layout.chunk(self._queue.popleft())
            mark = self.store.mark(chunk.number, (len(chunk.points), self._cells[1]))
            if mark is None:
                return chunk, self._task(chunk)
            sums, digest = mark
            before = self.completed
            self.record(chunk, sums, digest)
            self.resumed += self.completed - before
        return None

    def record(self, chunk: Chunk, sums: ExactSums, digest: str | None = None) -> None:
        """Add the sums of a chunk."""
        self.sums[chunk.points] += sums
        self.completed += pooled_counts(sums)[0]
        self.recorded[chunk.number] = digest
        row = self._rows[chunk.row]
        row.open_chunks.discard(chunk.number)
        if row.open_chunks:
            return
        row.block += 1
        if self._study.stop is not None:
            row.active &= ~is_precise_enough(self.sums[chunk.points], self._study.stop)
        self._queue.extend(self._begin_block(chunk.row))

    def _task(self, chunk: Chunk) -> ChunkTask:
        scenes = [self.points.scene(int(point)) for point in chunk.points] if self._makers else []
        return ChunkTask(
            build=build_id(),
            table=b"".join(self._spec(int(point)) for point in chunk.points),
            points=len(chunk.points),
            controllers=self.points.plan.controller_names,
            active=self._rows[chunk.row].active.copy(),
            first_seed=self._study.seeds.first + chunk.seeds.start,
            seeds=chunk.seeds.stop - chunk.seeds.start,
            precision=self._study.precision,
            makers=self._makers,
            policies=self._policies,
            scenes=tuple(scenes),
        )

    def _spec(self, point: int) -> bytes:
        if point not in self._specs:
            if len(self._specs) >= _CACHED_SPECS:
                self._specs.pop(next(iter(self._specs)))
            self._specs[point] = to_spec(self.points.scene(point)).to_bytes()
        return self._specs[point]

    def verify(self, on_progress: Callable[[float], None] = lambda _: None) -> str | None:
        """Read all results back, and compute their hash.

        None if the results of a chunk do not have the checksum of its mark. That mark is removed,
        so a new `StudySchedule` carries the chunk again.
        """
        layout, is_sound = self.store.layout, True
        results_hash = ResultsHash(self.points.identity)
        for row in range(layout.rows):
            for column in range(layout.columns):
                chunk = layout.chunk(row * layout.columns + column)
                if chunk.number not in self.recorded:
                    continue
                block = self.store.read(chunk)
                digest = self.recorded[chunk.number] or self._marked_digest(chunk)
                if block is None or checksum(block) != digest:
                    self.store.remove_mark(chunk.number)
                    is_sound = False
                    continue
                results_hash.add(block)
            results_hash.end_row()
            on_progress((row + 1) / layout.rows)
        return results_hash.hexdigest() if is_sound else None

    def _marked_digest(self, chunk: Chunk) -> str | None:
        mark = self.store.mark(chunk.number, (len(chunk.points), self._cells[1]))
        return mark[1] if mark else None

    def finish(self, results_hash: str) -> Values:
        """Write the statistics, and state which chunks were left out."""
        layout = self.store.layout
        for number in range(layout.chunks):
            if number not in self.recorded:
                self.store.leave_out(layout.chunk(number))
        values = statistics_of(self.sums)
        self.store.finish(values, {"carries": self.completed, "hash": results_hash})
        return values

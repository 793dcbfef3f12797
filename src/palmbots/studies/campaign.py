"""What is due: the chunks of a study in order, what they have added up to, and which cells go on.

Every block of points is a row. A row's cells are carried block of seeds by block of seeds (one
block, where the study does not stop early); when all chunks of a block are in, the cells that are
precise enough rest and the others go on. Chunks may come back in any order.
"""

import hashlib
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palmbots.lowering import lower
from palmbots.studies.design import Points
from palmbots.studies.layout import Chunk
from palmbots.studies.statistics import pooled_rate, statistics_of
from palmbots.studies.stopping import precise_enough
from palmbots.studies.store import Store
from palmbots.studies.tally import WIDTH, Tally
from palmbots.studies.work import VARIABLES, Block, Work, build, checksum

__all__ = ["Campaign"]

_KEPT_SPECS = 4096


@dataclass
class _Row:
    active: NDArray[np.bool_]
    """[points, controllers]: who is carried in the present block of seeds."""
    block: int = 0
    out: set[int] = field(default_factory=set)
    """Chunks of this block that are not in."""


class Campaign:
    """The state of a study while it is carried."""

    def __init__(self, store: Store, order: Callable[[Iterable[int]], Iterable[int]] = list):
        """Take up what the store has kept. `order` may shuffle chunks: no result depends on it."""
        self.store = store
        self.points: Points = store.points
        self._study = store.points.plan.study
        cut = store.layout
        self._cells = (len(self.points.values), cut.controllers)
        self.tally: Tally = np.zeros((*self._cells, WIDTH), np.int64)
        self._specs: dict[int, bytes] = {}
        self._rows: dict[int, _Row] = {}
        self._queue: deque[int] = deque()
        self.recorded: dict[int, str | None] = {}
        """Chunks that are in, with the checksum that their mark gives (None: written just now)."""
        self.done = 0
        """Carries that are in."""
        self.resumed = 0
        """Of these, carries that had been kept before."""
        allowed = self._allowed()
        starts: list[int] = []
        for row in range(cut.rows):
            chunk = cut.chunk(row * cut.columns)
            self._rows[row] = _Row(allowed[chunk.points])
            starts += self._begin(row)
        # The first seeds of every row first: whoever stops early has seen a little of everything.
        starts.sort(key=lambda number: (number % cut.columns, number // cut.columns))
        self._queue.extend(order(starts))

    def _allowed(self) -> NDArray[np.bool_]:
        allowed = np.ones(self._cells, bool)
        if "resilient" in self._study.controllers:
            allowed[list(self.points.refused), self._study.controllers.index("resilient")] = False
        return allowed

    @property
    def most(self) -> int:
        """Carries if no cell stops early."""
        return int(self._allowed().sum()) * self.store.layout.seeds

    @property
    def due(self) -> int:
        """Carries that are in, and those that cells which go on may still need at most."""
        if self._study.stop is None:
            return self.most
        cut, block, left = self.store.layout, self._block_size, 0
        for row in self._rows.values():
            left += int(row.active.sum()) * max(cut.seeds - row.block * block, 0)
        return max(left, self.done)

    @property
    def _block_size(self) -> int:
        seeds = self.store.layout.seeds
        return min(self._study.stop.block, seeds) if self._study.stop else seeds

    def _begin(self, number: int) -> list[int]:
        """The chunks of a row's present block; none where all of its cells rest."""
        cut, row = self.store.layout, self._rows[number]
        start = row.block * self._block_size
        stop = min(start + self._block_size, cut.seeds)
        if start >= cut.seeds or not row.active.any():
            row.active = np.zeros_like(row.active)
            return []
        first, last = start // cut.seeds_a_chunk, -(-stop // cut.seeds_a_chunk)
        row.out = {number * cut.columns + column for column in range(first, last)}
        return sorted(row.out)

    def next(self) -> tuple[Chunk, Work] | None:
        """A chunk to carry, and what it takes. None: none is ready now, and once all chunks that
        were given out are recorded, none is left."""
        while self._queue:
            chunk = self.store.layout.chunk(self._queue.popleft())
            kept = self.store.kept(chunk.number, (len(chunk.points), self._cells[1]))
            if kept is None:
                return chunk, self._work(chunk)
            tally, told = kept
            before = self.done
            self.record(chunk, tally, told)
            self.resumed += self.done - before
        return None

    def record(self, chunk: Chunk, tally: Tally, told: str | None = None) -> None:
        """Add what a chunk has come to."""
        self.tally[chunk.points] += tally
        self.done += pooled_rate(tally)[0]
        self.recorded[chunk.number] = told
        row = self._rows[chunk.row]
        row.out.discard(chunk.number)
        if row.out:
            return
        row.block += 1
        if self._study.stop is not None:
            row.active &= ~precise_enough(self.tally[chunk.points], self._study.stop)
        self._queue.extend(self._begin(chunk.row))

    def _work(self, chunk: Chunk) -> Work:
        return Work(
            build=build(),
            table=b"".join(self._spec(int(point)) for point in chunk.points),
            points=len(chunk.points),
            controllers=self._study.controllers,
            active=self._rows[chunk.row].active.copy(),
            first_seed=self._study.seeds.first + chunk.seeds.start,
            seeds=chunk.seeds.stop - chunk.seeds.start,
            precision=self._study.precision,
        )

    def _spec(self, point: int) -> bytes:
        if point not in self._specs:
            if len(self._specs) >= _KEPT_SPECS:
                self._specs.pop(next(iter(self._specs)))
            self._specs[point] = lower(self.points.scene(point)).to_bytes()
        return self._specs[point]

    def verify(self, report: Callable[[float], None] = lambda _: None) -> str | None:
        """Read everything back: the hash of all results, the same however they were carried.

        None where the results of a chunk are not those that its mark tells of: the mark is taken
        away, and a new `Campaign` carries that chunk again.
        """
        cut, sound = self.store.layout, True
        total = hashlib.blake2b(self.points.identity.encode(), digest_size=8)
        for row in range(cut.rows):
            digests = None
            for column in range(cut.columns):
                chunk = cut.chunk(row * cut.columns + column)
                if chunk.number not in self.recorded:
                    continue
                block = self.store.read(chunk)
                told = self.recorded[chunk.number] or self._told(chunk)
                if block is None or checksum(block) != told:
                    self.store.forget(chunk.number)
                    sound = False
                    continue
                digests = digests or [hashlib.blake2b(digest_size=16) for _ in self._each(chunk)]
                _update(digests, block)
            for digest in digests or []:
                total.update(digest.digest())
            report((row + 1) / cut.rows)
        return total.hexdigest() if sound else None

    def _each(self, chunk: Chunk) -> range:
        return range(len(chunk.points) * self._cells[1])

    def _told(self, chunk: Chunk) -> str | None:
        kept = self.store.kept(chunk.number, (len(chunk.points), self._cells[1]))
        return kept[1] if kept else None

    def statistics(self) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64] | None]]:
        """The statistics of the cells [points, controllers] so far."""
        return statistics_of(self.tally)


def _update(digests: list["hashlib.blake2b"], block: Block) -> None:
    """Feed every cell's carries to its digest, one record a carry, those that were not carried left
    out: that they stand in an array is a matter of the cut."""
    parts = []
    for name in VARIABLES:
        column = np.ascontiguousarray(block[name])
        shape = column.shape[:3]
        parts.append(column.view(np.uint8).reshape(*shape, -1))
    records = np.concatenate(parts, axis=-1)
    counts = np.count_nonzero(block["outcome"], axis=2).reshape(-1)
    cells = records.reshape(len(digests), *records.shape[2:])
    for digest, cell, n in zip(digests, cells, counts, strict=True):
        digest.update(np.ascontiguousarray(cell[:n]).data)

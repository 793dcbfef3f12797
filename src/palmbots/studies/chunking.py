# SPDX-License-Identifier: Apache-2.0
"""How a study is divided into chunks: blocks of points × all controllers × blocks of seeds.

Points keep the shape of the design. A block of points spans whole trailing dimensions, so a chunk
is exactly one chunk of every array in the store. With sequential stopping a chunk never extends
beyond the end of a block of seeds. No result depends on the division.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

_MIN_CARRIES, _MAX_CARRIES, _CHUNKS = 8192, 32_768, 64


@dataclass(frozen=True)
class Chunk:
    """One block of carries."""

    number: int
    region: tuple[slice, ...]
    """In the dimensions of the points."""
    points: NDArray[np.intp]
    """The same points by number."""
    seeds: slice
    """Relative to the first seed of the study."""
    column: int
    """Its place among the blocks of seeds."""
    row: int
    """Its place among the blocks of points."""


@dataclass(frozen=True)
class ChunkGrid:
    """The chunks of a study. They are numbered row by row, with the seeds fastest."""

    shape: tuple[int, ...]
    """Of the points."""
    block: tuple[int, ...]
    """Of the points of one chunk."""
    controllers: int
    seeds: int
    seeds_a_chunk: int

    @cached_property
    def columns(self) -> int:
        """Number of blocks of seeds."""
        return -(-self.seeds // self.seeds_a_chunk)

    @cached_property
    def rows(self) -> int:
        """Number of blocks of points."""
        return math.prod(self._blocks)

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return self.rows * self.columns

    @property
    def carries_a_chunk(self) -> int:
        """Number of carries in the largest chunk."""
        return math.prod(self.block) * self.controllers * self.seeds_a_chunk

    @cached_property
    def _blocks(self) -> tuple[int, ...]:
        return tuple(-(-n // b) for n, b in zip(self.shape, self.block, strict=True))

    def chunk(self, number: int) -> Chunk:
        """The chunk with that number."""
        row, column = divmod(number, self.columns)
        places = np.unravel_index(row, self._blocks)
        region = tuple(
            slice(int(at) * b, min((int(at) + 1) * b, n))
            for at, b, n in zip(places, self.block, self.shape, strict=True)
        )
        axes = [np.arange(part.start, part.stop) for part in region]
        points = np.ravel_multi_index(np.meshgrid(*axes, indexing="ij"), self.shape).reshape(-1)
        first = column * self.seeds_a_chunk
        seeds = slice(first, min(first + self.seeds_a_chunk, self.seeds))
        return Chunk(number, region, points, seeds, column, row)


def make_layout(
    shape: tuple[int, ...],
    controllers: int,
    seeds: int,
    stop_block: int | None = None,
    carries_a_chunk: int | None = None,
) -> ChunkGrid:
    """A division into chunks of about `carries_a_chunk`; by default 64 of 8192 to 32 768 each."""
    total = math.prod(shape) * controllers * seeds
    target = carries_a_chunk or min(max(total // _CHUNKS, _MIN_CARRIES), _MAX_CARRIES)
    per_controller = max(target // controllers, 1)
    span = min(seeds, stop_block or seeds)
    length = -(-span // -(-span // per_controller))
    if stop_block is not None and stop_block < seeds:
        length = _divisor(span, per_controller)
    points, block = max(per_controller // length, 1), []
    for size in reversed(shape):
        block.append(min(size, points))
        points = max(points // size, 1) if block[-1] == size else 1
    return ChunkGrid(shape, tuple(reversed(block)), controllers, seeds, length)


def _divisor(n: int, limit: int) -> int:
    """A length that divides n, so that chunks end where blocks of seeds end.

    It is the largest divisor within the limit, or the next larger one if that is less than an
    eighth of the limit: very small chunks cost time.
    """
    divisors = [d for k in range(1, math.isqrt(n) + 1) if n % k == 0 for d in (k, n // k)]
    fitting = max(d for d in divisors if d <= limit)
    return fitting if 8 * fitting >= min(limit, n) else min(d for d in divisors if d > limit)

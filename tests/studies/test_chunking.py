# SPDX-License-Identifier: Apache-2.0
"""The chunks of a study: they cover every carry once, and their default sizes."""

import numpy as np
import pytest

from palmbots.studies.chunking import make_layout


@pytest.mark.parametrize("shape", [(1,), (7,), (3, 5), (4, 3, 5)])
@pytest.mark.parametrize("seeds", [1, 10, 97])
@pytest.mark.parametrize("stop", [None, 5, 30])
@pytest.mark.parametrize("chunk", [1, 8, 100, 10**6])
def test_chunks_cover_every_carry_once(
    shape: tuple[int, ...], seeds: int, stop: int | None, chunk: int
) -> None:
    layout = make_layout(shape, 2, seeds, stop, chunk)
    seen = np.zeros((int(np.prod(shape)), seeds), int)
    assert sorted(layout.in_order()) == list(range(layout.chunks))
    for number in range(layout.chunks):
        one = layout.chunk(number)
        assert one.number == one.row * layout.columns + one.column
        seen[one.points, one.seeds] += 1
        region = np.zeros(shape, int)
        region[one.region] = 1
        assert (np.nonzero(region.reshape(-1))[0] == one.points).all()
        if stop is not None and stop < seeds:
            assert one.seeds.start // stop == (one.seeds.stop - 1) // stop
    assert (seen == 1).all()
    if stop is None:
        assert layout.carries_a_chunk <= max(chunk, 2)


@pytest.mark.parametrize("points_", [4, 100])
def test_default_chunk_sizes(points_: int) -> None:
    """64 parts of a study, about, of at most 32 768 carries; and one part of what is small."""
    for seeds, parts, most in ((10, 1, 8192), (400_000 // points_, 64, 12_500), (10**6, 0, 32_768)):
        layout = make_layout((points_,), 2, seeds)
        carries = points_ * 2 * seeds
        assert layout.carries_a_chunk <= most
        assert layout.chunks <= 2 * (parts or carries / most)

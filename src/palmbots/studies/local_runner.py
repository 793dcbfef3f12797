# SPDX-License-Identifier: Apache-2.0
"""Run a study on this machine: all threads carry one chunk while the previous one is written."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from palmbots.studies.chunk_task import Block, carry_chunk
from palmbots.studies.chunking import Chunk
from palmbots.studies.exact_sums import ExactSums, exact_sums_of
from palmbots.studies.schedule import StudySchedule


def run_locally(
    schedule: StudySchedule, threads: int, on_progress: Callable[[int, int], None]
) -> None:
    """Carry all chunks that are due.

    Args:
        schedule: the study; results do not depend on anything else.
        threads: number of threads.
        on_progress: called with the completed and the expected number of carries.

    Raises:
        PalmbotsError: the store cannot be written. Chunks that were written are kept.
        KeyboardInterrupt: Ctrl-C; likewise.
    """
    pending: tuple[Chunk, Future[ExactSums]] | None = None

    def write(chunk: Chunk, block: Block) -> ExactSums:
        sums = exact_sums_of(block)
        schedule.store.write(chunk, block, sums)
        return sums

    # Memory holds two chunks: the one being carried and the one being written.
    with ThreadPoolExecutor(1) as writer:
        while True:
            given = schedule.next()
            if given is None and pending is None:
                break
            block = None
            if given is not None:
                expected, before = max(schedule.expected, 1), schedule.completed
                on_progress(min(before, expected), expected)
                block = carry_chunk(
                    given[1],
                    threads,
                    lambda n, b=before, e=expected: on_progress(min(b + n, e), e),
                )
            if pending is not None:
                schedule.record(pending[0], pending[1].result())
                pending = None
            if given is not None and block is not None:
                pending = given[0], writer.submit(write, given[0], block)
    on_progress(schedule.completed, schedule.completed)

"""Carry a study on this machine: all cores on one chunk, while the one before is written."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from palmbots.studies.campaign import Campaign
from palmbots.studies.layout import Chunk
from palmbots.studies.tally import Tally, tally_of
from palmbots.studies.work import Block, carry_chunk

__all__ = ["carry_locally"]


def carry_locally(campaign: Campaign, threads: int, report: Callable[[float], None]) -> None:
    """Carry what is due.

    Args:
        campaign: what is due; results do not depend on anything else.
        threads: how many carry side by side.
        report: called with the fraction that is done.

    Raises:
        PalmbotsError: the store cannot be written. What was written before is kept.
        KeyboardInterrupt: Ctrl-C; likewise.
    """
    pending: tuple[Chunk, Future[Tally]] | None = None

    def keep(chunk: Chunk, block: Block) -> Tally:
        tally = tally_of(block)
        campaign.store.write(chunk, block, tally)
        return tally

    # Memory holds two chunks: the one that is carried and the one that is written meanwhile.
    with ThreadPoolExecutor(1) as writer:
        while True:
            given = campaign.next()
            if given is None and pending is None:
                break
            block = None
            if given is not None:
                total, before = max(campaign.due, 1), campaign.done
                report(min(before / total, 1.0))
                block = carry_chunk(
                    given[1], threads, lambda n, b=before, t=total: report(min((b + n) / t, 1.0))
                )
            if pending is not None:
                campaign.record(pending[0], pending[1].result())
                pending = None
            if given is not None and block is not None:
                pending = given[0], writer.submit(keep, given[0], block)
    report(1.0)

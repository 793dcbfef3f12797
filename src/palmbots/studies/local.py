"""Carry a study on this machine: all cores on one chunk, while the one before is written."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from palmbots.studies.campaign import Campaign
from palmbots.studies.tally import tally_of
from palmbots.studies.work import carry_chunk

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
    pending: Future[None] | None = None
    # Memory holds two chunks: the one that is carried and the one that is written.
    with ThreadPoolExecutor(1) as writer:
        while (given := campaign.next()) is not None:
            chunk, work = given
            total, before = max(campaign.due, 1), campaign.done
            report(before / total)
            block = carry_chunk(
                work, threads, lambda n, b=before, t=total: report(min((b + n) / t, 1.0))
            )
            tally = tally_of(block)
            if pending is not None:
                pending.result()
            pending = writer.submit(campaign.store.write, chunk, block, tally)
            campaign.record(chunk, tally)
        if pending is not None:
            pending.result()
    report(1.0)

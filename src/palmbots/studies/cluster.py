"""Carry a study on many machines: chunks go to Dask's workers, results come back here to be kept.

A chunk is a pure function of what is sent with it, so that a worker may die, a chunk may be done
twice and answers may come in any order: the store has one writer, and the results the same bits.
Workers need the package in the same version, and no files.
"""

import contextlib
import dataclasses
import hashlib
import logging
import pickle
import signal
import zlib
from collections.abc import Callable, Iterator
from multiprocessing import resource_tracker
from typing import Any

from palmbots.errors import PalmbotsError, show
from palmbots.studies.campaign import Campaign
from palmbots.studies.layout import Chunk
from palmbots.studies.needs import needed
from palmbots.studies.tally import tally_of
from palmbots.studies.work import Block, Work, build, carry_chunk

__all__ = ["Cluster", "carry_packed", "reached"]

_CONNECT_S = 5
_PATIENCE_S = 30
_AHEAD = 2  # chunks given out for each thread of a worker, so that none waits for the next one


def carry_packed(work: Work) -> Block:
    """What a worker does: `carry_chunk`, with a table that is packed for the way."""
    return carry_chunk(dataclasses.replace(work, table=zlib.decompress(work.table)))


class Cluster:
    """A scheduler with workers that can carry."""

    def __init__(self, client: Any, scheduler: str | None) -> None:
        self._client, self._scheduler = client, scheduler

    def carry(self, campaign: Campaign, report: Callable[[float], None]) -> None:
        """Carry what is due.

        Raises:
            PalmbotsError: the scheduler was lost, or one chunk killed too many workers. Finished
                chunks are kept.
            KeyboardInterrupt: likewise.
        """
        distributed = needed("distributed", "cluster")
        client = self._client
        out: dict[Any, Chunk] = {}
        while True:
            with _while_there(distributed, self._scheduler):
                room = _AHEAD * max(sum(client.nthreads().values()), 1)
            while len(out) < room and (given := campaign.next()) is not None:
                chunk, work = given
                packed = dataclasses.replace(work, table=zlib.compress(work.table, 1))
                with _while_there(distributed, self._scheduler):
                    out[client.submit(carry_packed, packed, key=_name(packed))] = chunk
            if not out:
                break
            with _while_there(distributed, self._scheduler):
                done = distributed.wait(list(out), return_when="FIRST_COMPLETED").done
            for future in done:
                with _while_there(distributed, self._scheduler):
                    block = _result(future)
                chunk, tally = out.pop(future), tally_of(block)
                campaign.store.write(chunk, block, tally)
                campaign.record(chunk, tally)
            report(campaign.done / max(campaign.due, 1))
        report(1.0)


@contextlib.contextmanager
def reached(scheduler: str | None, workers: int | None) -> Iterator[Cluster]:
    """The workers of a scheduler, or so many processes here.

    Raises:
        PalmbotsError: the scheduler cannot be reached, has no workers, or one of another version.
    """
    distributed = needed("distributed", "cluster")
    with _client(distributed, scheduler, workers) as client:
        with _while_there(distributed, scheduler):
            _greet(client, scheduler)
        yield Cluster(client, scheduler)


def _name(work: Work) -> str:
    """The same for equal work, so that nothing is carried twice; another one for any other."""
    told = hashlib.blake2b(pickle.dumps(work), digest_size=16)
    return f"palmbots-{told.hexdigest()}"


def _result(future: Any) -> Block:
    """What a worker gives. Raises `PalmbotsError` where it has failed."""
    distributed = needed("distributed", "cluster")
    try:
        return future.result()
    except (PalmbotsError, *_lost(distributed)):
        raise
    except distributed.KilledWorker:
        raise PalmbotsError(
            "study: a chunk killed several workers one after the other; what was finished is "
            "kept; allowed: a smaller --chunk in a new --out, or workers with more memory"
        ) from None
    except Exception as error:
        raise PalmbotsError(
            f"study: a worker failed: {type(error).__name__}: {error}; what was finished is kept"
        ) from None


def _lost(distributed: Any) -> tuple[type[Exception], ...]:
    """What is raised where the scheduler is gone."""
    return (
        distributed.CancelledError,
        distributed.comm.CommClosedError,
        distributed.client.FutureCancelledError,
    )


@contextlib.contextmanager
def _while_there(distributed: Any, scheduler: str | None) -> Iterator[None]:
    """Where the scheduler is asked and no file is written.

    Raises `PalmbotsError` if it is gone, which a new connection tells as an `OSError`.
    """
    try:
        yield
    except (*_lost(distributed), OSError):
        raise PalmbotsError(
            f"--scheduler {scheduler}: was lost; what was finished is kept: start it again and "
            "run the same command"
        ) from None


@contextlib.contextmanager
def _client(distributed: Any, scheduler: str | None, workers: int | None) -> Iterator[Any]:
    for name in ("distributed", "distributed.client", "distributed.nanny", "distributed.core"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # a worker's death is no news here
    with contextlib.ExitStack() as stack:
        target: Any = scheduler
        if scheduler is None:
            if not isinstance(workers, int) or not 1 <= workers <= 1024:
                raise PalmbotsError(f"--local-cluster: {show(workers)}; allowed: 1 to 1024")
            with _deaf():
                cluster = distributed.LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    dashboard_address=None,
                    silence_logs=logging.CRITICAL,
                )
            target = stack.enter_context(cluster)
        try:
            client = distributed.Client(target, timeout=_CONNECT_S)
        except (OSError, ValueError, ImportError) as error:
            raise PalmbotsError(
                f"--scheduler {scheduler}: cannot be reached: {error}; allowed: the address that "
                "`dask scheduler` prints, as in tcp://192.168.0.2:8786"
            ) from None
        yield stack.enter_context(client)


@contextlib.contextmanager
def _deaf() -> Iterator[None]:
    """Threads and processes that are begun here never hear Ctrl-C, and this thread afterwards.

    A terminal tells all processes of a command. Workers would each print where they were; a
    cluster that is half made could not be closed.
    """
    resource_tracker.ensure_running()  # to start it later would make the thread hear again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _greet(client: Any, scheduler: str | None) -> None:
    """Wait for a worker, and see that all have this version."""
    try:
        client.wait_for_workers(1, timeout=_PATIENCE_S)
    except TimeoutError:
        raise PalmbotsError(
            f"--scheduler {scheduler}: no worker came in {_PATIENCE_S} s; start one with: dask "
            f"worker {scheduler}"
        ) from None
    for address, told in client.run(build, on_error="return").items():
        if isinstance(told, Exception):
            raise PalmbotsError(
                f"study: the worker {address} cannot import palmbots ({told}); allowed: palmbots "
                f"{build()} on every machine"
            )
        if told != build():
            raise PalmbotsError(
                f"study: the worker {address} has palmbots {told}, here is {build()}; allowed: the "
                "same version on every machine"
            )

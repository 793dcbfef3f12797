# SPDX-License-Identifier: Apache-2.0
"""Run a study on many machines: Dask's workers carry chunks, and this process stores the results.

A chunk is a pure function of what is sent with it. A worker may die, a chunk may be carried twice,
and results may arrive in any order: the store has a single writer, and the results have the same
bits. Workers need the same version of the package, and no files.
"""

import ast
import contextlib
import hashlib
import logging
import signal
import sys
import zlib
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any

from palmbots._util.arguments import whole_number
from palmbots._util.optional_imports import require
from palmbots.errors import PalmbotsError
from palmbots.studies.chunk_task import Block, ChunkTask, build_id, carry_chunk, check_build
from palmbots.studies.chunking import Chunk
from palmbots.studies.exact_sums import exact_sums_of
from palmbots.studies.schedule import StudySchedule

_CONNECT_S = 5
_WAIT_FOR_WORKERS_S = 30
_AHEAD = 2  # chunks handed out per thread of a worker, so that no thread waits for the next one


class Cluster:
    """A scheduler with workers that can carry."""

    def __init__(
        self,
        client: Any,
        scheduler: str | None,
        notify: Callable[[str], None] = lambda _line: None,
    ) -> None:
        """`notify` is called with a line about each worker that was lost."""
        self._client, self._scheduler, self._notify = client, scheduler, notify
        self.lost_workers: tuple[str, ...] = ()
        """Addresses of the workers that died during `run`."""

    def run(self, schedule: StudySchedule, on_progress: Callable[[int, int], None]) -> None:
        """Carry all chunks that are due.

        Args:
            schedule: the study.
            on_progress: called with the completed and the expected number of carries.

        Raises:
            PalmbotsError: the scheduler was lost, a worker failed, or one chunk killed too many
                workers. Completed chunks are kept.
            KeyboardInterrupt: Ctrl-C; likewise.
        """
        distributed = require("distributed", "cluster")
        client = self._client
        running: dict[Any, Chunk] = {}
        with self._connected():
            begin = max((stamp for stamp, _ in client.get_events("all")), default=0.0)
        while True:
            with self._connected():
                limit = _AHEAD * max(sum(client.nthreads().values()), 1)
            while len(running) < limit and (given := schedule.next()) is not None:
                chunk, task = given
                packed = _packed(task)
                with self._connected():
                    future = client.submit(carry_packed, task.build, packed, key=_key(packed))
                running[future] = chunk
            if not running:
                break
            with self._connected():
                ready = distributed.wait(list(running), return_when="FIRST_COMPLETED").done
            self._note_lost_workers(begin)
            for future in ready:
                block = self._result(future)
                chunk, sums = running.pop(future), exact_sums_of(block)
                schedule.store.write(chunk, block, sums)
                schedule.record(chunk, sums)
            on_progress(schedule.completed, max(schedule.expected, 1))
        self._note_lost_workers(begin)
        on_progress(schedule.completed, schedule.completed)

    def _note_lost_workers(self, begin: float) -> None:
        with self._connected():
            events = self._client.get_events("all")
        for stamp, event in events:
            if stamp <= begin or not isinstance(event, Mapping):
                continue
            if event.get("action") != "remove-worker" or event.get("expected"):
                continue
            if event["worker"] not in self.lost_workers:
                self.lost_workers += (event["worker"],)
                self._notify(f"the worker {event['worker']} was lost; others carry its chunks")

    def _result(self, future: Any) -> Block:
        """The result of a chunk."""
        distributed = require("distributed", "cluster")
        try:
            with self._connected():
                return future.result()
        except PalmbotsError:
            raise
        except distributed.KilledWorker:
            raise PalmbotsError(
                f"study: one chunk killed several workers ({', '.join(self.lost_workers)}); "
                "completed chunks are kept; use a smaller chunk size in another folder, or workers "
                "with more memory"
            ) from None
        except Exception as error:  # a worker may raise anything
            raise PalmbotsError(
                f"study: a worker failed: {type(error).__name__}: {error}; completed chunks are "
                "kept"
            ) from None

    @contextlib.contextmanager
    def _connected(self) -> Iterator[None]:
        """A conversation with the scheduler, in which no file is written.

        Raises:
            PalmbotsError: the scheduler was lost. A new connection reports that as an `OSError`.
        """
        distributed = require("distributed", "cluster")
        lost = (
            distributed.CancelledError,
            distributed.comm.CommClosedError,
            distributed.client.FutureCancelledError,
            OSError,
        )
        try:
            yield
        except lost:
            raise PalmbotsError(
                f"scheduler {self._scheduler}: the connection was lost; completed chunks are kept: "
                "start the scheduler again and run the same command"
            ) from None


def carry_packed(build: str, packed: bytes) -> Block:
    """What a worker runs: `carry_chunk` with a packed task."""
    check_build(build)  # first: a task of another version may not even unpack
    cloudpickle = require("cloudpickle", "cluster")
    return carry_chunk(cloudpickle.loads(zlib.decompress(packed)))


def _packed(task: ChunkTask) -> bytes:
    return zlib.compress(require("cloudpickle", "cluster").dumps(task), 1)


def _key(packed: bytes) -> str:
    """Name of a task: the same for equal tasks, so that none runs twice."""
    return f"palmbots-{hashlib.blake2b(packed, digest_size=16).hexdigest()}"


@contextlib.contextmanager
def connect(
    scheduler: str | None,
    workers: int | None,
    makers: Mapping[str, Callable[[], Any]],
    notify: Callable[[str], None] = lambda _line: None,
) -> Iterator[Cluster]:
    """The workers of a scheduler, or local worker processes.

    Args:
        scheduler: its address.
        workers: number of local processes, if there is no scheduler.
        makers: the controllers in Python, by name.
        notify: called with a line about each worker that was lost.

    Raises:
        PalmbotsError: the scheduler cannot be reached or has no workers, a worker has another
            version, or a controller in Python cannot be sent to the workers.
    """
    packed = {name: _packed_maker(name, maker) for name, maker in makers.items()}
    with _client(scheduler, workers) as client:
        cluster = Cluster(client, scheduler, notify)
        with cluster._connected():
            _check_workers(client, scheduler, packed)
        yield cluster


def _packed_maker(name: str, maker: Callable[[], Any]) -> bytes:
    """A controller in Python as bytes. A module that workers cannot import travels with it."""
    cloudpickle = require("cloudpickle", "cluster")
    module = sys.modules.get(getattr(maker, "__module__", None) or "")
    if module is not None and module.__name__ != "__main__" and not _can_be_imported(module):
        cloudpickle.register_pickle_by_value(module)
    try:
        packed = cloudpickle.dumps(maker)
        cloudpickle.loads(packed)
    except Exception as error:  # pickle runs the code of the object, which may raise anything
        raise PalmbotsError(
            f"controller {name}: it cannot be sent to the workers of a cluster: {_brief(error)}; "
            "define it as a class in a module, or run the study without a cluster"
        ) from None
    return packed


def _can_be_imported(module: Any) -> bool:
    """Whether a module is found by its name, and not only because it is loaded here."""
    here = sys.modules.pop(module.__name__)
    try:
        return find_spec(module.__name__) is not None
    except (ImportError, ValueError):
        return False
    finally:
        sys.modules[module.__name__] = here


def _brief(error: BaseException) -> str:
    lines = str(error).strip().splitlines()
    return f"{type(error).__name__}: {lines[0]}" if lines else type(error).__name__


def load_controllers(packed: Mapping[str, bytes]) -> str | None:
    """What a worker runs before the study: unpack every controller in Python.

    Returns the problem in one line, or None.
    """
    cloudpickle = require("cloudpickle", "cluster")
    for name, data in packed.items():
        try:
            cloudpickle.loads(data)()
        except Exception as error:  # likewise
            return f"controller {name}: {_brief(error)}"
    return None


@contextlib.contextmanager
def _client(scheduler: str | None, workers: int | None) -> Iterator[Any]:
    distributed = require("distributed", "cluster")
    for name in ("distributed", "distributed.client", "distributed.nanny", "distributed.core"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # the result names lost workers
    with contextlib.ExitStack() as stack:
        target: Any = scheduler
        if scheduler is None:
            count = whole_number("local_cluster", workers, 1, 1024)
            _check_main_guard()
            # In a thread of its own, so that this thread can react to Ctrl-C at once.
            starter = stack.enter_context(ThreadPoolExecutor(1))
            with _without_ctrl_c():
                start = starter.submit(_start_cluster, count)
            stack.callback(lambda: start.result().close())
            target = start.result()
        try:
            client = distributed.Client(target, timeout=_CONNECT_S)
        except (OSError, ValueError, ImportError) as error:
            raise PalmbotsError(
                f"scheduler {scheduler}: cannot be reached: {error}; pass the address that "
                "`dask scheduler` prints, such as tcp://192.168.0.2:8786"
            ) from None
        stack.callback(_close, client)
        yield client


def _close(client: Any) -> None:
    """Close a client whose connection may be lost.

    Closing then fails if it meets an attempt to connect again that is just running out of time.
    That must not hide why the study ends.
    """
    with contextlib.suppress(Exception):
        client.close()


def _check_main_guard() -> None:
    """Refuse a script that each worker process would run from its beginning, this study included.

    Raises:
        PalmbotsError: the script does not call the study below its guard, or is read from stdin.
    """
    name = getattr(sys.modules.get("__main__"), "__file__", None)
    if name == "<stdin>":
        raise PalmbotsError(
            "local_cluster: its processes cannot import a script from stdin; allowed: a script in "
            "a file"
        )
    try:
        body = ast.parse(Path(name).read_bytes()).body if name is not None else []
    except (OSError, SyntaxError, ValueError):  # a program without source
        return
    guards = [s for s in body if isinstance(s, ast.If) and "__name__" in ast.unparse(s.test)]
    line = _line_of_script()
    if body and not any(
        line is None or guard.lineno <= line <= (guard.end_lineno or line) for guard in guards
    ):
        raise PalmbotsError(
            f"local_cluster: its processes import {Path(str(name)).name} again; in that script, "
            'call the study below the line: if __name__ == "__main__":'
        )


def _line_of_script() -> int | None:
    """The line of the script that is running; None: this thread did not begin there."""
    frame, script = sys._getframe(), vars(sys.modules["__main__"])
    while frame is not None:
        if frame.f_code.co_name == "<module>" and frame.f_globals is script:
            return frame.f_lineno
        frame = frame.f_back
    return None


def _start_cluster(workers: int) -> Any:
    """Local worker processes with a scheduler."""
    distributed = require("distributed", "cluster")
    return distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        silence_logs=logging.CRITICAL,
        # No dashboard; the web server of its metrics starts nevertheless. On the default port it
        # would disturb another cluster, and every machine of the network could read it.
        scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
    )


@contextlib.contextmanager
def _without_ctrl_c() -> Iterator[None]:
    """Threads and processes that begin here never receive Ctrl-C; this thread does afterwards.

    A terminal sends it to all processes of a command. Each worker would print a traceback, and a
    cluster that is half started could not be closed.
    """
    resource_tracker.ensure_running()  # if it started later, it would unblock the signal
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _check_workers(client: Any, scheduler: str | None, packed: Mapping[str, bytes]) -> None:
    """Wait for a worker, and check that all workers have this version and the controllers."""
    try:
        client.wait_for_workers(1, timeout=_WAIT_FOR_WORKERS_S)
    except TimeoutError:
        raise PalmbotsError(
            f"scheduler {scheduler}: there was no worker after {_WAIT_FOR_WORKERS_S} s; start one "
            f"with: dask worker {scheduler}"
        ) from None
    for address, build in client.run(build_id, on_error="return").items():
        if isinstance(build, Exception):
            raise PalmbotsError(
                f"study: the worker {address} cannot import palmbots ({build}); every machine "
                f"needs palmbots {build_id()}"
            )
        if build != build_id():
            raise PalmbotsError(
                f"study: the worker {address} has palmbots {build}, and this is {build_id()}; "
                "every machine needs the same version"
            )
    if not packed:
        return
    for address, problem in client.run(load_controllers, packed, on_error="return").items():
        if problem is not None:
            raise PalmbotsError(
                f"study: the worker {address} cannot load the {problem}; install its module there, "
                "or run the study without a cluster"
            )

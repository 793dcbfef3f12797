# SPDX-License-Identifier: Apache-2.0
"""Carries in processes of their own, for worlds and controllers that Python steps.

``python -m palmbots.simulation.carry_worker`` reads lines of JSON: first the job (scenes,
controller, world, precision), then one carry each. It answers the job with whether it can do it,
and each carry with the entries of `palmbots.simulation.batch.Columns`. The end of its input ends
it. Results depend on the job alone, not on how many processes share it, if any: the first carries
run in the calling process, and where little is left after them, so do all.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from typing import Any

from palmbots.control.registry import ControllerEntry
from palmbots.errors import PalmbotsError
from palmbots.simulation.batch import Columns, empty_columns, fill_row, row_of
from palmbots.simulation.prepare import Prepared

_TICK_S = 0.1  # how long Ctrl-C may have to wait
_WORTH_S = 3.0  # a process takes about a second to start, and this is worth sharing
_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONUNBUFFERED": "1"}


def run_apart(
    prepared: Sequence[Prepared],
    index: Sequence[int],
    seeds: Sequence[int],
    precision: str = "double",
    *,
    processes: int = 1,
    watch: Callable[[int], None] | None = None,
) -> Columns:
    """Run the carries of ``prepared[index[i]]`` with ``seeds[i]``, several at once.

    All have the same controller and world. A controller that another process cannot find by name,
    or a world that a program registered, runs here, one carry after the other.

    Raises:
        PalmbotsError: the controller failed, or a process was killed.
        KeyboardInterrupt: Ctrl-C, with the columns so far as its argument.
    """
    n = len(seeds)
    columns = empty_columns(n)
    report = watch or (lambda _: None)
    done = 0

    def here(keep_on: Callable[[], bool]) -> None:
        nonlocal done
        while done < n and keep_on():
            one = prepared[int(index[done])]
            fill_row(columns, done, _row(one, int(seeds[done]), precision))
            done += 1
            report(done)

    try:
        job = _job(prepared, precision) if processes > 1 and n > 1 else None
        if job is not None:
            ends = [time.monotonic()]

            def little_is_left() -> bool:
                ends.append(time.monotonic())
                # The first carry imports modules.
                return done < 2 or (ends[-1] - ends[-2]) * (n - done) < _WORTH_S

            with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
                here(little_is_left)  # what a controller prints vanishes, as in a worker
            with contextlib.ExitStack() as stack:
                workers = _started(stack, job, min(processes, n - done))
                if workers:
                    _share(workers, done, index, seeds, columns, report)
                    done = n
        here(lambda: True)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(columns) from None
    return columns


def _job(prepared: Sequence[Prepared], precision: str) -> str | None:
    """What a worker has to know; None: the controller cannot be found by name."""
    name = _name_of(prepared[0].controller)
    if name is None:
        return None
    scenes = [one.scene.model_dump(mode="json") for one in prepared]
    world = prepared[0].world.name
    return json.dumps(
        {"scenes": scenes, "controller": name, "world": world, "precision": precision}
    )


def _name_of(entry: ControllerEntry) -> str | None:
    if entry.source is None:
        return entry.name
    is_script = getattr(entry.maker, "__module__", "") == "__main__"  # which would run once more
    return None if is_script else entry.source.reference


def _row(prepared: Prepared, seed: int, precision: str) -> dict[str, Any]:
    return row_of(prepared.world.run(prepared, seed, precision=precision).measured)


class _Worker:
    """A process that carries."""

    def __init__(self, job: str) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", __name__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=_ONE_THREAD | os.environ,
            text=True,
        )
        self._send(job)

    def _send(self, line: str) -> None:
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.write(line + "\n")
            self._process.stdin.flush()

    def answer(self) -> Any:
        """The next answer; None: the process has ended."""
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        return json.loads(line) if line else None

    def carry(self, index: int, seed: int) -> Any:
        """Run one carry; None: the process has ended."""
        self._send(json.dumps([index, seed]))
        return self.answer()

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            assert stream is not None
            with contextlib.suppress(BrokenPipeError):
                stream.close()


def _started(stack: contextlib.ExitStack, job: str, count: int) -> list[_Worker]:
    """Workers that can do the job; empty: they cannot."""
    workers: list[_Worker] = []
    with contextlib.suppress(OSError):
        for _ in range(count):
            workers.append(_Worker(job))
            stack.callback(workers[-1].end)
    return [worker for worker in workers if worker.answer() is True]


def _share(
    workers: list[_Worker],
    first: int,
    index: Sequence[int],
    seeds: Sequence[int],
    columns: Columns,
    report: Callable[[int], None],
) -> None:
    todo: Iterator[int] = iter(range(first, len(seeds)))
    finished = first
    with ThreadPoolExecutor(len(workers)) as pool:
        running = {}

        def hand_out(worker: _Worker) -> None:
            i = next(todo, None)
            if i is not None:
                task = pool.submit(worker.carry, int(index[i]), int(seeds[i]))
                running[task] = worker, i

        for worker in workers:
            hand_out(worker)
        try:
            while running:
                ended = wait(running, _TICK_S, FIRST_COMPLETED)[0]
                for task in ended:
                    worker, i = running.pop(task)
                    row = task.result()
                    if not isinstance(row, dict):
                        raise PalmbotsError(row or "a process that carries has ended")
                    fill_row(columns, i, row)
                    finished += 1
                    hand_out(worker)
                    report(finished)
                if not ended:
                    report(finished)
        except BaseException:
            for worker in workers:
                worker.end()  # so that no thread waits for its answer
            raise


def _work() -> None:
    """The process."""
    from palmbots.control.registry import resolve
    from palmbots.scene.scene import load_scene
    from palmbots.simulation.prepare import prepare

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that started this one ends it
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what a controller prints is no answer

    def answer(value: Any) -> None:
        print(json.dumps(value), file=answers, flush=True)

    job = json.loads(sys.stdin.readline())
    try:
        entry = resolve(job["controller"], unproved=True)
        prepared = [prepare(load_scene(scene), entry, job["world"]) for scene in job["scenes"]]
    except Exception as error:
        answer(str(error))
        return
    answer(True)
    for line in sys.stdin:
        index, seed = json.loads(line)
        try:
            answer(_row(prepared[index], seed, job["precision"]))
        except PalmbotsError as error:
            answer(str(error))


if __name__ == "__main__":
    _work()

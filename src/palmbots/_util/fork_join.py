# SPDX-License-Identifier: Apache-2.0
"""Two jobs in parallel: the second one in a forked process if that is safe and a core is free.

For work that holds Python's interpreter lock, such as drawing. A forked process has all modules
imported already, so that a fork is worthwhile from a few tenths of a second.
"""

import contextlib
import multiprocessing
import os
import sys
import threading
import warnings
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any, TypeVar

_First = TypeVar("_First")
_Second = TypeVar("_Second")


def can_fork() -> bool:
    """Whether a fork is safe and useful.

    A fork copies locks but not the threads that hold them, so this process must have no other
    Python thread (a notebook has some). Only Linux is known to be safe.
    """
    if sys.platform != "linux" or threading.active_count() > 1:
        return False
    return len(os.sched_getaffinity(0)) > 1


def both(first: Callable[[], _First], second: Callable[[], _Second]) -> tuple[_First, _Second]:
    """Run two jobs and return both results.

    `second` may run in another process: its changes in memory are lost, it may write files, and its
    result must be picklable.

    Raises:
        BaseException: the error of a job; that of `first` if both fail. The other job has always
            ended by then, so that it writes nothing after the error.
    """
    if not can_fork():
        return first(), second()
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_work, args=(second, sender), daemon=True)
    with warnings.catch_warnings():
        # Python 3.12 warns of any thread; the threads of NumPy's BLAS are idle and support forks.
        warnings.simplefilter("ignore", DeprecationWarning)
        child.start()
    sender.close()  # so that the pipe ends when the child does
    try:
        result = first()
        try:
            succeeded, answer = receiver.recv()
        except EOFError:  # killed from outside
            return result, second()
    finally:
        receiver.close()
        child.join()
    if not succeeded:
        raise answer
    return result, answer


def _work(job: Callable[[], Any], sender: "Connection[Any, Any]") -> None:
    """Run the job in the child process and send its result or error; print nothing."""
    try:
        answer = True, job()
    except BaseException as error:
        answer = False, error
    with contextlib.suppress(OSError):  # the parent is gone
        sender.send(answer)

"""Two jobs at once: the second one in a forked process, where that is safe and there is a core.

For work that Python's threads cannot share because it holds the interpreter, such as drawing. A
fork starts with everything already imported, so it pays from a few tenths of a second on.
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

__all__ = ["both", "can_fork"]

_First = TypeVar("_First")
_Second = TypeVar("_Second")


def can_fork() -> bool:
    """Whether a fork is safe, and of use.

    A fork copies locks but not the threads that hold them, so there must be no other thread of
    Python's (a notebook has some). Other systems than Linux do not promise as much.
    """
    if sys.platform != "linux" or threading.active_count() > 1:
        return False
    return len(os.sched_getaffinity(0)) > 1


def both(first: Callable[[], _First], second: Callable[[], _Second]) -> tuple[_First, _Second]:
    """Do two jobs and return both results.

    What `second` changes in memory is lost where it runs in a process of its own: it may write
    files, and its result must be picklable.

    Raises:
        BaseException: whatever a job raises; what `first` raises if both do. The other job is
            always ended before, so that nothing goes on writing after the error.
    """
    if not can_fork():
        return first(), second()
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_work, args=(second, sender), daemon=True)
    with warnings.catch_warnings():
        # Python 3.12 warns of any thread; those of NumPy's BLAS are idle and made for forks.
        warnings.simplefilter("ignore", DeprecationWarning)
        child.start()
    sender.close()  # so that the pipe ends when the child does
    try:
        done = first()
        try:
            fine, result = receiver.recv()
        except EOFError:  # killed from outside
            return done, second()
    finally:
        receiver.close()
        child.join()
    if not fine:
        raise result
    return done, result


def _work(job: Callable[[], Any], sender: "Connection[Any, Any]") -> None:
    """What the child does: it says how the job went, and nothing on the terminal."""
    try:
        answer = True, job()
    except BaseException as error:
        answer = False, error
    with contextlib.suppress(OSError):  # the parent is gone
        sender.send(answer)

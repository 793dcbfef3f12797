# SPDX-License-Identifier: Apache-2.0
"""Waiting for what other processes do, and keeping them apart."""

import contextlib
import fcntl
import time
from collections.abc import Callable, Iterator
from pathlib import Path


def wait_until(predicate: Callable[[], object], timeout_s: float = 180.0) -> None:
    """Return as soon as the predicate holds; raise AssertionError if it does not in time.

    The time is long because it only matters to a test that fails: a busy machine is slow.
    """
    deadline, pause_s = time.monotonic() + timeout_s, 0.001
    while not predicate():
        assert time.monotonic() < deadline, f"not within {timeout_s:g} s"
        pause_s = min(2 * pause_s, 0.016)  # a long wait looks less often
        time.sleep(pause_s)


@contextlib.contextmanager
def locked(file: Path) -> Iterator[None]:
    """Hold the lock of this file, which is created, against all other processes."""
    with file.open("a") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        yield

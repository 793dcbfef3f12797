# SPDX-License-Identifier: Apache-2.0
"""The time of this process: the monotonic clock of the system, unless another program steps it."""

import time
from collections.abc import Callable

_source: Callable[[], float] = time.monotonic


def monotonic() -> float:
    """The time [s], from an arbitrary start; it never goes back and ignores the wall clock."""
    return _source()


def step_by(source: Callable[[], float]) -> None:
    """Take the time from `source` from now on."""
    global _source
    _source = source

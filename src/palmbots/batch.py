"""Many carries at once, without Python in the loop.

The compiled half exists for any processor, and for those of levels 3 and 4 of x86-64, which carry
twice and four times as many lanes; the bits of every result are the same, and the same as those of
the single carry (`palmbots.carry`) with that scene, seed and precision, for any number of threads.
"""

import importlib
import os
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palmbots import _core

__all__ = [
    "DELIVERED",
    "DROPPED",
    "STALLED",
    "Columns",
    "cores",
    "lane_modules",
    "run_many",
    "run_seeds",
    "run_table",
]

# Entries of the column `outcome`.
DELIVERED, DROPPED, STALLED = 1, 2, 3

Columns = dict[str, NDArray[Any]]
"""One entry a carry: finished, outcome, reason (an End of ends.hpp), time_s, distance_m,
corrections, messages, messages_lost; and with a column each for left and right: contact_rms_m,
contact_peak_m, waiting_s, waits_since_s."""


def cores() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))


def lane_modules() -> list[str]:
    """Names of the compiled halves that this processor can run, that with the most lanes first."""
    return [f"_lanes_v{level}" for level in (4, 3) if _core.has_level(level)] + ["_lanes"]


@cache
def _module() -> Any:
    return importlib.import_module(f"palmbots.{lane_modules()[0]}")


def run_many(
    specs: Sequence[_core.Spec],
    which: ArrayLike,
    seeds: ArrayLike,
    controller: str,
    precision: str = "double",
    *,
    threads: int = 1,
    watch: Callable[[int], None] | None = None,
) -> Columns:
    """Carry `specs[which[i]]` with `seeds[i]` for every i, and measure each.

    Args:
        specs: what scenes become (`palmbots.lowering.lower`).
        which: one index into `specs` a carry.
        seeds: one a carry.
        controller: ``none``, ``centralized``, ``distributed`` or ``resilient``.
        precision: ``double`` or ``float``.
        threads: how many carry side by side; results do not depend on it.
        watch: called now and then with the number of carries that are done.

    Raises:
        KeyboardInterrupt: Ctrl-C, with the columns so far as its argument; `finished` tells which
            rows are.
    """
    table = b"".join(spec.to_bytes() for spec in specs)
    return run_table(table, which, seeds, controller, precision, threads=threads, watch=watch)


def run_table(
    table: bytes,
    which: ArrayLike,
    seeds: ArrayLike,
    controller: str,
    precision: str = "double",
    *,
    threads: int = 1,
    watch: Callable[[int], None] | None = None,
) -> Columns:
    """As `run_many`, with the bytes of the specs one after the other (`Spec.to_bytes`)."""
    which = np.ascontiguousarray(which, np.uint32)
    seeds = np.ascontiguousarray(seeds, np.uint64)
    run = _module().run_many(table, which, seeds, controller, precision, threads, watch)
    interrupted = run.pop("interrupted")
    run["finished"] = run["finished"].astype(bool)
    if interrupted:
        raise KeyboardInterrupt(run)
    return run


def run_seeds(
    spec: _core.Spec,
    controller: str,
    first: int,
    n: int,
    precision: str = "double",
    *,
    threads: int = 1,
) -> Columns:
    """Carry one scene with seeds first … first + n − 1; as `run_many`."""
    seeds = np.arange(n, dtype=np.uint64) + np.uint64(first)
    return run_many([spec], np.zeros(n, np.uint32), seeds, controller, precision, threads=threads)

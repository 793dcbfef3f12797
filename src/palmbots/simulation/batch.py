# SPDX-License-Identifier: Apache-2.0
"""Many carries of specs and seeds, as columns of results.

The shipped controllers run in lanes, in a compiled module without Python in the loop. The module
exists for any x86-64 processor and for levels 3 and 4, which run two and four times as many lanes.
All of them give the same bits, and the same as single carries (`palmbots.carry`) with that scene,
seed and precision, for any number of threads. A Python controller, or a reference with full
information, runs one carry after the other. The controller of a policy file runs single carries on
several threads. So do all compiled controllers where no such module is built, as after `make carry`
alone.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import palmbots._core as _core
from palmbots.control.registry import ControllerEntry, ControllerLike, resolve
from palmbots.errors import PalmbotsError

OUTCOMES: tuple[str, ...] = _core.carry_outcomes
"""The outcomes in the order of the column `outcome`; 0: not carried."""
DELIVERED, DROPPED, STALLED = map(OUTCOMES.index, ("delivered", "dropped", "stalled"))
REASONS: tuple[str | None, ...] = (None, *_core.drop_reasons[1:])
"""The drop reasons in the order of the column `reason`; None: not dropped."""

Columns = dict[str, NDArray[Any]]
"""One entry per carry: finished, outcome, reason (an index of `REASONS`), time_s, distance_m,
corrections, messages, messages_lost; with one column each for left and right: contact_rms_m,
contact_peak_m, waiting_s, waits_since_s."""

Watch = Callable[[int], None]


def available_cores() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))


def batch_modules() -> list[str]:
    """Names of the compiled modules that this processor can run, the one with most lanes first."""
    return [f"_batch_v{level}" for level in (4, 3) if _core.supports_x86_level(level)] + ["_batch"]


@cache
def _module() -> Any | None:
    """The module that runs carries in lanes; None: none is built."""
    for name in batch_modules():  # `make quick` builds only the one for any processor
        with contextlib.suppress(ModuleNotFoundError):
            return importlib.import_module(f"palmbots.{name}")
    return None


def is_built() -> bool:
    """Whether there is a module that runs carries in lanes."""
    return _module() is not None


class SlowBuildWarning(UserWarning):
    """Many carries run one by one, because the modules that run them in lanes are not built."""


SLOW_BUILD = (
    "this build runs carries one by one; `make build`, once, makes statistics several times as fast"
)
FEW_SECONDS = 10_000
"""Carries of the default scene that take a few seconds one by one."""


def can_run_in_lanes(entry: ControllerEntry, specs: Sequence[_core.Spec]) -> bool:
    """Whether carries of these run side by side, if the modules are built.

    The lanes know only the two angles that a controller commands, and no floor.
    """
    return entry.runs_in_lanes and not any(spec.may_go_limp or spec.uses_floor for spec in specs)


def run_batch(
    specs: Sequence[_core.Spec] | bytes,
    spec_index: ArrayLike,
    seeds: ArrayLike,
    controller: ControllerLike,
    precision: str = "double",
    *,
    threads: int = 1,
    watch: Watch | None = None,
) -> Columns:
    """Run the carries of ``specs[spec_index[i]]`` with ``seeds[i]``, for every i.

    Args:
        specs: `palmbots.scene.spec.to_spec` makes them. Unless the controller is in Python, also
            the bytes of all of them, one after the other (`Spec.to_bytes`).
        spec_index: one index into `specs` per carry.
        seeds: one seed per carry.
        controller: as in `palmbots.carry`.
        precision: ``double`` or ``float``.
        threads: worker threads; results do not depend on it. Controllers in Python and references
            use one.
        watch: called now and then with the number of finished carries.

    Raises:
        KeyboardInterrupt: Ctrl-C, with the columns so far as its argument; `finished` marks the
            valid rows.

    Warns:
        SlowBuildWarning: no batch module is built, and more than a few seconds will pass.
    """
    entry = resolve(controller)
    index = np.ascontiguousarray(spec_index, np.uint32)
    seeds = np.ascontiguousarray(seeds, np.uint64)
    own = _core.Spec.list_from_bytes(specs) if isinstance(specs, bytes) else specs
    in_lanes, module = can_run_in_lanes(entry, own), _module()
    if not in_lanes or module is None:
        if isinstance(specs, bytes) and (entry.is_python or entry.is_reference):
            raise PalmbotsError(f"controller: {entry.name} needs specs, not bytes")
        if in_lanes:
            _say_if_slow(own, index)
        workers = 1 if entry.is_python or entry.is_reference else threads
        return run_singly(own, index, seeds, entry, precision, workers, watch)
    table = specs if isinstance(specs, bytes) else b"".join(spec.to_bytes() for spec in specs)
    run = module.run_many(table, index, seeds, entry.name, precision, threads, watch)
    interrupted = run.pop("interrupted")
    run["finished"] = run["finished"].astype(bool)
    if interrupted:
        raise KeyboardInterrupt(run)
    return run


_slow_ticks = 0.0


def _say_if_slow(specs: Sequence[_core.Spec], index: NDArray[np.uint32]) -> None:
    """Warn, once for all calls in this process, when their carries take more than a few seconds.

    The number of control periods decides, not the clock.
    """
    global _slow_ticks
    ticks = np.array([spec.timeout_ticks for spec in specs], np.float64)
    before, _slow_ticks = _slow_ticks, _slow_ticks + float(ticks[index].sum())
    if before <= FEW_SECONDS * _core.Spec().timeout_ticks < _slow_ticks:
        warnings.warn(SLOW_BUILD, SlowBuildWarning, stacklevel=3)


def run_seeds(
    spec: _core.Spec,
    controller: ControllerLike,
    first: int,
    n: int,
    precision: str = "double",
    *,
    threads: int = 1,
    watch: Watch | None = None,
) -> Columns:
    """Run one spec with seeds first … first + n − 1; otherwise as `run_batch`."""
    seeds = np.arange(n, dtype=np.uint64) + np.uint64(first)
    index = np.zeros(n, np.uint32)
    return run_batch([spec], index, seeds, controller, precision, threads=threads, watch=watch)


def run_singly(
    specs: Sequence[_core.Spec],
    index: NDArray[np.uint32],
    seeds: NDArray[np.uint64],
    controller: ControllerEntry,
    precision: str,
    threads: int,
    watch: Watch | None,
) -> Columns:
    """The same columns from single carries in the core, several at once unless in Python."""
    n = len(seeds)
    columns = empty_columns(n)

    def carry(i: int, core: Any) -> None:
        run: Any = _core.run(specs[int(index[i])], core, int(seeds[i]), precision, False)
        fill_row(columns, i, row_of(run))

    used = [] if controller.is_python else sorted(set(index.tolist()))
    cores = {i: controller.for_core(specs[i]) for i in used}

    def shared(i: int) -> None:
        carry(i, cores[int(index[i])])

    try:
        if controller.is_python:
            for i in range(n):
                if watch is not None:
                    watch(i)
                carry(i, controller.for_core(specs[int(index[i])]))
        else:
            _share(n, threads, shared, watch)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(columns) from None
    return columns


def empty_columns(n: int) -> Columns:
    """Columns of n carries, none of which is finished."""
    return {
        "finished": np.zeros(n, bool),
        "outcome": np.zeros(n, np.uint8),
        "reason": np.zeros(n, np.uint8),
        "time_s": np.zeros(n),
        "distance_m": np.zeros(n),
        "contact_rms_m": np.zeros((n, 2)),
        "contact_peak_m": np.zeros((n, 2)),
        "waiting_s": np.zeros((n, 2)),
        "waits_since_s": np.zeros((n, 2)),
        "corrections": np.zeros(n, np.uint32),
        "messages": np.zeros(n, np.uint32),
        "messages_lost": np.zeros(n, np.uint32),
    }


def row_of(run: Any) -> dict[str, Any]:
    """The entries of the columns for one carry that the core measured."""
    row = {
        name: getattr(run, name)
        for name in ("time_s", "distance_m", "contact_rms_m", "contact_peak_m", "waiting_s")
    }
    return row | {
        "outcome": OUTCOMES.index(run.outcome),
        "reason": REASONS.index(run.reason),
        "waits_since_s": run.waits_since_s,
        "corrections": run.correction_count,
        "messages": run.messages,
        "messages_lost": run.messages_lost,
    }


def fill_row(columns: Columns, i: int, row: Mapping[str, Any]) -> None:
    """Store a carry."""
    for name, value in row.items():
        columns[name][i] = value
    columns["finished"][i] = True


_BLOCK = 64  # carries that a thread takes at once; they last some milliseconds each


def _share(n: int, threads: int, carry: Callable[[int], None], watch: Watch | None) -> None:
    """Run carries 0 … n − 1 on several threads; each runs in the core, without the interpreter."""

    def block(first: int) -> int:
        last = min(first + _BLOCK, n)
        for i in range(first, last):
            carry(i)
        return last - first

    finished = 0
    with ThreadPoolExecutor(threads) as pool:
        waiting = {pool.submit(block, first) for first in range(0, n, _BLOCK)}
        try:
            while waiting:
                done, waiting = wait(waiting, _TICK_S, FIRST_COMPLETED)
                finished += sum(future.result() for future in done)
                if watch is not None:
                    watch(finished)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


_TICK_S = 0.1  # how long Ctrl-C may have to wait

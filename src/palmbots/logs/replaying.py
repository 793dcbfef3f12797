# SPDX-License-Identifier: Apache-2.0
"""Runs the carry of a log again and compares every bit.

The log of a Python controller contains the place and the hash of its source. The source is loaded
only if its hash is still the same.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from palmbots._types import SIDES
from palmbots._util.plain_values import NOT_IN_JSON, derived, keys_of
from palmbots._util.report import Item, Line, Table, verdict
from palmbots._util.results import Result
from palmbots._util.user_paths import user_path
from palmbots.control.registry import ControllerLike, recover, resolve
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.simulation.result import Carry
from palmbots.simulation.single import carry

if TYPE_CHECKING:
    import xarray as xr

    from palmbots.logs.mcap_reader import Log

_GIVEN = (
    "scene", "controller", "world", "precision", "seed", "forks", "controller_source", "version",
    "trace_hash",
)  # fmt: skip
_FOUND = tuple(name for name in (*keys_of(Carry), "message_log") if name not in _GIVEN)
"""What a carry finds out, besides its trace."""


@dataclass(frozen=True, repr=False)
class ReplayResult(Result):
    """The comparison of a log with a new run of its carry."""

    identical: bool
    """All samples, events and results and the trace hash are equal."""
    samples: int
    """Number of rows of the logged trace."""
    trace_hash: str
    """The trace hash of the new run."""
    logged_hash: str
    """The trace hash in the log."""
    difference: str | None
    """The first difference, in one line."""
    log: Log = field(metadata=NOT_IN_JSON)

    @derived
    def controller(self) -> str:
        """The controller of the logged carry."""
        return self.log.controller

    @derived
    def seed(self) -> int:
        """The seed of the logged carry."""
        return self.log.seed

    @derived
    def precision(self) -> str:
        """The precision of the logged carry."""
        return self.log.precision

    @derived
    def version(self) -> str:
        """The version that logged the carry."""
        return self.log.version

    @derived
    def scene(self) -> Scene:
        """The scene of the logged carry."""
        return self.log.scene

    def lines(self) -> Iterator[Item]:
        """Whether the carries are equal, and of what."""
        if self.identical:
            text = f"  {self.samples} samples agree bit for bit   trace {self.trace_hash}"
        else:
            text = f"  {self.difference}"
        yield Line(verdict(self.identical, "IDENTICAL", "DIFFERS"), text)
        yield Table(self.value_rows("controller", "seed", "precision", "version"))


def replay(
    path: str | os.PathLike[str], *, controller: ControllerLike | None = None
) -> ReplayResult:
    """Read a log, run its scene again with its controller and seed, and compare every bit.

    Args:
        path: the log.
        controller: the controller to run; None: the one of the log. A Python controller is found
            by the place of its source in the log, and the source must not have changed.

    Raises:
        PalmbotsError: the log cannot be read, its controller cannot be found or has changed, or
            the scene or the world is refused.
    """
    from palmbots.logs.mcap_reader import read_log  # here, because it takes long to import

    log = read_log(path)
    folder = os.path.dirname(user_path(path))
    try:
        entry = (
            recover(log.controller, log.controller_source, folder)
            if controller is None
            else resolve(controller)
        )
        again = carry(
            log.scene,
            controller=entry,
            world=log.world,
            precision=log.precision,
            seed=log.seed,
            forks=log.forks,
            record=True,
        )
    except PalmbotsError as error:
        raise PalmbotsError(f"{path}: cannot be run again: {error}") from None
    assert again.trace is not None
    difference = first_difference(log.trace, again.trace) or _other_difference(log, again)
    if difference is not None and _sha256(log) != _sha256(again):
        difference += " (the source of the controller is not that of the log)"
    if difference is not None and log.version != again.version:
        difference += f" (logged by version {log.version}, run again by {again.version})"
    return ReplayResult(
        identical=difference is None,
        samples=log.trace.sizes["time"],
        trace_hash=again.trace_hash,
        logged_hash=log.trace_hash,
        difference=difference,
        log=log,
    )


def _sha256(carry: Carry) -> str | None:
    source = carry.controller_source
    return None if source is None else source.sha256


def first_difference(logged: xr.Dataset, again: xr.Dataset) -> str | None:
    """The earliest sample whose bits differ between two traces, in one line, or None."""
    rows = min(logged.sizes["time"], again.sizes["time"])
    earliest: tuple[int, str, Any, Any] | None = None
    for name in ("time", *map(str, logged.data_vars)):
        one, other = ((t[name].transpose("time", ...).to_numpy()[:rows]) for t in (logged, again))
        differs = _bits(one) != _bits(other)
        if not differs.any():
            continue
        row, *side = np.argwhere(differs)[0].tolist()
        if earliest is None or row < earliest[0]:
            what = " ".join([name, *(SIDES[k] for k in side)])
            earliest = (row, what, one[row, *side].item(), other[row, *side].item())
    if earliest is not None:
        row, what, before, now = earliest
        when = float(logged["time"][row])
        return f"sample {row} (t = {when:g} s): {what} was {before!r}, is {now!r}"
    if logged.sizes["time"] != again.sizes["time"]:
        return f"the log has {logged.sizes['time']} samples, the new run {again.sizes['time']}"
    return None


def _bits(values: np.ndarray) -> np.ndarray:
    """Doubles as integers with the same bits: −0 differs from 0, and equal NaNs are equal."""
    return values.view(np.uint64) if values.dtype == np.float64 else values


def _other_difference(log: Log, again: Carry) -> str | None:
    for name in _FOUND:
        before, now = getattr(log, name), getattr(again, name)
        if before != now:
            if name in ("corrections", "contact_events", "message_log"):
                pairs = enumerate(zip(before, now, strict=False), start=1)
                first = next((k for k, (a, b) in pairs if a != b), min(len(before), len(now)) + 1)
                return f"{name}: number {first} differs"
            return f"{name} was {before!r}, is {now!r}"
    if log.trace_hash != again.trace_hash:
        return f"trace_hash was {log.trace_hash}, is {again.trace_hash}"
    return None

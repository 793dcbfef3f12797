"""Running a log again, to prove that scene and seed give the same carry to the last bit."""

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from palmbots.carry import carry
from palmbots.errors import PalmbotsError
from palmbots.geometry import SIDES
from palmbots.result import Carry

if TYPE_CHECKING:
    import xarray as xr

    from palmbots.log import Log

__all__ = ["Replay", "replay"]

_FACTS = (
    "outcome", "reason", "time_s", "distance_m", "contact_rms_m", "contact_peak_m", "messages",
    "messages_lost", "waiting_s", "bumps", "warnings", "corrections", "touches", "letters",
)  # fmt: skip


@dataclass(frozen=True)
class Replay:
    """What came of running a log again."""

    identical: bool  #: every sample, every event, every result and the trace hash are the same
    samples: int  #: how many rows of the trace the log holds
    trace_hash: str  #: of the new run
    logged_hash: str  #: as the log has it
    difference: str | None  #: the first thing that differs, in one line
    log: "Log"

    def summary(self) -> dict[str, Any]:
        """What ``palmbots replay --json`` prints."""
        return {
            "identical": self.identical,
            "samples": self.samples,
            "difference": self.difference,
            "trace_hash": self.trace_hash,
            "logged_hash": self.logged_hash,
            "controller": self.log.controller,
            "seed": self.log.seed,
            "precision": self.log.precision,
            "version": self.log.version,
            "scene": self.log.scene,
        }


def replay(path: str | os.PathLike[str]) -> Replay:
    """Read a log, run its scene again with its controller and seed, and compare every bit.

    Raises `PalmbotsError` for a log that cannot be read, or that cannot be run here (a controller
    that is no part of palmbots, or a scene this version refuses).
    """
    from palmbots.log import read_log  # its formats take long to import

    log = read_log(path)
    try:
        again = carry(
            log.scene,
            controller=log.controller,
            world=log.world,
            precision=log.precision,
            seed=log.seed,
            record=True,
        )
    except PalmbotsError as error:
        raise PalmbotsError(f"{path}: cannot be run again: {error}") from None
    assert again.trace is not None
    difference = first_difference(log.trace, again.trace) or _other_difference(log, again)
    if difference is not None and log.version != again.version:
        difference += f" (logged by version {log.version}, run again by {again.version})"
    return Replay(
        identical=difference is None,
        samples=log.trace.sizes["time"],
        trace_hash=again.trace_hash,
        logged_hash=log.trace_hash,
        difference=difference,
        log=log,
    )


def first_difference(logged: "xr.Dataset", again: "xr.Dataset") -> str | None:
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
    """Doubles as the integers of their bits: then −0 is not 0, and equal NaNs are equal."""
    return values.view(np.uint64) if values.dtype == np.float64 else values


def _other_difference(log: "Log", again: Carry) -> str | None:
    for name in _FACTS:
        before, now = getattr(log, name), getattr(again, name)
        if before != now:
            if name in ("corrections", "touches", "letters"):
                pairs = enumerate(zip(before, now, strict=False), start=1)
                first = next((k for k, (a, b) in pairs if a != b), min(len(before), len(now)) + 1)
                return f"{name}: number {first} differs"
            return f"{name} was {before!r}, is {now!r}"
    if log.trace_hash != again.trace_hash:
        return f"trace_hash was {log.trace_hash}, is {again.trace_hash}"
    return None

# SPDX-License-Identifier: Apache-2.0
"""The files that `robot.error_trace` and `radio.trace` name: recordings that carries replay.

Both are tables as in `recorded_tables`. `palmbots fit` writes them.
"""

from __future__ import annotations

import functools
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError, SceneError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from palmbots.scene.scene import Scene

    Floats = NDArray[np.float64]

ERRORS = ("segment", "time_s", "error_m", "gain")
"""Columns of an error trace: number of the segment, time, displacement error beyond that of the
gain, and the gain of the segment (1 without this column)."""
FATES = ("sent_s", "lost", "delay_s", "later_s")
"""Columns of a radio trace: when the packet was sent, 1 if it was lost, and how late it arrived, in
all or beyond radio.latency_s. Without the last two the delays are those of the scene."""

_LEAST_ERRORS_S = 2.0
_LEAST_FATES = 50
_FASTEST_M_S = 0.5
"""A larger speed error is taken for another unit."""
_GAINS = (0.5, 2.0)
_SLOWEST_S = 10.0
"""A longer delay or interval is taken for another unit."""


@dataclass(frozen=True)
class ErrorRows:
    """An error trace, as the core takes it."""

    segments: Any
    times_s: Floats
    errors_m: Floats
    gains: Floats


@dataclass(frozen=True)
class FateRows:
    """A radio trace, as the core takes it."""

    interval_s: float
    kind: int
    """0: only losses, 1: delays beyond the latency of the scene, 2: whole delays."""
    delays_s: Any
    """Of each packet [s]; −1: lost."""


def traces_of(scene: Scene) -> dict[str, str]:
    """The files that a scene replays, by their keys."""
    robot = scene.robot
    found = {f"robot.{side}.error_trace": getattr(robot, side).error_trace for side in SIDES}
    found |= {"robot.error_trace": robot.error_trace, "radio.trace": scene.radio.trace}
    return {key: name for key, name in found.items() if name is not None}


def refuse_traces(scene: Scene, what: str) -> None:
    """Raise `SceneError` for a scene that replays a recording, which `what` does not."""
    for key, name in traces_of(scene).items():
        raise SceneError(
            f'{key}: "{name}" is a recording, and {what} not replay it; allowed: no recording, or '
            "palmbots carry"
        )


def put_traces(spec: _core.Spec, scene: Scene) -> None:
    """Give a spec the recordings of its scene.

    Raises:
        SceneError: a file cannot be read, or is no such recording.
    """
    files = traces_of(scene)
    for index, side in enumerate(SIDES):
        key = f"robot.{side}.error_trace"
        key = key if key in files else "robot.error_trace"
        if key in files:
            rows = _read(key, files[key], _errors)
            try:
                spec.replay_errors(index, rows.segments, rows.times_s, rows.errors_m, rows.gains)
            except ValueError as error:
                raise SceneError(f"{key}: {files[key]}: {error}") from None
    if (fates := fates_of(scene)) is not None:
        spec.replay_fates(fates.interval_s, fates.kind, fates.delays_s)


def fates_of(scene: Scene) -> FateRows | None:
    """The recorded packets that a scene replays; None: it replays none.

    Raises:
        SceneError: the file cannot be read, or is no such recording.
    """
    name = traces_of(scene).get("radio.trace")
    return None if name is None else _read("radio.trace", name, _fates)


def _read(key: str, name: str, reader: Any) -> Any:
    """The content of a file, which is read again if it changes."""
    try:
        try:
            about = os.stat(user_path(name))
            stamp = (about.st_mtime_ns, about.st_size, about.st_ino)
        except (OSError, ValueError):
            stamp = None  # the reader names the fault
        return reader(name, stamp)
    except PalmbotsError as error:
        raise SceneError(f"{key}: {error}") from None


@functools.lru_cache(maxsize=64)
def _errors(name: str, stamp: object) -> ErrorRows:
    import numpy as np

    from palmbots.scene.recorded_tables import read_recording

    table = read_recording(name, ERRORS, 3, least_rows=2, has_segments=True)
    segments, times, errors = (table[key] for key in ERRORS[:3])
    gains = table["gain"] if "gain" in table else np.ones(len(times))
    if (segments != np.round(segments)).any() or segments.min() < 0 or segments.max() > 1e6:
        raise PalmbotsError(f"{name}: segment is not a whole number; expected from 0 to 1000000")
    within = np.diff(segments) == 0
    if (np.diff(segments) < 0).any():
        raise PalmbotsError(f"{name}: segment decreases; expected one segment after the other")
    steps = np.diff(times)[within]
    if (steps <= 0).any():
        raise PalmbotsError(f"{name}: time_s does not increase in a segment; expected that it does")
    lasts = float(steps.sum())
    if lasts < _LEAST_ERRORS_S:
        raise PalmbotsError(
            f"{name}: all segments last {lasts:.3g} s together; expected s, and at least "
            f"{_LEAST_ERRORS_S:g}"
        )
    fastest = float(np.abs(np.diff(errors)[within] / steps).max())
    if fastest > _FASTEST_M_S:
        raise PalmbotsError(
            f"{name}: the error changes by {fastest:.4g} m/s; expected error_m in m and time_s in "
            f"s, and at most {_FASTEST_M_S:g} m/s"
        )
    if gains.min() < _GAINS[0] or gains.max() > _GAINS[1]:
        odd = gains.min() if gains.min() < _GAINS[0] else gains.max()
        raise PalmbotsError(f"{name}: gain is {odd:.4g}; expected from 0.5 to 2")
    return ErrorRows(segments.astype(np.uint32), times, errors, gains)


@functools.lru_cache(maxsize=64)
def _fates(name: str, stamp: object) -> FateRows:
    import numpy as np

    from palmbots.scene.recorded_tables import read_recording

    table = read_recording(name, FATES, 2, least_rows=_LEAST_FATES)
    sent, lost = table["sent_s"], table["lost"]
    if (np.diff(sent) < 0).any() or sent[-1] <= sent[0]:
        raise PalmbotsError(f"{name}: sent_s decreases; expected packets in the order of sending")
    interval_s = float(sent[-1] - sent[0]) / (len(sent) - 1)
    if interval_s > _SLOWEST_S:
        raise PalmbotsError(
            f"{name}: packets are sent every {interval_s:.4g} s; expected s, and at most "
            f"{_SLOWEST_S:g}"
        )
    if not np.isin(lost, (0, 1)).all():
        raise PalmbotsError(f"{name}: lost is neither 0 nor 1; expected 1 for a lost packet")
    kinds = {key: kind for key, kind in (("later_s", 1), ("delay_s", 2)) if key in table}
    if len(kinds) == 2:
        raise PalmbotsError(f"{name}: has delay_s and later_s; expected one of them")
    if not kinds:
        return FateRows(interval_s, 0, np.where(lost == 1, -1.0, 0.0))
    ((key, kind),) = kinds.items()
    arrived = table[key][lost == 0]
    if arrived.size and not (arrived.min() >= 0 and np.median(arrived) <= _SLOWEST_S):
        raise PalmbotsError(
            f"{name}: {key} is {arrived.min():.4g} to {arrived.max():.4g}; expected s, from 0, and "
            f"at most {_SLOWEST_S:g} in the median"
        )
    return FateRows(interval_s, kind, np.where(lost == 1, -1.0, table[key]))

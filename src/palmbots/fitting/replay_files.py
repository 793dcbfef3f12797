# SPDX-License-Identifier: Apache-2.0
"""Recordings as carries replay them: the files for `robot.error_trace` and `radio.trace`.

The error of a robot is what the fitted model expects of it, given all positions of a stretch (the
posterior mean of a Gaussian process): the noise of the positions is removed. On a stretch with the
commands' displacement c(t), the position without the mean gain and the bias is

    y(t) = a + δ c(t) + x(t) + m ε,   cov(x(t), x(t')) = σ² (2 τ min(t, t') + τ² (e^(−t/τ)
           + e^(−t'/τ) − 1 − e^(−|t − t'|/τ))) + q² min(t, t'),

with any origin a, the deviation δ of the stretch's gain, and x as in `motion_likelihood`.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palmbots._util.atomic_files import folder, write_whole
from palmbots.fitting.fitted_values import Replay, Source
from palmbots.fitting.motion_likelihood import Stretch
from palmbots.fitting.recorded_packets import Packets
from palmbots.fitting.straight_stretches import thinned

Floats = NDArray[np.float64]

SPEEDS_M_S = (0.05, 0.08)
"""Commands of the stretches that a carry replays: their errors do not depend on the speed."""
LEAST_S = 10.0
"""Least duration of these stretches together."""
UNTIMED_S = 0.05
"""Taken for the time between packets that have no times."""
_ORIGIN_M = 1.0  # the spread of an origin that may be anywhere
_LEAST_M = 1e-6  # least noise of the positions: less makes the covariance singular


def smoothed(stretch: Stretch, parameters: Floats) -> tuple[Floats, float]:
    """The displacement error of a stretch beyond that of its gain [m], and its gain.

    Args:
        stretch: the stretch.
        parameters: of the fit, as in `PARAMETERS`.
    """
    gain, bias, gain_sd, sigma, log_tau, white, measured = parameters
    tau = math.exp(log_tau)
    t = stretch.times_s - stretch.times_s[0]
    commanded = stretch.commanded_m - stretch.commanded_m[0]
    moved = stretch.positions_m - stretch.positions_m[0] - gain * commanded - bias * t
    early = np.minimum.outer(t, t)
    decay = np.exp(-t / tau)
    apart = np.exp(-np.abs(np.subtract.outer(t, t)) / tau)
    of_noise = 2 * tau * early + tau**2 * (np.add.outer(decay, decay) - 1 - apart)
    of_error = sigma**2 * of_noise + white**2 * early
    of_gain = gain_sd**2 * np.outer(commanded, commanded)
    total = of_error + of_gain + _ORIGIN_M**2
    total[np.diag_indices_from(total)] += measured**2 + _LEAST_M**2
    weights = np.linalg.solve(total, moved)
    error = of_error @ weights + bias * t
    return error - error[0], float(gain + gain_sd**2 * (commanded @ weights))


def error_replay(stretches: Sequence[Stretch], parameters: Floats, reason: str) -> Replay:
    """The errors of a robot on the stretches at the speeds of carries.

    Args:
        stretches: of all runs.
        parameters: of the fit.
        reason: why the model does not serve; empty: it does.
    """
    key, (low, high) = "robot.error_trace", SPEEDS_M_S
    used = [one for one in stretches if low <= one.command_m_s <= high]
    lasts = sum(float(one.times_s[-1] - one.times_s[0]) for one in used)
    if not reason and lasts < LEAST_S:
        reason = (
            f"stretches at {100 * low:g} to {100 * high:g} cm/s last {lasts:.3g} s together; "
            f"it needs {LEAST_S:g} s"
        )
    if reason:
        return Replay(key=key, reason=reason)
    lines = ["segment,time_s,error_m,gain"]
    for number, one in enumerate(map(_thinned, used)):
        errors, gain = smoothed(one, parameters)
        times = one.times_s - one.times_s[0]
        lines += [
            f"{number},{time:.4f},{error:.7f},{gain:.5f}"
            for time, error in zip(times, errors, strict=True)
        ]
    return Replay("robot-errors.csv", key, "\n".join(lines))


def _thinned(stretch: Stretch) -> Stretch:
    rows = thinned(stretch.times_s)
    times_s, positions_m, commanded_m = (
        values[rows] for values in (stretch.times_s, stretch.positions_m, stretch.commanded_m)
    )
    return replace(stretch, times_s=times_s, positions_m=positions_m, commanded_m=commanded_m)


def fate_replay(runs: Sequence[Packets]) -> Replay:
    """What became of the packets of all runs, one run after the other."""
    key = "radio.trace"
    timed = [one for one in runs if one.delays_s.size]
    runs = timed or runs
    fates = [one.fates_s for one in runs]
    if any(one.size == 0 for one in fates) or sum(map(len, fates)) < 50:
        return Replay(key=key, reason="the numbers of the packets do not show which were lost")
    known = [one.interval_s for one in runs if one.interval_s]
    interval_s = float(np.median(known)) if known else UNTIMED_S
    delays = np.concatenate(fates)
    lost = delays < 0
    column, factor = {
        "round trip": ("delay_s", 0.5),
        "one-way delay": ("delay_s", 1.0),
        "delay behind the fastest": ("later_s", 1.0),
    }[runs[0].delay_kind]
    has_delays = bool(timed)
    lines = ["sent_s,lost" + (f",{column}" if has_delays else "")]
    for number, (delay, is_lost) in enumerate(zip(delays, lost, strict=True)):
        row = f"{number * interval_s:.4f},{int(is_lost)}"
        lines.append(f"{row},{max(0.0, factor * delay):.5f}" if has_delays else row)
    return Replay("radio-fates.csv", key, "\n".join(lines))


def write_replay(replay: Replay, sources: Sequence[Source], path: str | os.PathLike[str]) -> Path:
    """Write the file to a folder; returns it."""
    file = folder(Path(path)) / replay.name
    head = "".join(f"# {one.name}: SHA-256 {one.sha256}\n" for one in sources)
    write_whole(file, f"# Recorded; for {replay.key}.\n{head}{replay.rows}\n")
    return file

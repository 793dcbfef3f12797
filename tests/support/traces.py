# SPDX-License-Identifier: Apache-2.0
"""Recordings for `robot.error_trace` and `radio.trace`, made from models."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def error_trace(file: Path, segments: list[Any], step_s: float, gains: Any = None) -> str:
    """Write displacement errors at equal times, one array for each segment."""
    lines = ["segment,time_s,error_m,gain"]
    for number, errors in enumerate(segments):
        gain = 1.0 if gains is None else float(gains[number])
        lines += [f"{number},{k * step_s!r},{e!r},{gain!r}" for k, e in enumerate(errors.tolist())]
    file.write_text("\n".join(lines) + "\n")
    return str(file)


def wandering(
    count: int, lasts_s: float, sigma_m_s: float, tau_s: float, seed: int, step_s: float = 0.01
) -> list[Floats]:
    """Displacement errors of an Ornstein–Uhlenbeck noise of the speed, which is constant during a
    step, as in the robots' model."""
    rng = np.random.default_rng(seed)
    size = round(lasts_s / step_s)
    speeds = np.zeros((count, size))
    memory = np.exp(-step_s / tau_s)
    speeds[:, 0] = sigma_m_s * rng.standard_normal(count)
    for k in range(1, size):
        drawn = sigma_m_s * np.sqrt(1 - memory**2) * rng.standard_normal(count)
        speeds[:, k] = memory * speeds[:, k - 1] + drawn
    start = np.zeros((count, 1))
    return list(np.concatenate([start, np.cumsum(speeds, axis=1)], axis=1) * step_s)


def radio_trace(
    file: Path, lost: Any, interval_s: float, delays_s: Any = None, column: str = "delay_s"
) -> str:
    """Write the fates of packets that were sent at equal times."""
    lines = ["sent_s,lost" + ("" if delays_s is None else f",{column}")]
    for k, one in enumerate(lost):
        row = f"{k * interval_s!r},{int(one)}"
        lines.append(row if delays_s is None else f"{row},{float(delays_s[k])!r}")
    file.write_text("\n".join(lines) + "\n")
    return str(file)

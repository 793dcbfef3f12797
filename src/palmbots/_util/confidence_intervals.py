# SPDX-License-Identifier: Apache-2.0
"""95 % confidence intervals: Wilson's for a rate, from the core, exact ones, and other quantiles.

SciPy has a quantile of Student's t, but importing it takes longer than most commands. A table of
six numbers stands here instead.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core

Z95 = _core.z95
"""97.5 % quantile of the normal distribution."""

# 97.5 % quantiles of Student's t, by degrees of freedom.
_T95 = (
    (1, 12.707), (2, 4.303), (3, 3.183), (4, 2.777), (5, 2.571), (7, 2.365), (10, 2.229),
    (15, 2.131), (20, 2.086), (30, 2.042), (60, 2.000), (120, 1.980), (10_000, 1.960),
)  # fmt: skip


def student_t95(freedom: int) -> float:
    """97.5 % quantile of Student's t at the next smaller tabled number of degrees of freedom.

    The quantile falls with the degrees of freedom, so an interval is never too narrow.
    """
    return min(t for n, t in _T95 if n <= freedom)


def wilson_bounds(events: Any, n: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    """Both ends of Wilson's score interval of the rates events / n, for arrays of counts.

    Where n is 0 both ends are NaN.
    """
    return np.vectorize(_core.wilson, otypes=(float, float))(events, n)


def wilson(events: int, n: int, z: float = Z95) -> tuple[float, float]:
    """Wilson's score interval of the rate of `events` in `n`; 95 % by default."""
    return _core.wilson(float(events), float(n), z)


def rate_interval(events: int, n: int) -> tuple[float, float]:
    """The 95 % interval of a rate as people read it.

    Wilson's, but where none or all of `n` are events it is the exact one-sided bound.
    """
    return _core.rate_interval(float(events), float(n))


def clopper_pearson(events: int, n: int) -> tuple[float, float]:
    """The exact 95 % interval of a rate, which covers it at least that often.

    Two-sided; where none or all of `n` are events, one-sided as in `rate_interval`.
    """
    if events in (0, n):
        return rate_interval(events, n)
    return _quantile(events, n, 0.975), _quantile(events + 1, n, 0.025)


def _quantile(events: int, n: int, below: float) -> float:
    """The rate at which fewer than `events` of `n` are events with the probability `below`."""
    fewer = np.arange(events)
    logs = np.concatenate([[0.0], np.cumsum(np.log((n - fewer) / (fewer + 1)))])[:-1]
    low, high = 0.0, 1.0
    while high - low > 1e-12 * high:
        rate = 0.5 * (low + high)
        if not low < rate < high:
            break
        chance = np.exp(logs + fewer * np.log(rate) + (n - fewer) * np.log1p(-rate)).sum()
        low, high = (rate, high) if chance > below else (low, rate)
    return high


def rate_text(events: int, n: int) -> str:
    """A rate in per cent with its 95 % interval: "18.2 % (16.0–20.7)", or "< 0.30 %" for none."""
    low, high = (100 * end for end in rate_interval(events, n))
    if events == 0:
        return f"< {high:.2g} %" if high < 10 else f"< {high:.0f} %"
    if events == n:
        return f"> {low:.3g} %"
    return f"{100 * events / n:.1f} % ({low:.1f}–{high:.1f})"

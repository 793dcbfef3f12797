# SPDX-License-Identifier: Apache-2.0
"""95 % confidence intervals: Wilson's for a rate, and the quantiles behind the others.

SciPy has both, but it is an optional dependency (extra ``study``), and importing `scipy.stats`
takes longer than most commands. Two formulas and a table of six numbers stand here instead.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Z95 = 1.959963984540054
"""97.5 % quantile of the normal distribution."""

# 97.5 % quantiles of Student's t, by degrees of freedom.
_T95 = ((15, 2.131), (20, 2.086), (30, 2.042), (60, 2.000), (120, 1.980), (10_000, 1.960))


def student_t95(freedom: int) -> float:
    """97.5 % quantile of Student's t at the next smaller tabled number of degrees of freedom.

    The quantile falls with the degrees of freedom, so an interval is never too narrow. The table
    begins at 15 degrees of freedom.
    """
    return min(t for n, t in _T95 if n <= freedom)


def wilson_bounds(events: Any, n: Any, z: float = Z95) -> tuple[NDArray[Any], NDArray[Any]]:
    """Both ends of Wilson's score interval of the rates events / n, for arrays of counts.

    Where n is 0 both ends are NaN.
    """
    k, total = np.broadcast_arrays(np.asarray(events, float), np.asarray(n, float))
    with np.errstate(divide="ignore", invalid="ignore"):
        rate = k / total
        spread = z * np.sqrt(rate * (1 - rate) / total + z * z / (4 * total * total))
        centre = rate + z * z / (2 * total)
        scale = 1 + z * z / total
        low = np.where(k == 0, 0.0, (centre - spread) / scale)
        high = np.where(k == total, 1.0, (centre + spread) / scale)
    unknown = total == 0
    return np.where(unknown, np.nan, low), np.where(unknown, np.nan, high)


def wilson(events: int, n: int, z: float = Z95) -> tuple[float, float]:
    """Wilson's score interval of the rate of `events` in `n`; 95 % by default."""
    low, high = wilson_bounds(events, n, z)
    return float(low), float(high)

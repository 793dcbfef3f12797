"""When a cell has been carried often enough, and the intervals that decide it.

Rates have Wilson's score interval; means, and the contact rms as the root of a mean, the normal
one. A cell is looked at only where a block of seeds ends, which the study file says, so that what
is carried does not depend on chunks, threads or machines. Looking again and again makes intervals
at the end a little optimistic: with Wilson's interval and blocks of 100 the coverage of a nominal
95 % stays above 90 % (`tests/test_study_statistics.py` simulates it).
"""

import numpy as np
from numpy.typing import NDArray

from palmbots.studies.plan import Stop
from palmbots.studies.tally import Tally, count_of, sum_of

__all__ = ["Z95", "mean_and_half", "precise_enough", "rms_interval", "wilson_intervals"]

Z95 = 1.959963984540054  # 97.5 % quantile of the normal distribution
Reals = NDArray[np.float64]


def wilson_intervals(events: NDArray[np.int64], n: NDArray[np.int64]) -> tuple[Reals, Reals]:
    """Wilson's 95 % interval of rates, NaN where n is 0; `palmbots.compare.wilson` in arrays."""
    with np.errstate(invalid="ignore", divide="ignore"):
        rate = events / n
        spread = Z95 * np.sqrt(rate * (1 - rate) / n + Z95**2 / (4.0 * n * n))
        centre, scale = rate + Z95**2 / (2 * n), 1 + Z95**2 / n
        low = np.where(events == 0, 0.0, (centre - spread) / scale)
        high = np.where(events == n, 1.0, (centre + spread) / scale)
    missing = n == 0
    return np.where(missing, np.nan, low), np.where(missing, np.nan, high)


def mean_and_half(n: NDArray[np.int64], total: Reals, squares: Reals) -> tuple[Reals, Reals]:
    """The mean and half the width of its 95 % interval; NaN where n is too small."""
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = total / n
        variance = np.maximum(squares - total * mean, 0.0) / (n - 1)
        return mean, Z95 * np.sqrt(variance / n)


def rms_interval(tally: Tally) -> tuple[Reals, Reals, Reals]:
    """The contact rms of all carries and the ends of its interval [m]."""
    n = count_of(tally, "carried")
    mean, half = mean_and_half(n, sum_of(tally, "square"), sum_of(tally, "square²"))
    return np.sqrt(mean), np.sqrt(np.maximum(mean - half, 0)), np.sqrt(mean + half)


def precise_enough(tally: Tally, stop: Stop) -> NDArray[np.bool_]:
    """Which cells have intervals as narrow as the study wants them."""
    n = count_of(tally, "carried")
    enough = n > 1
    if stop.drop_rate is not None:
        low, high = wilson_intervals(count_of(tally, "dropped"), n)
        enough &= (high - low) / 2 <= stop.drop_rate
    if stop.rms is not None:
        rms, low, high = rms_interval(tally)
        enough &= (high - low) / 2 <= stop.rms * rms
    return enough

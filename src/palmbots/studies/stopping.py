# SPDX-License-Identifier: Apache-2.0
"""When a cell has enough carries, and the confidence intervals on which this depends.

Rates have Wilson's score interval. Means have the normal interval, and the contact rms has the root
of the ends of such an interval. A cell is checked only at the end of a block of seeds, whose length
the study file sets, so the set of carries does not depend on chunks, threads or machines. Checking
repeatedly makes the final intervals slightly optimistic: with Wilson's interval and blocks of 100
carries, the coverage of a nominal 95 % interval stays above 90 % (simulated in
`tests/studies/test_statistics.py`).
"""

import numpy as np
from numpy.typing import NDArray

from palmbots._util.confidence_intervals import Z95, wilson_bounds
from palmbots.studies.exact_sums import ExactSums, count_of, sum_of
from palmbots.studies.study_file import Stop

Reals = NDArray[np.float64]


def mean_and_half(n: NDArray[np.int64], total: Reals, squares: Reals) -> tuple[Reals, Reals]:
    """The mean, and half the width of its 95 % interval; NaN where n is too small."""
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = total / n
        variance = np.maximum(squares - total * mean, 0.0) / (n - 1)
        return mean, Z95 * np.sqrt(variance / n)


def root_mean_interval(sums: ExactSums, name: str) -> tuple[Reals, Reals, Reals]:
    """The root of the mean of a statistic's values over all carries, and the ends of its
    interval."""
    n = count_of(sums, "carried")
    mean, half = mean_and_half(n, sum_of(sums, name), sum_of(sums, f"{name}²"))
    return np.sqrt(mean), np.sqrt(np.maximum(mean - half, 0)), np.sqrt(mean + half)


def is_precise_enough(sums: ExactSums, stop: Stop) -> NDArray[np.bool_]:
    """Which cells have intervals as narrow as the study demands."""
    n = count_of(sums, "carried")
    enough = n > 1
    if stop.drop_rate is not None:
        low, high = wilson_bounds(count_of(sums, "dropped"), n)
        enough &= (high - low) / 2 <= stop.drop_rate
    if stop.rms is not None:
        rms, low, high = root_mean_interval(sums, "rms_m")
        enough &= (high - low) / 2 <= stop.rms * rms
    return enough

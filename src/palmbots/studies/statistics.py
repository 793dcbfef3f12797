# SPDX-License-Identifier: Apache-2.0
"""The statistics of a study's cells, computed from exact sums, each with its 95 % interval."""

import numpy as np
from numpy.typing import NDArray

from palmbots._util.confidence_intervals import Z95, wilson_bounds
from palmbots.studies.exact_sums import ExactSums, count_of, sum_of
from palmbots.studies.stopping import mean_and_half, root_mean_interval
from palmbots.studies.variables import STATISTICS, Statistic

Reals = NDArray[np.float64]
Values = dict[str, tuple[Reals, Reals | None]]
"""By name: values, and the low and high ends of their intervals along a last axis of two."""


def statistics_of(sums: ExactSums) -> Values:
    """All of `STATISTICS`; NaN where there are too few carries."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return {name: _reduced(statistic, sums) for name, statistic in STATISTICS.items()}


def _reduced(statistic: Statistic, sums: ExactSums) -> tuple[Reals, Reals | None]:
    n = count_of(sums, "carried")
    match statistic.reduction:
        case "count":
            return count_of(sums, statistic.event).astype(np.float64), None
        case "rate":
            events = count_of(sums, statistic.event)
            return events / n, np.stack(wilson_bounds(events, n), axis=-1)
        case "rate_difference":
            return _rate_difference(sums)
        case "root_mean":
            value, low, high = root_mean_interval(sums, statistic.name)
            return value, np.stack([low, high], axis=-1)
        case _:
            counted = "pairs" if statistic.is_difference else statistic.event
            mean, half = mean_and_half(
                count_of(sums, counted),
                sum_of(sums, statistic.name),
                sum_of(sums, f"{statistic.name}²"),
            )
            return mean, np.stack([mean - half, mean + half], axis=-1)


def _rate_difference(sums: ExactSums) -> tuple[Reals, Reals]:
    """The difference of two paired drop rates.

    The interval is that of Agresti and Min (2005): Wald's, with half a pair added to each of the
    four kinds of pairs.
    """
    n = count_of(sums, "pairs").astype(np.float64)
    first, this = (count_of(sums, name) for name in ("only_first", "only_this"))
    m, a, b = n + 2, first + 0.5, this + 0.5
    centre = (b - a) / m
    half = Z95 * np.sqrt((a + b) - (b - a) ** 2 / m) / m
    low, high = np.maximum(centre - half, -1), np.minimum(centre + half, 1)
    ends = np.where((n > 0)[..., None], np.stack([low, high], axis=-1), np.nan)
    rate = (this - first) / n
    # The first controller differs from itself by exactly 0.
    ends[:, 0] = np.where(np.isnan(rate[:, :1]), np.nan, 0.0)
    return rate, ends


def pooled_counts(sums: ExactSums) -> tuple[int, int, int]:
    """Carries, drops and stalls of all cells together."""
    names = ("carried", "dropped", "stalled")
    carried, dropped, stalled = (int(count_of(sums, name).sum()) for name in names)
    return carried, dropped, stalled

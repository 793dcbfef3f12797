"""The statistics of a study's cells, worked out from tallies; each with its 95 % interval."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palmbots.studies.stopping import Z95, mean_and_half, rms_interval, wilson_intervals
from palmbots.studies.tally import Tally, count_of, sum_of

__all__ = ["STATISTICS", "Statistic", "Values", "pooled_rate", "statistics_of"]


@dataclass(frozen=True)
class Statistic:
    """One number a cell."""

    unit: str
    meaning: str
    has_interval: bool = True


STATISTICS: Mapping[str, Statistic] = {
    "carries": Statistic("1", "number of carries", False),
    "drop_rate": Statistic("1", "share of carries that dropped the object"),
    "stall_rate": Statistic("1", "share of carries that neither arrived nor dropped in time"),
    "rms_m": Statistic("m", "root mean square of both contact coordinates over all carries"),
    "mean_peak_m": Statistic("m", "mean of the larger peak of the two contacts"),
    "mean_time_s": Statistic("s", "mean time of the delivered carries"),
    "mean_waiting_s": Statistic("s", "mean time waited for messages, both robots together"),
    "mean_corrections": Statistic("1", "mean number of corrections"),
    "mean_messages": Statistic("1", "mean number of messages sent"),
    "drop_rate_difference": Statistic(
        "1", "drop rate less that of the first controller, over the same scenes and seeds"
    ),
    "square_difference": Statistic(
        "m2", "mean square of the contact coordinates less that of the first controller, likewise"
    ),
}

Values = dict[str, tuple[NDArray[np.float64], NDArray[np.float64] | None]]
"""By name: values, and low and high ends along a last axis of two."""


def statistics_of(tally: Tally) -> Values:
    """All of `STATISTICS`, NaN where too few carries say anything."""
    n = count_of(tally, "carried")
    found: Values = {"carries": (n.astype(np.float64), None)}
    with np.errstate(invalid="ignore", divide="ignore"):
        for name, events in (("drop_rate", "dropped"), ("stall_rate", "stalled")):
            count = count_of(tally, events)
            found[name] = (count / n, np.stack(wilson_intervals(count, n), axis=-1))
    rms, low, high = rms_interval(tally)
    found["rms_m"] = (rms, np.stack([low, high], axis=-1))
    means = (
        ("mean_peak_m", "peak_m", n),
        ("mean_time_s", "time_s", count_of(tally, "delivered")),
        ("mean_waiting_s", "waiting_s", n),
        ("mean_corrections", "corrections", n),
        ("mean_messages", "messages", n),
        ("square_difference", "excess", count_of(tally, "pairs")),
    )
    for name, quantity, of in means:
        mean, half = mean_and_half(of, sum_of(tally, quantity), sum_of(tally, f"{quantity}²"))
        found[name] = (mean, np.stack([mean - half, mean + half], axis=-1))
    found["drop_rate_difference"] = _paired(tally)
    return {name: found[name] for name in STATISTICS}


def _paired(tally: Tally) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The difference of two paired rates; interval of Agresti and Min (2005): Wald's, with half a
    pair added to each of the four kinds of pairs."""
    n = count_of(tally, "pairs").astype(np.float64)
    first, this = (count_of(tally, name) for name in ("only_first", "only_this"))
    with np.errstate(invalid="ignore", divide="ignore"):
        m, a, b = n + 2, first + 0.5, this + 0.5
        centre = (b - a) / m
        half = Z95 * np.sqrt((a + b) - (b - a) ** 2 / m) / m
        low, high = np.maximum(centre - half, -1), np.minimum(centre + half, 1)
        ends = np.where((n > 0)[..., None], np.stack([low, high], axis=-1), np.nan)
        rate = (this - first) / n
    ends[:, 0] = np.where(np.isnan(rate[:, :1]), np.nan, 0.0)  # the first one against itself
    return rate, ends


def pooled_rate(tally: Tally) -> tuple[int, int, int]:
    """Carries, drops and stalls of all cells together."""
    names = ("carried", "dropped", "stalled")
    carried, dropped, stalled = (int(count_of(tally, name).sum()) for name in names)
    return carried, dropped, stalled

"""Sobol indices: which of the keys that vary decides a metric.

Over the box of a study with design ``sobol-indices``: the *first-order* index of a key is the share
of the metric's variance that goes away when that key becomes known, the *total* index the share
that remains when only that key stays unknown (Sobol 2001; estimators of Saltelli 2010, by SALib).
All points share their seeds, so that the metric is a function of the keys and not of luck.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from palmbots.studies.design import Points
from palmbots.studies.needs import needed
from palmbots.studies.statistics import Values

__all__ = ["METRICS", "Index", "problem_of", "sensitivities"]

METRICS = ("drop_rate", "rms_m")


@dataclass(frozen=True, slots=True)
class Index:
    """One key's share in the variance of one metric."""

    controller: str
    metric: str
    key: str
    first: float
    first_half: float
    """Half the width of its 95 % interval, by bootstrap over the points."""
    total: float
    total_half: float


def problem_of(dims: int) -> dict[str, Any]:
    """The unit cube as SALib wants it."""
    return {"num_vars": dims, "names": [str(k) for k in range(dims)], "bounds": [[0, 1]] * dims}


def sensitivities(points: Points, values: Values) -> list[Index]:
    """The indices of every key for every controller and metric.

    Empty where the design is not for them. A metric that is the same everywhere, or unknown
    somewhere, has none.
    """
    if points.plan.study.design.kind != "sobol-indices":
        return []
    analyze = needed("SALib.analyze.sobol", "study").analyze
    keys, found = points.plan.keys, []
    for c, controller in enumerate(points.plan.study.controllers):
        for metric in METRICS:
            numbers = values[metric][0][:, c]
            if not np.isfinite(numbers).all() or np.ptp(numbers) == 0:
                continue
            told = analyze(
                problem_of(len(keys)), numbers, calc_second_order=False, num_resamples=500, seed=1
            )  # SALib takes a seed of 0 for none: the intervals would be others each time
            for k, key in enumerate(keys):
                four = (float(told[name][k]) for name in ("S1", "S1_conf", "ST", "ST_conf"))
                found.append(Index(controller, metric, key, *four))
    return found

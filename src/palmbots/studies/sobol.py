# SPDX-License-Identifier: Apache-2.0
"""Sobol indices: how much each key contributes to the variance of a statistic.

They refer to the ranges of a study with the design ``sobol-indices``. The *first-order*
index of a key is the share of the variance that vanishes once that key is known. The *total* index
is the share that remains while only that key is unknown (Sobol 2001; estimators of Saltelli 2010,
computed by SALib). All points share their seeds, so the statistic is a function of the keys and has
no sampling noise between points.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from palmbots._types import MaybeNaN
from palmbots._util.optional_imports import require
from palmbots.studies.designs import sobol_problem
from palmbots.studies.points import Points
from palmbots.studies.statistics import Values
from palmbots.studies.variables import STATISTICS, Display

METRICS: Mapping[str, Display] = {
    name: statistic.display
    for name, statistic in STATISTICS.items()
    if statistic.display is not None and statistic.display.title
}
"""The statistics that figures draw and of which there are indices."""


@dataclass(frozen=True, slots=True)
class SobolIndex:
    """The share of one key in the variance of one statistic."""

    controller: str
    metric: str
    key: str
    first: MaybeNaN
    first_half: MaybeNaN
    """Half the width of its 95 % interval, by bootstrap over the points."""
    total: MaybeNaN
    total_half: MaybeNaN


def sobol_indices(points: Points, values: Values) -> list[SobolIndex]:
    """The indices of every key, for every controller and every one of `METRICS`.

    The list is empty for any other design. A statistic that is the same at all points, or unknown
    at one of them, has no indices.
    """
    if points.plan.study.design.kind != "sobol-indices":
        return []
    analyze = require("SALib.analyze.sobol", "study").analyze
    keys, indices = points.plan.keys, []
    for c, controller in enumerate(points.plan.controller_names):
        for metric in METRICS:
            numbers = values[metric][0][:, c]
            if not np.isfinite(numbers).all() or np.ptp(numbers) == 0:
                continue
            # Not seed 0, which SALib takes for "no seed": the intervals would change at each call.
            result = analyze(
                sobol_problem(len(keys)), numbers, calc_second_order=False, num_resamples=500,
                seed=1,
            )  # fmt: skip
            for k, key in enumerate(keys):
                four = (float(result[name][k]) for name in ("S1", "S1_conf", "ST", "ST_conf"))
                indices.append(SobolIndex(controller, metric, key, *four))
    return indices

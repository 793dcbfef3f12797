# SPDX-License-Identifier: Apache-2.0
"""Whether one kind of carry drops more than another on the same seeds."""

import itertools

import numpy as np
from numpy.typing import NDArray
from scipy import stats


def more_drops(mine: NDArray[np.bool_], other: NDArray[np.bool_]) -> float:
    """McNemar's exact one-sided p-value of the hypothesis that mine drop no more than the other."""
    worse, better = int(np.sum(mine & ~other)), int(np.sum(other & ~mine))
    return float(stats.binom.sf(worse - 1, worse + better, 0.5)) if worse + better else 1.0


def rejected(p_values: list[float], level: float) -> int:
    """How many hypotheses Holm's procedure rejects."""
    ordered = sorted(p_values)
    passed = itertools.takewhile(
        lambda item: item[1] <= level / (len(ordered) - item[0]), enumerate(ordered)
    )
    return sum(1 for _ in passed)

# SPDX-License-Identifier: Apache-2.0
"""Exact sums over carries: counts and sums of real numbers that do not depend on any order.

The sums of a cell are an array of integers: `COUNTS`, then four limbs for each of the `SUMS`. A sum
of real numbers is stored in limbs of 31 bits after the first (value = l0 + l1/2³¹ + l2/2⁶² +
l3/2⁹³). Limbs are added as integers, so a sum has the same bits in any order and grouping, which
floating-point sums do not have. Statistics are computed from these sums at the end.

Every statistic that is a mean has two sums: of its value, and (the name with ``²``) of the squares.
"""

import numpy as np
from numpy.typing import NDArray

from palmbots.studies.variables import EVENTS, STATISTICS, Columns, is_carried

COUNTS = (*EVENTS, "pairs", "only_first", "only_this")
"""`pairs`: carries that this controller and the first one both have. `only_this`: pairs in which
this controller dropped the object and the first one did not."""
_AVERAGED = tuple(s for s in STATISTICS.values() if s.value is not None)
SUMS = tuple(name for s in _AVERAGED for name in (s.name, f"{s.name}²"))
_LIMBS = 4
_BASE = float(1 << 31)
WIDTH = len(COUNTS) + _LIMBS * len(SUMS)

ExactSums = NDArray[np.int64]
"""[…, WIDTH]"""


def exact_sums_of(columns: Columns) -> ExactSums:
    """The sums of each point and controller over the carries in these columns."""
    outcome = columns["outcome"]
    events = {name: np.isin(outcome, codes) for name, codes in EVENTS.items()}
    carried = is_carried(outcome)
    pairs, dropped = carried & carried[:, :1], events["dropped"]
    masks = {
        **events,
        "pairs": pairs,
        "only_first": pairs & dropped[:, :1] & ~dropped,
        "only_this": pairs & dropped & ~dropped[:, :1],
    }
    sums = np.zeros((*outcome.shape[:2], WIDTH), np.int64)
    for k, name in enumerate(COUNTS):
        sums[..., k] = np.count_nonzero(masks[name], axis=2)
    at = len(COUNTS)
    for statistic in _AVERAGED:
        assert statistic.value is not None
        values, counted = statistic.value(columns), events[statistic.event]
        if statistic.is_difference:
            values, counted = values - values[:, :1], counted & counted[:, :1]
        values = np.where(counted, values, 0.0)
        for powers in (values, values * values):
            sums[..., at : at + _LIMBS] = _limbs(powers)
            at += _LIMBS
    return sums


def _limbs(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """The limbs of the sums over the last axis. Each value is truncated below 2⁻⁹³."""
    limbs, rest = [], values
    for _ in range(_LIMBS):
        # Not floor: it would round the rest of a small negative number.
        whole = np.trunc(rest)
        limbs.append(whole.astype(np.int64).sum(axis=-1))
        rest = (rest - whole) * _BASE
    return np.stack(limbs, axis=-1)


def count_of(sums: ExactSums, name: str) -> NDArray[np.int64]:
    """One of `COUNTS`."""
    return sums[..., COUNTS.index(name)]


def sum_of(sums: ExactSums, name: str) -> NDArray[np.float64]:
    """One of `SUMS`."""
    at = len(COUNTS) + _LIMBS * SUMS.index(name)
    total = np.zeros(sums.shape[:-1])
    for k in reversed(range(_LIMBS)):  # the smallest first
        total += sums[..., at + k].astype(np.float64) * _BASE**-k
    return total

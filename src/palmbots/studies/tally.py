"""What carries add up to, exactly: counts and sums that no split of the work can change.

A tally is an array of whole numbers, COUNTS + 4 × SUMS + PAIRED entries a cell. A sum of
real numbers is kept in four limbs of 31 bits each after the first (value = l0 + l1/2³¹ + l2/2⁶² +
l3/2⁹³): limbs of numbers are added as integers, so a sum has the same bits in any order and any
grouping, which floating-point sums have not. Statistics are worked out from tallies at the end.

Sums, over carries: `square` is the mean of both contacts' squared rms, in m²; a name with `²` at
its end is the sum of squares. Paired entries compare a controller with the first one of the study
over the same scene and seeds.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from palmbots.batch import DELIVERED, DROPPED, STALLED

__all__ = ["COUNTS", "PAIRED", "SUMS", "WIDTH", "Tally", "count_of", "sum_of", "tally_of"]

COUNTS = ("carried", "delivered", "dropped", "stalled", "pairs", "only_first", "only_this")
"""`only_this`: pairs in which this controller dropped and the first one did not."""
QUANTITIES = ("square", "peak_m", "time_s", "corrections", "messages", "waiting_s")
SUMS = tuple(name for one in QUANTITIES for name in (one, f"{one}²"))
PAIRED = ("excess", "excess²")
"""Of `square` over that of the first controller in the same carry; may be negative."""
_LIMBS = 4
_BASE = float(1 << 31)
_NAMED = (*SUMS, *PAIRED)
WIDTH = len(COUNTS) + _LIMBS * len(_NAMED)

Tally = NDArray[np.int64]
"""[…, WIDTH]"""


def tally_of(columns: Mapping[str, NDArray[np.generic]]) -> Tally:
    """The tally of columns [points, controllers, seeds(, side)], one for each point and controller.

    `outcome` is 0 where nothing was carried.
    """
    outcome = columns["outcome"]
    done = outcome != 0
    dropped = outcome == DROPPED
    both = done & done[:, :1]
    tally = np.zeros((*outcome.shape[:2], WIDTH), np.int64)
    counts = (
        done,
        outcome == DELIVERED,
        dropped,
        outcome == STALLED,
        both,
        both & dropped[:, :1] & ~dropped,
        both & dropped & ~dropped[:, :1],
    )
    for k, mask in enumerate(counts):
        tally[..., k] = np.count_nonzero(mask, axis=2)
    rms = columns["contact_rms_m"].astype(np.float64)
    square = np.where(done, np.mean(rms * rms, axis=3), 0.0)
    quantities = (
        square,
        columns["contact_peak_m"].max(axis=3).astype(np.float64),
        np.where(outcome == DELIVERED, columns["time_s"], 0.0),
        columns["corrections"].astype(np.float64),
        columns["messages"].astype(np.float64),
        columns["waiting_s"].astype(np.float64).sum(axis=3),
    )
    at = len(COUNTS)
    excess = np.where(both, square - square[:, :1], 0.0)
    for values in (*(np.where(done, q, 0.0) for q in quantities), excess):
        for powers in (values, values * values):
            tally[..., at : at + _LIMBS] = _limbs(powers)
            at += _LIMBS
    return tally


def _limbs(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """The limbs of the sums over the last axis. What lies below 2⁻⁹³ is cut off, value by value."""
    limbs, rest = [], values
    for _ in range(_LIMBS):
        whole = np.trunc(
            rest
        )  # and not floor: the rest of a small negative number would be rounded
        limbs.append(whole.astype(np.int64).sum(axis=-1))
        rest = (rest - whole) * _BASE
    return np.stack(limbs, axis=-1)


def count_of(tally: Tally, name: str) -> NDArray[np.int64]:
    """One of `COUNTS`."""
    return tally[..., COUNTS.index(name)]


def sum_of(tally: Tally, name: str) -> NDArray[np.float64]:
    """One of `SUMS` or `PAIRED`."""
    at = len(COUNTS) + _LIMBS * _NAMED.index(name)
    total = np.zeros(tally.shape[:-1])
    for k in reversed(range(_LIMBS)):  # the smallest first
        total += tally[..., at + k].astype(np.float64) * _BASE**-k
    return total

# SPDX-License-Identifier: Apache-2.0
"""A probit model of counts: where a rate that grows with x crosses a given value.

The model is rate = Φ(a + b (x − centre)) with the normal distribution Φ. Its log-likelihood is
concave in (a, b), so Newton's method with Fisher's information (scoring) finds the maximum. The
interval of the crossing contains the values that a likelihood-ratio test at 5 % does not reject;
for each value, the slope b is fitted anew (profile likelihood). Source: McCullagh and Nelder,
Generalized Linear Models, 2nd edition, sections 2.5 and 4.3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from palmbots._util.confidence_intervals import Z95

_NORMAL = NormalDist()
_FURTHEST = 7.5
"""Largest |a + b x| that is evaluated; beyond it the rate differs from 0 or 1 by less than
1e-13."""
_STEEPEST = 1e4
_ROOT_HALF = math.sqrt(0.5)
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Counts:
    """Events in n independent trials at each x."""

    x: Sequence[float]
    n: Sequence[int]
    events: Sequence[int]


@dataclass(frozen=True)
class Crossing:
    """Where the fitted rate crosses the given one."""

    x: float
    slope: float
    """b: by how many standard deviations the rate's quantile grows per unit of x."""
    low: float
    high: float
    """95 % interval of x; infinite where the data do not bound it."""


def information(rate: float) -> float:
    """Fisher's information of one trial at this rate about its probit (the quantile of the
    rate)."""
    density = _NORMAL.pdf(_NORMAL.inv_cdf(rate))
    return density * density / (rate * (1 - rate))


def crossing(counts: Counts, rate: float) -> Crossing | None:
    """Fit the model, and find where its rate is `rate`; None: the fitted rate does not grow.

    Args:
        counts: at two different x at least.
        rate: between 0 and 1.
    """
    x, n, k = (np.asarray(column, float) for column in (counts.x, counts.n, counts.events))
    target = _NORMAL.inv_cdf(rate)
    centre = float(np.average(x, weights=n))
    design = np.column_stack([np.ones_like(x), x - centre])
    pooled = (k.sum() + 0.5) / (n.sum() + 1)
    (a, b), best = _maximum(design, np.zeros_like(x), n, k, np.array([_NORMAL.inv_cdf(pooled), 0]))
    if not 1e-9 < b < _STEEPEST:
        return None
    found = float(centre + (target - a) / b)

    def deviation(place: float) -> float:
        """By how many standard deviations the data contradict a crossing at `place`."""
        offset = np.full_like(x, target)
        _, restricted = _maximum((x - place)[:, np.newaxis], offset, n, k, np.array([b]))
        return math.sqrt(max(2 * (best - restricted), 0.0))

    width = Z95 / (float(b) * math.sqrt(float(n.sum()) * information(rate)))
    ends = [_contradicted(found, sign * width, deviation) for sign in (-1, 1)]
    return Crossing(found, float(b), *ends)


def _contradicted(start: float, step: float, deviation: Callable[[float], float]) -> float:
    """Where the deviation reaches that of a 95 % interval, in one direction from `start`.

    It grows almost in proportion to the distance, so the secant method needs few steps; the bracket
    keeps them safe. Infinite: it does not reach it.
    """
    inside, below = 0.0, -Z95
    outside = step
    for _ in range(24):
        above = deviation(start + outside) - Z95
        if above >= 0:
            break
        inside, below, outside = outside, above, 2 * outside
    else:
        return math.copysign(math.inf, step)
    middle = inside
    for _ in range(30):
        middle = inside - below * (outside - inside) / (above - below)
        value = deviation(start + middle) - Z95
        if abs(value) < 1e-3 or abs(outside - inside) < 1e-9 * abs(outside):
            break
        if value >= 0:
            outside, above, below = middle, value, below / 2  # Illinois: no end stays for ever
        else:
            inside, below, above = middle, value, above / 2
    return start + middle


def _maximum(design: Array, offset: Array, n: Array, k: Array, start: Array) -> tuple[Array, float]:
    """The coefficients of largest likelihood, and its logarithm."""
    coefficients, value = start.astype(float), _log_likelihood(offset + design @ start, n, k)
    for _ in range(100):
        eta = np.clip(offset + design @ coefficients, -_FURTHEST, _FURTHEST)
        rate, density = _rates(eta)
        spread = rate * (1 - rate)
        score = design.T @ ((k - n * rate) * density / spread)
        fisher = (design * (n * density**2 / spread)[:, np.newaxis]).T @ design
        step = _solved(fisher, score)
        for _ in range(40):
            changed = _log_likelihood(offset + design @ (coefficients + step), n, k)
            if changed >= value:
                break
            step = step / 2
        else:
            break
        coefficients, gain, value = coefficients + step, changed - value, changed
        if gain < 1e-7 or abs(coefficients[-1]) > _STEEPEST:
            break
    return coefficients, value


def _solved(fisher: Array, score: Array) -> Array:
    """The solution of one or two linear equations; least squares where they are singular."""
    try:
        return np.linalg.solve(fisher, score).astype(np.float64)
    except np.linalg.LinAlgError:
        return np.linalg.lstsq(fisher, score, rcond=None)[0].astype(np.float64)


def _rates(eta: Array) -> tuple[Array, Array]:
    rate = np.array([0.5 * math.erfc(-value * _ROOT_HALF) for value in eta.tolist()])
    return rate, np.exp(-0.5 * eta * eta) / math.sqrt(2 * math.pi)


def _log_likelihood(eta: Array, n: Array, k: Array) -> float:
    eta = np.clip(eta, -_FURTHEST, _FURTHEST)
    rate, _ = _rates(eta)
    other, _ = _rates(-eta)
    return float(np.sum(k * np.log(rate) + (n - k) * np.log(other)))

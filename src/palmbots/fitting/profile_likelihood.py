# SPDX-License-Identifier: Apache-2.0
"""Greatest likelihood, and intervals from the profile of the likelihood.

An interval contains the values of a parameter at which the log-likelihood, maximised over all other
parameters, is less than half the 95 % quantile of χ² with one degree of freedom below its maximum
(Wilks). It needs no transformation that makes a parameter normal, and at the end of a parameter's
range it becomes a bound on one side.

The function gets many sets of parameters at once, because the overhead of a call exceeds the cost
of its computation. Derivatives are differences over a fraction of a parameter's own standard
deviation.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palmbots._util.confidence_intervals import Z95

Floats = NDArray[np.float64]
Function = Callable[[Floats], Floats]
"""Sets of parameters, one in a row → the log-likelihood of each."""

_STEP = 0.1  # of differences, in standard deviations
_ROUNDS = 60  # of Newton's method, at most
_ENOUGH = 1e-3  # expected gain of the log-likelihood at which a search ends
_SECANTS = 12
_DRAWS = 2000


@dataclass(frozen=True)
class Maximum:
    """Where a log-likelihood is greatest."""

    place: Floats
    value: float
    information: Floats
    """Minus the second derivatives."""
    steps: Floats
    """For differences."""


def maximum(function: Function, start: Floats, steps: Floats, free: NDArray[np.bool_]) -> Maximum:
    """Climb from `start` to a maximum by Newton's method, damped where it does not climb.

    Args:
        function: to be maximised.
        start: where the search begins.
        steps: sizes of first differences, of about a standard deviation or less.
        free: which parameters may change.
    """
    place, steps = start.copy(), steps.copy()
    chosen = np.flatnonzero(free)
    damping, value = 1e-3, float(function(place[None])[0])
    information = np.zeros((len(start), len(start)))
    for _ in range(_ROUNDS):
        gradient, information = derivatives(function, place, steps, chosen)
        inner = information[np.ix_(chosen, chosen)]
        # As if the function were concave in every direction: then each step climbs.
        curvatures, vectors = np.linalg.eigh(inner)
        sizes = np.maximum(np.abs(curvatures), 1e-12 * max(1.0, float(np.abs(curvatures).max())))
        along = vectors.T @ gradient[chosen]
        if 0.5 * float(np.sum(along**2 / sizes)) < _ENOUGH:
            if curvatures[0] > -1e-6 * sizes.max():
                break
            along[0] = sizes[0] ** 0.5  # a saddle: leave it downhill of its curvature
        while damping < 1e9:
            move = vectors @ (along / (sizes * (1 + damping)))
            tried = place.copy()
            tried[chosen] += move
            found = float(function(tried[None])[0])
            if found > value:
                break
            damping = max(10 * damping, 1e-2)
        else:
            break
        place, value = tried, found
        damping = 0.1 * damping if damping > 1e-4 else 0.0
        curved = np.abs(np.diag(information))
        own = _STEP / np.sqrt(np.maximum(curved, 1e-30))
        steps[chosen] = np.clip(own, 0.1 * steps, 10 * steps)[chosen]
    return Maximum(place, value, information, steps)


def derivatives(
    function: Function, place: Floats, steps: Floats, chosen: NDArray[np.intp]
) -> tuple[Floats, Floats]:
    """The gradient, and minus the second derivatives; 0 for parameters that are not `chosen`."""
    size, count = len(place), len(chosen)
    moves = np.zeros((count, size))
    moves[np.arange(count), chosen] = steps[chosen]
    one, other = np.triu_indices(count, 1)
    both = moves[one] + moves[other]
    values = function(place + np.vstack([np.zeros((1, size)), moves, -moves, both, -both]))
    middle, rest = values[0], values[1:]
    up, down, up_both, down_both = np.split(rest, [count, 2 * count, 2 * count + len(one)])
    gradient, information = np.zeros(size), np.zeros((size, size))
    gradient[chosen] = (up - down) / (2 * steps[chosen])
    information[chosen, chosen] = -(up - 2 * middle + down) / steps[chosen] ** 2
    mixed = up_both + down_both - (up + down)[one] - (up + down)[other] + 2 * middle
    first, second = chosen[one], chosen[other]
    information[first, second] = -mixed / (2 * steps[first] * steps[second])
    information[second, first] = information[first, second]
    return gradient, information


def interval(
    function: Function,
    best: Maximum,
    index: int,
    low: float,
    high: float,
    free: NDArray[np.bool_],
) -> tuple[float, float]:
    """The 95 % interval of one parameter, within its range.

    Args:
        function: the log-likelihood.
        best: its maximum.
        index: which parameter.
        low: end of the parameter's range.
        high: the other end.
        free: the parameters that are fitted.
    """
    others = free & (np.arange(len(free)) != index)
    return _end(function, best, index, low, others), _end(function, best, index, high, others)


def bootstrap(
    of_parts: Function, best: Maximum, groups: NDArray[np.intp], free: NDArray[np.bool_]
) -> Floats:
    """Estimates from groups of parts that are drawn with replacement.

    Each is one step of Newton's method from the maximum, with the gradient of the groups that were
    drawn: what the next steps would add is of higher order.

    Args:
        of_parts: sets of parameters → the log-likelihood of each part, in columns.
        best: where the sum is greatest.
        groups: the group of each part.
        free: the parameters that are fitted.

    Returns:
        One set of parameters in a row.
    """
    names = np.unique(groups)
    chosen = np.flatnonzero(free)
    moves = np.zeros((len(chosen), len(best.place)))
    moves[np.arange(len(chosen)), chosen] = best.steps[chosen]
    values = of_parts(np.vstack([best.place + moves, best.place - moves]))
    of_group = np.stack([values[:, groups == name].sum(axis=1) for name in names], axis=1)
    up, down = np.split(of_group, 2)
    scores = (up - down) / (2 * best.steps[chosen][:, None])
    shares = np.full(len(names), 1 / len(names))
    draws = np.random.default_rng(0).multinomial(len(names), shares, size=_DRAWS)
    inner = best.information[np.ix_(chosen, chosen)]
    found = np.tile(best.place, (_DRAWS, 1))
    found[:, chosen] += np.linalg.lstsq(inner, scores @ (draws - 1).T, rcond=1e-12)[0].T
    return found


def _end(
    function: Function, best: Maximum, index: int, limit: float, others: NDArray[np.bool_]
) -> float:
    """One end of the interval: the limit, if the likelihood there is still great enough."""
    centre = float(best.place[index])
    sense = math.copysign(1.0, limit - centre)
    information = best.information[np.ix_(others, others)]
    cross = best.information[others, index]
    tilt = np.linalg.lstsq(information, -cross, rcond=1e-12)[0]  # of the others along the profile
    spread = 1 / math.sqrt(max(best.information[index, index] + cross @ tilt, 1e-300))
    place, at = best.place.copy(), centre

    def depth(value: float) -> float:
        """How far the profile is below the maximum, as standard deviations."""
        nonlocal place, at
        tried = place.copy()
        tried[others] += tilt * (value - at)
        tried[index] = value
        found = maximum(function, tried, best.steps, others)
        place, at = found.place, value
        return math.sqrt(max(0.0, 2 * (best.value - found.value)))

    before, depth_before = centre, 0.0
    value = centre + sense * min(Z95 * spread, abs(limit - centre))
    for _ in range(_SECANTS):
        found = depth(value)
        if abs(found - Z95) < 0.02:
            return value
        if value == limit and found < Z95:
            return limit
        rise = (found - depth_before) / (value - before) if value != before else 0.0
        if rise * sense <= 0:  # flat so far
            following = centre + 2 * (value - centre)
        else:
            following = value + (Z95 - found) / rise
            following = centre + sense * min(
                max(abs(following - centre), 0.3 * abs(value - centre)), 4 * abs(value - centre)
            )
        if (limit - following) * sense < 0:
            following = limit
        if following == value:
            return value
        before, depth_before, value = value, found, following
    return value

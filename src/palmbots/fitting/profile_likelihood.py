# SPDX-License-Identifier: Apache-2.0
"""Greatest likelihood, and intervals from the profile of the likelihood.

An interval contains the values of a parameter at which the log-likelihood, maximised over all other
parameters, is less than half the 95 % quantile of χ² with one degree of freedom below its maximum
(Wilks). It needs no transformation that makes a parameter normal, and at the end of a parameter's
range it becomes a bound on one side.

The function gets many sets of parameters at once, because the overhead of a call exceeds the cost
of its computation. So searches run side by side: each one is a generator that yields the sets that
it needs next, and one call answers all of them. Derivatives are differences over a fraction of a
parameter's own standard deviation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from palmbots._types import Interval
from palmbots._util.confidence_intervals import Z95

T = TypeVar("T")
Floats = NDArray[np.float64]
Booleans = NDArray[np.bool_]
Function = Callable[[Floats], Floats]
"""Sets of parameters, one in a row → the log-likelihood of each."""
Search = Generator[Floats, Floats, T]
"""Yields sets of parameters, receives the log-likelihood of each, and returns what it found."""

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


def maxima(
    function: Function, starts: Sequence[tuple[Floats, Booleans]], steps: Floats
) -> list[Maximum]:
    """Climb from each start to a maximum by Newton's method, damped where it does not climb.

    Args:
        function: to be maximised.
        starts: where each search begins, and which parameters it may change.
        steps: sizes of first differences, of about a standard deviation or less.
    """
    return _together(function, [_climb(start, steps, free) for start, free in starts])


def _together(
    function: Function,
    searches: Sequence[Search[T]],
    on_progress: Callable[[float], None] = lambda part: None,
) -> list[T]:
    """Run searches side by side: each call of the function answers all that have not ended."""
    found: dict[int, T] = {}
    wanted = {number: next(search) for number, search in enumerate(searches)}
    while wanted:
        on_progress(len(found) / len(searches))
        values = function(np.concatenate([*wanted.values()]))
        ends = np.cumsum([len(sets) for sets in wanted.values()])
        for number, part in zip([*wanted], np.split(values, ends[:-1]), strict=True):
            try:
                wanted[number] = searches[number].send(part)
            except StopIteration as end:
                found[number] = end.value
                del wanted[number]
    return [found[number] for number in range(len(searches))]


def _climb(start: Floats, steps: Floats, free: Booleans) -> Search[Maximum]:
    place, steps = start.copy(), steps.copy()
    chosen = np.flatnonzero(free)
    damping = 1e-3
    value, gradient, information = yield from _derivatives(place, steps, chosen)
    for _ in range(_ROUNDS):
        inner = information[np.ix_(chosen, chosen)]
        # As if the function were concave in every direction: then each step climbs.
        curvatures, vectors = np.linalg.eigh(inner)
        sizes = np.maximum(np.abs(curvatures), 1e-12 * max(1.0, float(np.abs(curvatures).max())))
        along = vectors.T @ gradient[chosen]
        if 0.5 * float(np.sum(along**2 / sizes)) < _ENOUGH:
            if curvatures[0] > -1e-6 * sizes.max():
                break
            along[0] = sizes[0] ** 0.5  # a saddle: leave it downhill of its curvature
        curved = np.abs(np.diag(information))
        own = _STEP / np.sqrt(np.maximum(curved, 1e-30))
        following = steps.copy()
        following[chosen] = np.clip(own, 0.1 * steps, 10 * steps)[chosen]
        while damping < 1e5:
            move = vectors @ (along / (sizes * (1 + damping)))
            tried = place.copy()
            tried[chosen] += move
            found, *others = yield from _derivatives(tried, following, chosen)
            if found > value:
                break
            damping = max(10 * damping, 1.0)
        else:
            break
        place, value, steps = tried, found, following
        gradient, information = others
        damping = 0.1 * damping if damping > 1e-4 else 0.0
    return Maximum(place, value, information, steps)


def _derivatives(
    place: Floats, steps: Floats, chosen: NDArray[np.intp]
) -> Search[tuple[float, Floats, Floats]]:
    """The value, the gradient, and minus the second derivatives; 0 for parameters that are not
    `chosen`."""
    size, count = len(place), len(chosen)
    moves = np.zeros((count, size))
    moves[np.arange(count), chosen] = steps[chosen]
    one, other = np.triu_indices(count, 1)
    both = moves[one] + moves[other]
    values = yield place + np.vstack([np.zeros((1, size)), moves, -moves, both, -both])
    middle, rest = float(values[0]), values[1:]
    up, down, up_both, down_both = np.split(rest, [count, 2 * count, 2 * count + len(one)])
    gradient, information = np.zeros(size), np.zeros((size, size))
    gradient[chosen] = (up - down) / (2 * steps[chosen])
    information[chosen, chosen] = -(up - 2 * middle + down) / steps[chosen] ** 2
    mixed = up_both + down_both - (up + down)[one] - (up + down)[other] + 2 * middle
    first, second = chosen[one], chosen[other]
    information[first, second] = -mixed / (2 * steps[first] * steps[second])
    information[second, first] = information[first, second]
    return middle, gradient, information


def intervals(
    function: Function,
    best: Maximum,
    ranges: Sequence[Interval],
    free: Booleans,
    on_progress: Callable[[float], None] = lambda part: None,
) -> list[Interval]:
    """The 95 % interval of each parameter within its range; of one that is not fitted its value.

    Args:
        function: the log-likelihood.
        best: its maximum.
        ranges: both ends of each parameter's range.
        free: the parameters that are fitted.
        on_progress: called with the completed fraction.
    """
    ends = [(index, end) for index in np.flatnonzero(free).tolist() for end in ranges[index]]
    searches = [
        _end(best, index, end, free & (np.arange(len(free)) != index)) for index, end in ends
    ]
    found = [(float(value), float(value)) for value in best.place]
    bounds = _together(function, searches, on_progress)
    for (index, _), low, high in zip(ends[::2], bounds[::2], bounds[1::2], strict=True):
        found[index] = low, high
    return found


def bootstrap(
    of_parts: Function, best: Maximum, groups: NDArray[np.intp], free: Booleans
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


def _end(best: Maximum, index: int, limit: float, others: Booleans) -> Search[float]:
    """One end of the interval: the limit, if the likelihood there is still great enough."""
    centre = float(best.place[index])
    sense = math.copysign(1.0, limit - centre)
    information = best.information[np.ix_(others, others)]
    cross = best.information[others, index]
    tilt = np.linalg.lstsq(information, -cross, rcond=1e-12)[0]  # of the others along the profile
    spread = 1 / math.sqrt(max(best.information[index, index] + cross @ tilt, 1e-300))
    place, at = best.place.copy(), centre

    def depth(value: float) -> Search[float]:
        """How far the profile is below the maximum, as standard deviations."""
        nonlocal place, at
        tried = place.copy()
        tried[others] += tilt * (value - at)
        tried[index] = value
        found = yield from _climb(tried, best.steps, others)
        place, at = found.place, value
        return math.sqrt(max(0.0, 2 * (best.value - found.value)))

    before, depth_before = centre, 0.0
    value = centre + sense * min(Z95 * spread, abs(limit - centre))
    for _ in range(_SECANTS):
        found = yield from depth(value)
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

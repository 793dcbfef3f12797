# SPDX-License-Identifier: Apache-2.0
"""The exact likelihood of the packets that a link lost, under the scene's model of losses.

A link is dead for a share s of the time, in periods of mean length m (Gilbert 1960), and loses each
packet with the probability ℓ while it is not dead (Elliott 1963): include/palmbots/sim/
radio_channel.hpp. A packet that arrived shows that the link was not dead. So what happens between
two arrivals is independent of all before, and the numbers k of packets lost between two arrivals
are a sufficient statistic. With B = P diag(ℓ, 1), where P has the probabilities of the states not
dead and dead one interval later,

    f(k) = e₁ᵀ Bᵏ P e₁ (1 − ℓ).

The eigenvalues of B are real, so powers have a closed form, also for outages of 10⁵ packets.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from palmbots.fitting.profile_likelihood import Maximum, intervals, maxima

Floats = NDArray[np.float64]

_LEAST, _MOST = -16.0, 6.0  # of the logarithms of odds
_BURSTS = math.log(0.1), math.log(1e5)  # of the mean length, in intervals between packets
_STEPS = np.array([0.05, 0.05, 0.05])
_RANGES = ((_LEAST, _MOST), (_LEAST, 4.0), _BURSTS)


def burst_log_density(parameters: Floats, counts: Floats) -> Floats:
    """log f(k).

    Args:
        parameters: in each row logit ℓ, logit s and the logarithm of m, in intervals.
        counts: the numbers k.

    Returns:
        One row for each set of parameters, one column for each k.
    """
    loss, share, length = (one[:, None] for one in parameters.T)
    alone, dead = 1 / (1 + np.exp(-loss)), 1 / (1 + np.exp(-share))
    alive = 1 / (1 + np.exp(share))
    kept = np.exp(-np.exp(-length) / alive)
    falls, rises = dead * (1 - kept), alive * (1 - kept)
    # B = [[(1 − falls) ℓ, falls], [rises ℓ, 1 − rises]]
    first, second = (1 - falls) * alone, 1 - rises
    middle = 0.5 * (first + second)
    root = np.sqrt((0.5 * (first - second)) ** 2 + falls * rises * alone)
    great = middle + root
    small = np.where(great > 0, (first * second - falls * rises * alone) / great, 0.0)
    # e₁ᵀ Bᵏ v = c greatᵏ + d smallᵏ with v = P e₁ (1 − ℓ); its values at k = 0 and 1 give c and d.
    start = (1 - falls) / (1 + np.exp(loss))
    following = (first * (1 - falls) + falls * rises) / (1 + np.exp(loss))
    apart = np.maximum(great - small, 1e-300)
    of_great = (following - small * start) / apart
    of_small = (great * start - following) / apart
    with np.errstate(divide="ignore", under="ignore", invalid="ignore"):
        ratio = np.where(small > 0, small / great, 0.0) ** counts
        found = counts * np.log(great) + np.log(np.maximum(of_great + of_small * ratio, 1e-300))
    return np.where(counts == 0, np.log(np.maximum(start, 1e-300)), found)


class LossFit:
    """The fit of loss, share and length of bursts to numbers of packets lost between arrivals.

    Args:
        counts: different numbers k.
        times: how often each occurred.
    """

    def __init__(self, counts: Floats, times: Floats) -> None:
        self._counts, self._times = counts, times
        lost = float(counts @ times)
        self.rate = lost / (lost + float(times.sum()))
        self._free = np.ones(3, bool)
        self.best = self._maximum() if lost > 0 else None
        with np.errstate(divide="ignore"):
            alone = lost * np.log(self.rate) if lost > 0 else 0.0
        independent = float(alone + times.sum() * math.log1p(-self.rate))
        self.gain = 0.0 if self.best is None else max(0.0, self.best.value - independent)
        """By how much bursts raise the log-likelihood above that of independent losses."""

    def log_likelihood(self, parameters: Floats) -> Floats:
        """Of sets of parameters in rows, with a slope beyond their ranges."""
        low, high = np.array(_RANGES).T
        inside = np.clip(parameters, low, high)
        beyond = ((parameters - inside) ** 2).sum(axis=1)
        return burst_log_density(inside, self._counts) @ self._times - beyond

    def _maximum(self) -> Maximum:
        odds = math.log(self.rate / (1 - self.rate))
        starts = []
        for part in (-0.1, -3.0):  # of the losses that are single ones
            for length in (-0.5, 2.0):
                start = np.array([odds + part, odds + math.log(-math.expm1(part)), length])
                starts.append((np.clip(start, [-15, -15, -2], [5, 3, 9]), self._free))
        found = maxima(self.log_likelihood, starts, _STEPS)
        best = max(found, key=lambda one: one.value)
        low, high = np.array(_RANGES).T
        return Maximum(np.clip(best.place, low, high), best.value, best.information, best.steps)

    def values(self) -> list[tuple[float, float, float]]:
        """ℓ, s and m in intervals, each with its 95 % interval from the profile."""
        assert self.best is not None
        ends = intervals(self.log_likelihood, self.best, _RANGES, self._free)
        found = []
        for index, ((low, high), of) in enumerate(
            zip(ends, (_share, _share, math.exp), strict=True)
        ):
            bounds = [0.0 if low <= _LEAST and index < 2 else of(low), of(high)]
            value = float(self.best.place[index])
            found.append((0.0 if value <= _LEAST + 4 and index < 2 else of(value), *bounds))
        return [(float(value), float(low), float(high)) for value, low, high in found]


def _share(odds: float) -> float:
    return 1 / (1 + math.exp(-odds))

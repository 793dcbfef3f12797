# SPDX-License-Identifier: Apache-2.0
"""The exact likelihood of positions of a robot that drives straight.

The model is that of simulated robots (docs/guide/scenes.md), in continuous time. On a
stretch with the mean commanded speed u the displacement s [m] obeys

    ds = (G u + b + n) dt + q dW,   dn = −n dt/τ + σ √(2/τ) dV,   y = s + m ε,

with a gain G that is drawn once for the stretch, the bias b and a noise n that is stationary, with
the deviation σ and the correlation time τ; q is the white part and m the deviation of the position
noise. V and W are independent Wiener processes, ε is standard normal. All of it is Gaussian, so a
Kalman filter with the states displacement and n gives the likelihood without an approximation: the
transitions have closed forms for any time step. The speed v = G u + b is constant on a
stretch, so y is v t plus a part without v, and the filter is linear in y: it filters positions and
times, each for itself. Where the command changes within a stretch, its displacement at the speed 1
takes the place of t. Their errors y_k and t_k, with variances T_k, make the likelihood a normal
function of v, with the coefficients Σ y_k²/T_k, Σ y_k t_k/T_k and Σ t_k²/T_k. The gain is
integrated out of it. The place at which a stretch begins has a flat prior, so the first position
has no density in it.

A simulated robot keeps n for a control period h. Its displacements then have the covariances above
but for terms of (h/τ)²/12, and σ² h²/(3τ) is added to q².

While a robot stands, the noise n goes on without moving it. Controllers often stop a robot that is
too fast, so n is not stationary when it starts again. The stretches of a robot between which it
stands are therefore a *chain* with one gain, through which the filter keeps n.

The filter is compiled: include/palmbots/robot/displacement_filter.hpp.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palmbots import _core as core

Floats = NDArray[np.float64]

PARAMETERS = ("gain", "bias_m_s", "gain_sd", "noise_m_s", "log_tau", "white", "position_noise_m")
"""Columns of a set of parameters. Deviations may be negative: their sign has no meaning."""

_LEAST_M = 1e-8
"""Least measurement noise [m], far below that of any instrument: a density stays finite."""
_DIGITS = 9  # of a time step in seconds: the rest is rounding


@dataclass(frozen=True)
class Stretch:
    """Positions of a robot on a straight stretch, on which it never stands."""

    times_s: Floats
    positions_m: Floats
    """Along the heading, from any origin."""
    commanded_m: Floats
    """Where the commands alone would have moved it, from any origin."""
    run: int
    """Number of the recording: stretches of one run may have something in common."""
    curvature_rad_m: float = math.nan
    """By how much the robot turned beyond its command, over its displacement; NaN: unknown."""
    stood_s: float = math.nan
    """How long the robot has stood since the stretch before this one, which the noise may outlast;
    NaN: no such stretch is known."""
    held_s: float = 0.0
    """How long the noise keeps a value: a control period of a simulation; 0 for real robots."""
    is_exact: bool = False
    """Whether the positions are the true ones: they have no noise of their own."""
    is_short: bool = False
    """Whether it serves only the likelihood, together with those before and after it."""

    @property
    def command_m_s(self) -> float:
        """The mean command."""
        return _mean_speed(self.commanded_m, self.times_s)

    @property
    def speed_m_s(self) -> float:
        """The mean speed."""
        return _mean_speed(self.positions_m, self.times_s)


def _mean_speed(places_m: Floats, times_s: Floats) -> float:
    return float((places_m[-1] - places_m[0]) / (times_s[-1] - times_s[0]))


def chains_of(stretches: Sequence[Stretch]) -> list[list[Stretch]]:
    """Stretches grouped by chain; without the chains that have only short ones."""
    chains: list[list[Stretch]] = []
    for one in stretches:
        if math.isnan(one.stood_s) or not chains:
            chains.append([])
        chains[-1].append(one)
    return [chain for chain in chains if not all(one.is_short for one in chain)]


class Stretches:
    """Chains of stretches as arrays."""

    def __init__(self, stretches: Sequence[Stretch]) -> None:
        self.chains = chains_of(stretches)
        self.lengths = np.array([sum(len(one.times_s) for one in chain) for chain in self.chains])
        shape = len(self.chains), int(self.lengths.max())
        self._steps = np.zeros(shape)
        self._starts = np.zeros(shape, bool)
        """Where a stretch begins: the noise has gone on, the place is new."""
        # What is filtered: displacements beyond the commanded ones, and times.
        self._measured = np.zeros((*shape, 2))
        self._commands = np.zeros(shape[0])
        for row, chain in enumerate(self.chains):
            way = sum(one.commanded_m[-1] - one.commanded_m[0] for one in chain)
            self._commands[row] = way / sum(one.times_s[-1] - one.times_s[0] for one in chain)
            first = 0
            for one in chain:
                places = np.s_[row, first : first + len(one.times_s)]
                self._steps[places] = np.diff(one.times_s, prepend=one.times_s[0] - one.stood_s)
                self._starts[row, first] = True
                commanded = one.commanded_m - one.commanded_m[0]
                moved = one.positions_m - one.positions_m[0] - commanded
                self._measured[places] = np.column_stack([moved, commanded / self._commands[row]])
                first += len(one.times_s)
        self._steps = np.round(self._steps, _DIGITS)
        self._held = np.array([chain[0].held_s for chain in self.chains])
        self.runs = np.array([chain[0].run for chain in self.chains])

    def log_likelihood(self, parameters: Floats) -> Floats:
        """The log-likelihood of each chain under each set of parameters.

        Args:
            parameters: one set in a row, with the columns `PARAMETERS`.

        Returns:
            One row for each set, one column for each chain.
        """
        sets = np.atleast_2d(parameters)
        # Sets that differ in the gain or in the bias only have one filter.
        alike, which = np.unique(_of_filter(sets), axis=0, return_inverse=True)
        logs, squares, mixed, weights = self._filtered(alike)[0][:, which.ravel()]
        mean, variance = self._speeds(sets)
        rest = squares - mean * (2 * mixed - mean * weights)
        spread = 1 + variance * weights
        known = variance / spread * (mixed - mean * weights) ** 2
        return -0.5 * (logs + rest + np.log(spread) - known)

    def residuals(self, parameters: Floats) -> list[Floats]:
        """What each chain deviates from the prediction of the filter, in standard deviations, from
        the second position of each stretch on: independent and standard normal where the model is
        right."""
        sets = np.atleast_2d(parameters)
        errors = self._filtered(_of_filter(sets))[1]
        found = []
        for row, (mean, variance) in enumerate(np.stack(self._speeds(sets))[:, 0].T):
            places = np.flatnonzero(~self._starts[row, : self.lengths[row]])
            total, moved, time = errors[row, places].T
            # The speed as it is known from the positions before.
            mixed, weights = (
                np.cumsum(one) - one for one in (moved * time / total, time * time / total)
            )
            spread = variance / (1 + variance * weights)
            speed = mean + spread * (mixed - mean * weights)
            found.append((moved - speed * time) / np.sqrt(total + spread * time * time))
        return found

    def _speeds(self, sets: Floats) -> tuple[Floats, Floats]:
        """Mean and variance of the speed of each chain, beyond the command."""
        gain, bias, gain_sd = sets.T[:3, :, None]
        return (gain - 1) * self._commands + bias, (gain_sd * self._commands) ** 2

    def _filtered(self, sets: Floats) -> tuple[Floats, Floats]:
        """Σ log 2πT, Σ y²/T, Σ y t/T and Σ t²/T of each set and chain; T, y and t of the first set,
        for each chain and position.

        Args:
            sets: rows of `_of_filter`.
        """
        models = np.repeat(sets[None], len(self.chains), axis=0)
        tau, variance = np.exp(models[..., 0]), models[..., 1]
        models[..., 0] = tau
        models[..., 2] += variance * self._held[:, None] ** 2 / (3 * tau)
        sums, errors = core.filter_displacements(
            models, self._steps, self._measured, self._starts, self.lengths
        )
        sums[0] += np.log(2 * np.pi) * (self.lengths - self._starts.sum(axis=1))
        return sums, errors


def _of_filter(sets: Floats) -> Floats:
    """What the filter depends on: log τ, and the variances of n, of the white part and of the
    position noise."""
    squared = sets[:, [3, 5, 6]] ** 2 + [0.0, 0.0, _LEAST_M**2]
    return np.column_stack([sets[:, 4], squared])

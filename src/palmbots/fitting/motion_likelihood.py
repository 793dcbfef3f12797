# SPDX-License-Identifier: Apache-2.0
"""The exact likelihood of positions of a robot that drives straight at a constant commanded speed.

The model is that of simulated robots (docs/guide/scenes.md), in continuous time. On a
stretch with the commanded speed u the displacement s [m] obeys

    ds = (G u + b + n) dt + q dW,   dn = −n dt/τ + σ √(2/τ) dV,   y = s + m ε,

with a gain G that is drawn once for the stretch, the bias b and a noise n that is stationary, with
the deviation σ and the correlation time τ; q is the white part and m the deviation of the position
noise. V and W are independent Wiener processes, ε is standard normal. All of it is Gaussian, so a
Kalman filter with the states displacement, n and deviation of the gain gives the likelihood without
an approximation: the transitions have closed forms for any time step. The place at which a stretch
begins has a flat prior, so the first position has no density in it.

Many stretches, and many sets of parameters, are filtered side by side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

PARAMETERS = ("gain", "bias_m_s", "gain_sd", "noise_m_s", "log_tau", "white", "position_noise_m")
"""Columns of a set of parameters. Deviations may be negative: their sign has no meaning."""

_LEAST_M = 1e-8
"""Least measurement noise [m], far below that of any instrument: a density stays finite."""


@dataclass(frozen=True)
class Stretch:
    """Positions of a robot on a straight stretch with a constant command."""

    times_s: Floats
    positions_m: Floats
    """Along the heading, from any origin."""
    command_m_s: float
    run: int
    """Number of the recording: stretches of one run may have something in common."""


class Stretches:
    """Stretches as arrays, the longest first, so that those that have ended are a tail."""

    def __init__(self, stretches: Sequence[Stretch]) -> None:
        ordered = sorted(stretches, key=lambda one: -len(one.times_s))
        self.lengths = np.array([len(one.times_s) for one in ordered])
        shape = len(ordered), int(self.lengths.max())
        self._steps, self._positions = np.zeros(shape), np.zeros(shape)
        for row, one in enumerate(ordered):
            size = len(one.times_s)
            self._steps[row, 1:size] = np.diff(one.times_s)
            self._positions[row, :size] = one.positions_m - one.positions_m[0]
        self._commands = np.array([one.command_m_s for one in ordered])
        self.runs = np.array([one.run for one in ordered])
        self.stretches = ordered

    def log_likelihood(self, parameters: Floats) -> Floats:
        """The log-likelihood of each stretch under each set of parameters.

        Args:
            parameters: one set in a row, with the columns `PARAMETERS`.

        Returns:
            One row for each set, one column for each stretch.
        """
        return self._filtered(np.atleast_2d(parameters))[0]

    def residuals(self, parameters: Floats) -> list[Floats]:
        """What each stretch deviates from the prediction of the filter, in standard deviations,
        from the second position on: independent and standard normal where the model is right."""
        _, errors = self._filtered(np.atleast_2d(parameters), keep=True)
        return [row[1:size] for row, size in zip(errors.T, self.lengths, strict=True)]

    def _filtered(self, parameters: Floats, keep: bool = False) -> tuple[Floats, Floats]:
        gain, bias, gain_sd, sigma, log_tau, white, measured = parameters.T[:, :, None]
        tau, variance, diffusion = np.exp(log_tau), sigma**2, white**2
        of_position = measured**2 + _LEAST_M**2
        commands = self._commands
        drift = gain * commands + bias
        shape = drift.shape
        # States: displacement s from the first measured position, n, and the deviation g of the
        # speed by the gain. The covariance has six different elements.
        s, n, g, sn, sg, ng = (np.zeros(shape) for _ in range(6))
        ss, nn = (np.broadcast_to(one, shape).copy() for one in (of_position, variance))
        gg = (gain_sd * commands) ** 2
        found = np.zeros(shape)
        errors = np.zeros((self._steps.shape[1], shape[1])) if keep else np.zeros(0)
        for k in range(1, self._steps.shape[1]):
            live = int(np.searchsorted(-self.lengths, -k, side="left"))
            if live < s.shape[1]:
                s, n, g, ss, sn, sg, nn, ng, gg, drift = (
                    one[:, :live] for one in (s, n, g, ss, sn, sg, nn, ng, gg, drift)
                )
            h = self._steps[:live, k]
            # Over the step h: n decays by a = e^(−h/τ) and adds c n to s.
            x = h / tau
            lost = -np.expm1(-x)
            a, c = 1 - lost, tau * lost
            short = x * x * x * (2 / 3 - x * (0.5 - x * (7 / 30)))  # the same, without rounding
            added = np.where(x < 1e-2, short, 2 * x - lost * (2 + lost))
            s = s + c * n + h * (g + drift)
            n = a * n
            of_s = sn + c * nn + h * ng
            of_g = sg + c * ng + h * gg
            ss = ss + c * (sn + of_s) + h * (sg + of_g)
            ss = ss + variance * tau * tau * added + diffusion * h
            sn = a * of_s + variance * tau * lost * lost
            sg, ng = of_g, a * ng
            nn = a * a * nn + variance * lost * (1 + a)
            # The position is measured.
            total = ss + of_position
            error = self._positions[:live, k] - s
            found[:, :live] -= 0.5 * (np.log(2 * np.pi * total) + error * error / total)
            if keep:
                errors[k, :live] = (error / np.sqrt(total))[0]
            for_s, for_n, for_g = ss / total, sn / total, sg / total
            s, n, g = s + for_s * error, n + for_n * error, g + for_g * error
            nn, ng, gg = nn - for_n * sn, ng - for_n * sg, gg - for_g * sg
            ss, sn, sg = ss - for_s * ss, sn - for_s * sn, sg - for_s * sg
        return found, errors

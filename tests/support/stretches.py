# SPDX-License-Identifier: Apache-2.0
"""Stretches of a robot, drawn from the closed-form covariance of the model, and fits of them."""

from dataclasses import dataclass

import numpy as np

from palmbots.fitting.motion_estimates import fit_stretches
from palmbots.fitting.motion_likelihood import Floats, Stretch

# Gain, bias, spread of the gain, σ, log τ, white part, noise of the positions.
TRUTH = np.array([1.03, 0.001, 0.03, 0.004, np.log(0.5), 0.002, 0.0005])


def covariance(times: Floats, command: float, parameters: Floats) -> Floats:
    """Of the displacements at these times, from the integrals of the processes."""
    _, _, gain_sd, sigma, log_tau, white, measured = parameters
    tau = np.exp(log_tau)
    one, other = times[:, None], times[None, :]
    least = np.minimum(one, other)
    decayed = 1 + np.exp(-np.abs(one - other) / tau) - np.exp(-one / tau) - np.exp(-other / tau)
    of_noise = sigma**2 * tau * (2 * least - tau * decayed)
    of_gain = (gain_sd * command) ** 2 * one * other
    return of_noise + of_gain + white**2 * least + measured**2 * np.eye(len(times))


def drawn(
    random: np.random.Generator, count: int, parameters: Floats = TRUTH, runs: int = 1
) -> list[Stretch]:
    """Stretches from that covariance, at irregular times."""
    found = []
    for k in range(count):
        times = np.cumsum(np.concatenate([[0.0], random.uniform(0.05, 0.3, 15 + k % 5)]))
        command = random.uniform(0.03, 0.09)
        mean = (parameters[0] * command + parameters[1]) * times
        spread = covariance(times, command, parameters)
        positions = random.multivariate_normal(mean, spread, method="cholesky")
        found.append(Stretch(times, positions + random.normal(), command * times, k % runs))
    return found


@dataclass(frozen=True)
class Coverage:
    """Of many fits with hidden values."""

    fits: int
    covered: dict[str, int]
    """By key: fits whose interval contains the hidden value."""
    unidentified: dict[str, int]
    """By key: fits that do not identify it. They are not among those that cover it."""


def coverage(fits: int, count: int, hidden: Floats = TRUTH, first_seed: int = 0) -> Coverage:
    """How often the 95 % intervals contain the hidden values.

    Args:
        fits: number of fits.
        count: of stretches in each.
        hidden: values of the parameters.
        first_seed: of the random numbers; the next fit has the next seed.
    """
    truth = hidden.copy()
    truth[4] = np.exp(truth[4])
    covered: dict[str, int] = {}
    unidentified: dict[str, int] = {}
    for seed in range(first_seed, first_seed + fits):
        found = fit_stretches(drawn(np.random.default_rng(seed), count, hidden)).estimates
        for one, value in zip(found[:7], truth, strict=True):
            covered.setdefault(one.key, 0)
            unidentified.setdefault(one.key, 0)
            if not one.is_identified or one.low is None or one.high is None:
                unidentified[one.key] += 1
            else:
                covered[one.key] += bool(one.low <= value <= one.high)
    return Coverage(fits, covered, unidentified)

# SPDX-License-Identifier: Apache-2.0
"""The filter of displacements against the dense covariance of the distances between positions."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from palmbots.fitting.motion_likelihood import Floats, Stretch, Stretches
from sampled import sampled


def random_chain(random: np.random.Generator, *, changes: bool) -> list[Stretch]:
    """Up to four stretches between which the robot stands; the command changes within them if
    `changes`. Any positions have a likelihood, so these are not drawn from the model."""
    chain, speed = list[Stretch](), random.uniform(0.03, 0.09)
    for number in range(random.integers(1, 5)):
        size = random.integers(2, 9)
        steps = random.choice([0.01, 0.02, 0.1, random.uniform(0.005, 0.5)], size - 1)
        times = random.uniform(0, 5) + np.cumsum([0.0, *steps])
        speeds = random.uniform(0.03, 0.09, size - 1) if changes else np.full(size - 1, speed)
        commanded = random.normal() + np.cumsum([0.0, *(speeds * steps)])
        moved = commanded + np.cumsum(random.normal(0, 0.003, size)) + random.normal()
        stood = random.choice([1e-3, 0.05, 1.0, 300.0]) if number else np.nan
        chain.append(Stretch(times, moved, commanded, 0, stood_s=float(stood)))
    return chain


def dense(chain: list[Stretch], parameters: Floats) -> float:
    """The log-likelihood of all distances between neighbouring positions of the stretches, which
    together have a normal distribution."""
    gain, bias, gain_sd, sigma, log_tau, white, measured = parameters
    tau = np.exp(log_tau)
    way = sum(one.commanded_m[-1] - one.commanded_m[0] for one in chain)
    speed = way / sum(one.times_s[-1] - one.times_s[0] for one in chain)
    begins, ends, commands, moves, apart = [], [], [], [], []
    end = 0.0
    for one in chain:
        times = one.times_s - one.times_s[0] + (end + one.stood_s if begins else 0.0)
        end = times[-1]
        begins += [*times[:-1]]
        ends += [*times[1:]]
        commands += [*np.diff(one.commanded_m)]
        moves += [*np.diff(one.positions_m)]
        apart.append(np.diff(np.eye(len(times)), axis=0))

    def twice(lag: Floats) -> Floats:
        """Twice the integral of the covariance of the noise."""
        return sigma**2 * tau**2 * (np.exp(-np.abs(lag) / tau) + np.abs(lag) / tau)

    first, last, command = np.array(begins), np.array(ends), np.array(commands)
    since = np.subtract.outer
    of_noise = twice(since(last, first)) + twice(since(first, last))
    of_noise -= twice(since(last, last)) + twice(since(first, first))
    spread = of_noise + gain_sd**2 * np.outer(command, command)
    spread += np.diag(white**2 * (last - first))
    row = 0
    for differences in apart:
        rows = slice(row, row + len(differences))
        spread[rows, rows] += (measured**2 + 1e-16) * differences @ differences.T
        row = rows.stop
    # Of one command, the bias moves the robot by b t.
    mean = (gain + bias / speed) * command
    return float(multivariate_normal(mean, spread).logpdf(moves))


@pytest.mark.parametrize("changes", [False, True])
@pytest.mark.parametrize("position_noise_m", [0.0, 0.0004])
@pytest.mark.parametrize("seed", sampled(range(200), 10))
def test_the_filter_gives_the_density_of_the_distances(
    seed: int, position_noise_m: float, changes: bool
) -> None:
    random = np.random.default_rng([seed, changes])
    chains = [random_chain(random, changes=changes) for _ in range(3)]
    parameters = np.array([
        random.uniform(0.9, 1.1), random.normal(0, 0.003), random.choice([0.0, 0.05]),
        random.choice([0.0, 0.004, 0.03]), np.log(random.choice([0.05, 0.5, 20.0])),
        random.choice([0.0005, 0.005]), position_noise_m,
    ])  # fmt: skip
    together = Stretches([one for chain in chains for one in chain])
    found = together.log_likelihood(parameters)[0]
    distances = [sum(len(one.times_s) - 1 for one in chain) for chain in chains]
    assert [len(one) for one in together.residuals(parameters)] == distances
    wanted = [dense(chain, parameters) for chain in chains]
    assert found == pytest.approx(wanted, rel=1e-6, abs=1e-5)

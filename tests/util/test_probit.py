# SPDX-License-Identifier: Apache-2.0
"""The probit fit against SciPy's general minimizer, and its interval against a known crossing."""

import math

import numpy as np
import pytest
from scipy import optimize, stats

from palmbots._util.probit import Counts, crossing, information

RATE = 0.01
TARGET = float(stats.norm.ppf(RATE))


def negative_log_likelihood(counts: Counts, place: float, slope: float) -> float:
    rate = stats.norm.cdf(TARGET + slope * (np.asarray(counts.x) - place))
    return -float(np.sum(stats.binom.logpmf(counts.events, counts.n, rate)))


def drawn(rng: np.random.Generator, place: float, slope: float, n: int, half: float) -> Counts:
    x = np.linspace(-half, half, 5)
    rate = stats.norm.cdf(TARGET + slope * (x - place))
    return Counts(list(x), [n] * 5, [int(k) for k in rng.binomial(n, rate)])


@pytest.mark.parametrize("seed", range(4))
def test_fit_and_interval_are_those_of_a_general_minimizer(seed: int) -> None:
    """The crossing, the slope, and both ends, where the profile likelihood has fallen by 1.92."""
    counts = drawn(np.random.default_rng(seed), 0.02, 4.0, 5000, 0.1)
    found = crossing(counts, RATE)
    assert found is not None
    best = optimize.minimize(
        lambda v: negative_log_likelihood(counts, *v), [0.0, 3.0], method="Nelder-Mead",
        options={"xatol": 1e-8, "fatol": 1e-10},
    )  # fmt: skip
    assert (found.x, found.slope) == pytest.approx(tuple(best.x), rel=1e-3, abs=1e-6)

    def excess(place: float) -> float:
        profile = optimize.minimize_scalar(
            lambda slope: negative_log_likelihood(counts, place, slope), (1.0, 8.0)
        )
        return 2 * (profile.fun - best.fun) - stats.chi2.ppf(0.95, 1)

    width = found.high - found.low
    for end in (found.low, found.high):
        assert excess(end) == pytest.approx(0, abs=0.02)
    assert width == pytest.approx(2 * 1.96 / (4 * math.sqrt(25_000 * information(RATE))), rel=0.5)


@pytest.mark.slow
def test_interval_covers_a_known_crossing_in_95_percent() -> None:
    """250 samples whose window misses the crossing by up to a third: 95 % ± 4 standard errors."""
    rng = np.random.default_rng(1)
    covered = 0
    for _ in range(250):
        place = rng.uniform(-0.03, 0.03)
        found = crossing(drawn(rng, place, 4.0, 1500, 0.09), RATE)
        assert found is not None
        covered += found.low <= place <= found.high
    assert abs(covered / 250 - 0.95) < 4 * math.sqrt(0.95 * 0.05 / 250)


def test_information_is_the_curvature_of_the_likelihood() -> None:
    for rate in (0.001, 0.01, 0.3, 0.5):
        z, h = float(stats.norm.ppf(rate)), 1e-3

        def expected(at: float, rate: float = rate) -> float:
            return float(rate * stats.norm.logcdf(at) + (1 - rate) * stats.norm.logsf(at))

        curvature = (expected(z + h) - 2 * expected(z) + expected(z - h)) / h**2
        assert information(rate) == pytest.approx(-curvature, rel=1e-4)


def test_counts_that_do_not_grow_have_no_crossing() -> None:
    assert crossing(Counts([0.0, 0.1, 0.2], [400] * 3, [5, 4, 3]), RATE) is None
    assert crossing(Counts([0.0, 0.1], [400] * 2, [0, 0]), RATE) is None
    flat = crossing(Counts([0.0, 0.1, 0.2], [400] * 3, [4, 4, 5]), RATE)
    assert flat is not None and flat.high - flat.low > 1


def test_counts_that_are_separated_have_a_crossing_between() -> None:
    found = crossing(Counts([0.0, 0.1, 0.2], [400] * 3, [0, 0, 400]), RATE)
    assert found is not None and 0.1 < found.low < found.x < found.high < 0.2

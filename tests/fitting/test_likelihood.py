# SPDX-License-Identifier: Apache-2.0
"""The likelihood of noise that is held, the search and the intervals, against SciPy and closed
forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, minimize
from scipy.stats import chi2, kstest, multivariate_normal

from palmbots.fitting.fitted_values import FittedPart
from palmbots.fitting.motion_estimates import displacement_variance, fit_stretches
from palmbots.fitting.motion_likelihood import Floats, Stretch, Stretches
from palmbots.fitting.profile_likelihood import Function, bootstrap, intervals, maxima
from stretches import TRUTH, covariance, drawn

STEPS = np.array([0.003, 2e-4, 0.003, 4e-4, 0.1, 2e-4, 5e-5])


def of(stretches: list[Stretch]) -> Function:
    arrays = Stretches(stretches)
    return lambda parameters: arrays.log_likelihood(parameters).sum(axis=1)


def test_noise_that_is_held_has_the_covariance_of_its_sums() -> None:
    """A simulated robot keeps its noise for a control period: against the covariance of the sums of
    an autoregressive process. As if it were not held, the likelihood is another one."""
    held_s, size = 0.01, 60
    parameters = np.array([1.0, 0.0, 0.0, 0.02, np.log(0.3), 0.0001, 1e-7])
    lags = np.abs(np.subtract.outer(np.arange(size), np.arange(size)))
    spread = 0.02**2 * held_s**2 * np.exp(-lags * held_s / 0.3)
    spread += 0.0001**2 * held_s * np.eye(size)
    moved = np.random.default_rng(0).multivariate_normal(np.zeros(size), spread)
    times = np.linspace(0.0, held_s * size, size + 1)
    one = Stretch(times, np.concatenate([[0.0], np.cumsum(0.06 * held_s + moved)]), 0.06 * times, 0)
    wanted = multivariate_normal(np.zeros(size), spread).logpdf(moved)
    held = Stretches([replace(one, held_s=held_s)]).log_likelihood(parameters)[0, 0]
    assert held == pytest.approx(wanted, abs=0.02)
    assert abs(Stretches([one]).log_likelihood(parameters)[0, 0] - wanted) > 0.5


def test_many_stretches_and_sets_are_filtered_as_one() -> None:
    stretches = drawn(np.random.default_rng(2), 7)
    sets = np.stack([TRUTH, TRUTH * 1.1])
    together = Stretches(stretches)
    found = together.log_likelihood(sets)
    for column, (stretch,) in enumerate(together.chains):
        for row, one in enumerate(sets):
            alone = Stretches([stretch]).log_likelihood(one)[0, 0]
            assert found[row, column] == pytest.approx(alone, abs=1e-8)


def test_residuals_of_the_right_model_are_standard_normal() -> None:
    """One sample has a p-value below 0.01 in one of 100 cases, so those of many samples are looked
    at together: they are uniformly distributed."""
    chances, correlations = [], []
    for seed in range(20):
        stretches = drawn(np.random.default_rng(seed), 30)
        residuals = np.concatenate(Stretches(stretches).residuals(TRUTH))
        chances.append(kstest(residuals, "norm").pvalue)
        of_next = np.corrcoef(residuals[1:], residuals[:-1])[0, 1]
        correlations.append(of_next * np.sqrt(len(residuals)))
    assert kstest(chances, "uniform").pvalue > 0.01
    assert kstest(correlations, "norm").pvalue > 0.01


def test_the_spread_of_the_displacement_has_its_closed_form() -> None:
    times = np.array([0.3, 1.0, 2.5])
    found = displacement_variance(TRUTH, times, np.full(3, 0.06**2))
    for time, value in zip(times, found, strict=True):
        whole = covariance(np.array([0.0, time]), 0.06, TRUTH)
        assert value == pytest.approx(whole[0, 0] + whole[1, 1] - 2 * whole[0, 1], rel=1e-9)


def test_the_search_finds_what_scipy_finds() -> None:
    function = of(drawn(np.random.default_rng(4), 15))
    start = TRUTH * [1.05, 0, 0.5, 0.5, 0.5, 0.5, 2]
    [found] = maxima(function, [(start, np.ones(7, bool))], STEPS)
    scale = STEPS * 10
    other = minimize(
        lambda x: -float(function((x * scale)[None])[0]), TRUTH / scale, method="Nelder-Mead",
        options={"maxiter": 1500, "xatol": 1e-3, "fatol": 1e-4, "adaptive": True},
    )  # fmt: skip
    assert found.value >= -other.fun - 2e-3
    assert found.value == pytest.approx(-other.fun, abs=0.05)


def test_a_search_leaves_a_saddle() -> None:
    """The likelihood is even in a standard deviation, so at 0 its slope is 0."""

    def function(x: Floats) -> Floats:
        return -((x[:, 0] ** 2 - 1) ** 2) - (x[:, 1] - 2) ** 2

    [found] = maxima(function, [(np.zeros(2), np.ones(2, bool))], np.array([0.1, 0.1]))
    assert np.abs(found.place) == pytest.approx([1.0, 2.0], abs=0.03)


def test_intervals_of_a_normal_sample_are_those_of_the_likelihood_ratio() -> None:
    """Mean and standard deviation of 30 numbers: the profile has a closed form."""
    sample = np.random.default_rng(5).normal(3.0, 2.0, 30)
    size, mean, variance = len(sample), sample.mean(), sample.var()

    def function(x: Floats) -> Floats:
        spread = ((sample - x[:, :1]) ** 2).sum(axis=1)
        return -size * np.log(np.abs(x[:, 1])) - spread / (2 * x[:, 1] ** 2)

    free = np.ones(2, bool)
    [best] = maxima(function, [(np.array([2.0, 1.0]), free)], np.array([0.1, 0.1]))
    assert best.place == pytest.approx([mean, np.sqrt(variance)], abs=0.02)
    level = chi2.ppf(0.95, 1)
    half = np.sqrt(variance * (np.exp(level / size) - 1))
    found, of_deviation = intervals(function, best, [(-np.inf, np.inf), (0.0, np.inf)], free)
    assert found == pytest.approx((mean - half, mean + half), rel=0.02)

    def depth(s: float) -> float:
        return (
            2 * size * np.log(s) + size * variance / s**2 - size * np.log(variance) - size - level
        )

    ends = [brentq(depth, 0.3 * s, s) if low else brentq(depth, s, 3 * s)
            for s in [np.sqrt(variance)] for low in (True, False)]  # fmt: skip
    assert of_deviation == pytest.approx(ends, rel=0.02)


def fisher_errors(stretches: list[Stretch], place: Floats) -> Floats:
    """Standard errors from Fisher's information of normal distributions with the closed-form
    covariance."""
    size = len(place)
    information = np.zeros((size, size))
    for one in stretches:
        apart = np.diff(np.eye(len(one.times_s)), axis=0)

        def mean(p: Floats, one: Stretch = one, apart: Floats = apart) -> Floats:
            return apart @ ((p[0] * one.command_m_s + p[1]) * one.times_s)

        def spread(p: Floats, one: Stretch = one, apart: Floats = apart) -> Floats:
            return apart @ covariance(one.times_s, one.command_m_s, p) @ apart.T

        moves = np.diag(0.01 * STEPS)
        means = [(mean(place + m) - mean(place - m)) / (2 * m.sum()) for m in moves]
        spreads = [(spread(place + m) - spread(place - m)) / (2 * m.sum()) for m in moves]
        weight = np.linalg.inv(spread(place))
        weighted = [weight @ each for each in spreads]
        information += [[a @ weight @ b for a in means] for b in means]
        information += [[0.5 * np.trace(a @ b) for a in weighted] for b in weighted]
    return np.sqrt(np.diag(np.linalg.inv(information)))


def test_a_fit_is_as_sure_as_its_data() -> None:
    """Intervals of few data are as wide as those of Fisher's information within a third, and those
    of gain and bias, of which the mean is linear, within 5 %."""
    stretches = drawn(np.random.default_rng(3), 60)
    found = fit_stretches(stretches).estimates[: len(TRUTH)]
    rows = np.array([(one.value, one.low, one.high) for one in found], float)
    rows[4] = np.log(rows[4])
    widths = (rows[:, 2] - rows[:, 1]) / (2 * 1.96 * fisher_errors(stretches, rows[:, 0]))
    assert widths[:2] == pytest.approx(1, abs=0.05)
    assert widths == pytest.approx(1, abs=0.35)


def test_an_interval_ends_where_the_range_ends() -> None:
    stretches = drawn(np.random.default_rng(6), 40, TRUTH * [1, 1, 1, 1, 1, 0, 1])
    function, free = of(stretches), np.ones(7, bool)
    [best] = maxima(function, [(TRUTH, free)], STEPS)
    best.place[5] = abs(best.place[5])
    ranges = [*[(-10.0, 10.0)] * 5, (0.0, 1.0), (-10.0, 10.0)]
    low, high = intervals(function, best, ranges, free)[5]
    assert low == 0.0
    assert 0 < high < 0.003


@pytest.mark.parametrize(
    ("tau_s", "noise_m_s", "remark"),
    [
        (8.0, 0.008, "it is at least 1.3 s; 1.5 s is the longest that the stretches show"),
        (0.03, 0.03, "it is at most 0.13 s; 0.05 s is the shortest that the fit tries"),
        (0.5, 0.008, ""),
    ],
)
def test_a_correlation_time_at_a_limit_of_the_search_says_so(
    tau_s: float, noise_m_s: float, remark: str
) -> None:
    hidden = np.array([1.03, 0.001, 0.03, noise_m_s, np.log(tau_s), 0.0, 1e-4])
    estimates = fit_stretches(drawn(np.random.default_rng(0), 60, hidden)).estimates
    noise, tau = estimates[3:5]
    assert tau.is_identified and tau.remark == remark
    assert noise.remark == (f"for a correlation time of {tau.value:.2g} s" if remark else "")
    part = FittedPart((), estimates, None)
    assert (f"; {remark}\n" in part.fragment()) == bool(remark)


def test_the_bootstrap_draws_groups() -> None:
    """The mean of numbers in groups has the spread of the groups' means, not of the numbers."""
    random = np.random.default_rng(7)
    shifts = random.normal(0, 1, 40)
    groups = np.repeat(np.arange(40), 25)
    sample = shifts[groups] + random.normal(0, 0.1, 1000)

    def of_parts(x: Floats) -> Floats:
        return -0.5 * (sample - x) ** 2

    def function(x: Floats) -> Floats:
        return of_parts(x).sum(axis=1)

    free = np.ones(1, bool)
    [best] = maxima(function, [(np.zeros(1), free)], np.array([0.1]))
    found = bootstrap(of_parts, best, groups, free)[:, 0]
    assert found.mean() == pytest.approx(sample.mean(), abs=0.02)
    assert found.std() == pytest.approx(shifts.std() / np.sqrt(40), rel=0.1)

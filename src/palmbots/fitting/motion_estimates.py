# SPDX-License-Identifier: Apache-2.0
"""The parameters of a robot's motion from stretches: the greatest likelihood, and intervals."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from palmbots.fitting.fitted_values import LEAST_RUNS, Estimate
from palmbots.fitting.motion_likelihood import Stretch, Stretches
from palmbots.fitting.profile_likelihood import Function, Maximum, bootstrap, intervals, maxima

Floats = NDArray[np.float64]

LEAST_STRETCHES = 50
"""Fewest stretches for the parameters of the noise."""
LEAST_NOISE_S = 140.0
"""Or stretches that last so long together, as those of logs do; not for the spread of the gain."""
_GAIN, _BIAS, _GAIN_SD, _NOISE, _LOG_TAU, _WHITE, _POSITION = range(7)
_DEVIATIONS = [_GAIN_SD, _NOISE, _WHITE, _POSITION]
_STEPS = np.array([0.003, 2e-4, 0.003, 4e-4, 0.1, 2e-4, 5e-5])
_SHORTEST_TAU_S = 0.05
_SEARCHES = 0.3  # of the time: the searches
_SPEEDS_APART = 0.2  # of the mean: at less, bias and gain cannot be separated


@dataclass(frozen=True)
class Displacements:
    """What the figure shows: the spread of the displacement error over time, and residuals."""

    times_s: Floats
    spread_m: Floats
    """Of the data: standard deviation of the displacement less gain and bias."""
    low_m: Floats
    high_m: Floats
    """Its 95 % interval, from the stretches."""
    model_m: Floats
    without_white_m: Floats
    residuals: Floats
    """Of all positions, in standard deviations of the prediction."""
    commands_m_s: Floats
    speeds_m_s: Floats
    """Mean speed of each stretch."""


@dataclass(frozen=True)
class FittedStretches:
    """The estimates from stretches, and the data for a figure."""

    estimates: tuple[Estimate, ...]
    data: Displacements
    parameters: Floats
    """Of the greatest likelihood, as in `PARAMETERS`."""


def fit_stretches(
    stretches: Sequence[Stretch],
    on_progress: Callable[[float], None] = lambda part: None,
) -> FittedStretches:
    """Fit the parameters to stretches: greatest likelihood, and 95 % intervals.

    Args:
        stretches: of all runs.
        on_progress: called with the completed fraction.
    """
    arrays = Stretches(stretches)
    stretches = [one for one in stretches if not one.is_short]
    commands = np.array([each.command_m_s for each in stretches])
    has_bias = bool(np.std(commands) > _SPEEDS_APART * np.mean(commands))
    longest = 0.5 * float(np.median([each.times_s[-1] for each in stretches]))
    ends = math.log(_SHORTEST_TAU_S), math.log(longest)

    def of_stretches(parameters: Floats) -> Floats:
        inside = parameters.copy()
        inside[:, _LOG_TAU] = np.clip(inside[:, _LOG_TAU], *ends)
        beyond = parameters[:, _LOG_TAU] - inside[:, _LOG_TAU]
        return arrays.log_likelihood(inside) - (beyond**2)[:, None]

    def function(parameters: Floats) -> Floats:
        return of_stretches(parameters).sum(axis=1)

    free = np.ones(len(_STEPS), bool)
    free[_BIAS], free[_POSITION] = has_bias, not all(one.is_exact for one in stretches)
    best, plain = _maxima(function, _starts(stretches, ends), free, ends)
    on_progress(_SEARCHES)

    def of_intervals(part: float) -> None:
        on_progress(_SEARCHES + (1 - _SEARCHES) * part)

    found = _intervals(of_stretches, function, arrays.runs, best, free, ends, of_intervals)
    return FittedStretches(
        _estimates(best, found, stretches, free, ends),
        _displacements(stretches, arrays, best.place, plain.place),
        best.place,
    )


def _maxima(
    function: Function, starts: Floats, free: NDArray[np.bool_], ends: tuple[float, float]
) -> tuple[Maximum, Maximum]:
    """The best of searches from the best short and the best long correlation time, and that of a
    search without the white part."""
    starts = np.where(free, starts, 0.0)
    values = function(starts)
    has_white, is_short = starts[:, _WHITE] > 0, starts[:, _LOG_TAU] < np.mean(ends)
    chosen = [
        starts[np.argmax(np.where(those, values, -np.inf))]
        for those in (has_white & is_short, has_white & ~is_short, ~has_white)
    ]
    without = free & (np.arange(len(free)) != _WHITE)
    searches = [*zip(chosen, (free, free, without), strict=True)]
    *both, plain = (_inside(one, ends) for one in maxima(function, searches, _STEPS))
    return max(both, key=lambda one: one.value), plain


def _starts(stretches: Sequence[Stretch], ends: tuple[float, float]) -> Floats:
    """Where searches may begin: the noise, the white part and that of the positions each have some
    share of what moves the robot between positions, as a variance."""
    ratios = np.array([each.speed_m_s / each.command_m_s for each in stretches])
    gain = float(np.median(ratios))
    after_s = np.concatenate([np.diff(each.times_s) for each in stretches])
    moved = np.concatenate(
        [np.diff(each.positions_m - gain * each.commanded_m) for each in stretches]
    )
    scales = np.mean(moved**2) / [np.mean(after_s**2), np.mean(after_s), 2.0] + 1e-12
    shares = np.array(
        [*itertools.product((0.05, 0.3, 1.0), (0.0, 0.003, 0.03, 0.3), (0.003, 0.03, 0.3))]
    )
    taus = np.linspace(*ends, 5)
    starts = np.zeros((len(shares), len(taus), len(_STEPS)))
    starts[..., _GAIN], starts[..., _GAIN_SD] = gain, 0.5 * float(np.std(ratios)) + 5e-4
    starts[..., [_NOISE, _WHITE, _POSITION]] = np.sqrt(scales * shares)[:, None]
    starts[..., _LOG_TAU] = taus
    return starts.reshape(-1, len(_STEPS))


def _inside(best: Maximum, ends: tuple[float, float]) -> Maximum:
    """The same without signs of deviations, which have no meaning, and within the limits of τ."""
    place = best.place.copy()
    place[_DEVIATIONS] = np.abs(place[_DEVIATIONS])
    place[_LOG_TAU] = np.clip(place[_LOG_TAU], *ends)
    return replace(best, place=place)


def _intervals(
    of_stretches: Function,
    function: Function,
    runs: NDArray[np.intp],
    best: Maximum,
    free: NDArray[np.bool_],
    ends: tuple[float, float],
    on_progress: Callable[[float], None],
) -> list[tuple[float, float]]:
    """The 95 % interval of each parameter, from the profile of the likelihood.

    Where there are enough runs it is widened to that of a bootstrap over runs, because the
    stretches of a run may have more in common than the model says.
    """
    ranges = [(0.0, 10.0), (-1.0, 1.0), (0.0, 1.0), (0.0, 1.0), ends, (0.0, 1.0), (0.0, 1.0)]
    found = intervals(function, best, ranges, free, on_progress)
    if len(set(runs.tolist())) < LEAST_RUNS:
        return found
    drawn = bootstrap(of_stretches, best, runs, free)
    drawn[:, _DEVIATIONS] = np.abs(drawn[:, _DEVIATIONS])
    drawn = np.clip(drawn, *np.array(ranges).T)
    wide = np.quantile(drawn, (0.025, 0.975), axis=0).T
    return [
        (min(low, float(one)), max(high, float(other)))
        for (low, high), (one, other) in zip(found, wide, strict=True)
    ]


def _estimates(
    best: Maximum,
    found: list[tuple[float, float]],
    stretches: Sequence[Stretch],
    free: NDArray[np.bool_],
    ends: tuple[float, float],
) -> tuple[Estimate, ...]:
    """The estimates of scene keys, with the reason where one is not identified."""
    count, duration_s = len(stretches), sum(each.times_s[-1] for each in stretches)
    few = few_gains = ""
    if count < LEAST_STRETCHES:
        few_gains = f"needs {LEAST_STRETCHES} stretches; there are {count}"
        if duration_s < LEAST_NOISE_S:
            few = f"{few_gains}, and they last {duration_s:.0f} s instead of {LEAST_NOISE_S:g} s"
    place = best.place.copy()
    for index in _DEVIATIONS:  # a deviation that is 0 is found within the accuracy of the search
        if place[index] < 0.01 * found[index][1]:
            place[index] = 0.0
    slow = "the commanded speeds differ by less than 20 % (as a standard deviation)"
    low, high = (math.exp(end) for end in found[_LOG_TAU])
    no_tau = few or ("the noise may be 0" if found[_NOISE][0] <= 0 else "")
    remark = ""
    if high >= math.exp(ends[1]) * 0.999:
        remark = f"it is at least {low:.2g} s; {high:.2g} s is the longest that the stretches show"
    if low <= math.exp(ends[0]) * 1.001:
        if remark and not no_tau:
            no_tau = (
                f"the stretches show {low:.2g} to {high:.2g} s, and it may be any of these times"
            )
        remark = f"it is at most {high:.2g} s; {low:.2g} s is the shortest that the fit tries"
    exact = "the logs have the true positions"
    rows = [
        ("robot.gain", place[_GAIN], found[_GAIN], ""),
        ("robot.bias_m_s", place[_BIAS], found[_BIAS], "" if free[_BIAS] else slow),
        ("robot.gain_sd", place[_GAIN_SD], found[_GAIN_SD], few_gains),
        ("robot.noise_m_s", place[_NOISE], found[_NOISE], few),
        ("robot.noise_tau_s", math.exp(place[_LOG_TAU]), (low, high), no_tau),
        ("robot.white_noise_m_per_sqrt_s", place[_WHITE], found[_WHITE], few),
        ("position_noise_m", place[_POSITION], found[_POSITION], "" if free[_POSITION] else exact),
    ]
    given = [
        Estimate(key, float(value), float(ends[0]), float(ends[1]), reason)
        if reason not in (slow, exact)
        else Estimate(key, reason=reason)
        for key, value, ends, reason in rows
    ]
    given[_LOG_TAU] = replace(given[_LOG_TAU], remark=remark)
    if place[_LOG_TAU] in ends:
        on_tau = f"for a correlation time of {math.exp(place[_LOG_TAU]):.2g} s"
        given[_NOISE] = replace(given[_NOISE], remark=on_tau)
    return tuple(given)


_LAGS_S = np.linspace(0.2, 2.0, 19)


def _displacements(
    stretches: Sequence[Stretch], arrays: Stretches, best: Floats, plain: Floats
) -> Displacements:
    """The spread of the displacement error over time, of the data and of both models."""
    sums = np.zeros((3, len(_LAGS_S), len(stretches)))  # squares, squares of the models, weights
    for column, each in enumerate(stretches):
        expected = best[_GAIN] * each.commanded_m + best[_BIAS] * each.times_s
        error = each.positions_m - expected
        for row, lag in enumerate(_LAGS_S):
            ends = np.arange(0.0, each.times_s[-1] - lag + 1e-9, lag)
            moved = np.interp(ends + lag, each.times_s, error) - np.interp(
                ends, each.times_s, error
            )
            sums[0, row, column] = float(np.sum(moved**2))
            sums[2, row, column] = len(moved)
    weights = sums[2].sum(axis=1)
    mean = sums[0].sum(axis=1) / weights
    draws = np.random.default_rng(0).multinomial(
        len(stretches), np.full(len(stretches), 1 / len(stretches)), size=400
    )
    drawn = (draws @ sums[0].T) / np.maximum(draws @ sums[2].T, 1)
    low, high = np.sqrt(np.quantile(drawn, (0.025, 0.975), axis=0))
    commands = np.array([each.command_m_s for each in stretches])
    shares = (sums[2] * commands**2).sum(axis=1) / weights
    return Displacements(
        times_s=_LAGS_S,
        spread_m=np.sqrt(mean),
        low_m=low,
        high_m=high,
        model_m=np.sqrt(displacement_variance(best, _LAGS_S, shares)),
        without_white_m=np.sqrt(displacement_variance(plain, _LAGS_S, shares)),
        residuals=np.concatenate(arrays.residuals(best)),
        commands_m_s=commands,
        speeds_m_s=np.array([each.speed_m_s for each in stretches]),
    )


def displacement_variance(parameters: Floats, times_s: Floats, square_command: Floats) -> Floats:
    """The variance of the measured displacement error after some time [m²].

    Args:
        parameters: one set, as in `PARAMETERS`.
        times_s: the times.
        square_command: mean square of the commanded speed [m²/s²].
    """
    _, _, gain_sd, sigma, log_tau, white, measured = parameters
    tau = math.exp(log_tau)
    of_noise = 2 * sigma**2 * tau * (times_s + tau * np.expm1(-times_s / tau))
    of_gain = gain_sd**2 * square_command * times_s**2
    return of_noise + of_gain + white**2 * times_s + 2 * measured**2

# SPDX-License-Identifier: Apache-2.0
"""The motion of a robot, fitted to recordings of its commands and its positions (`fit_motion`)."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.report import Item, Line, Table
from palmbots._util.results import Result
from palmbots._util.text import plural
from palmbots.errors import PalmbotsError
from palmbots.fitting.fitted_values import (
    LEAST_RUNS,
    Estimate,
    Source,
    estimate_rows,
    fitted_keys,
)
from palmbots.fitting.motion_likelihood import Stretch, Stretches
from palmbots.fitting.profile_likelihood import Function, Maximum, bootstrap, interval, maximum
from palmbots.fitting.recorded_tables import read_recording
from palmbots.fitting.straight_stretches import (
    COMMANDS,
    ENDS_S,
    LEAST_S,
    POSITIONS,
    SETTLED_S,
    Alignment,
    align,
    check_units,
    stretches_of,
)

Floats = NDArray[np.float64]

LEAST_STRETCHES = 50
"""Fewest stretches for the parameters of the noise."""
LEAST_FOR_GAIN = 5
_GAIN, _BIAS, _GAIN_SD, _NOISE, _LOG_TAU, _WHITE, _POSITION = range(7)
_DEVIATIONS = [_GAIN_SD, _NOISE, _WHITE, _POSITION]
_STEPS = np.array([0.003, 2e-4, 0.003, 4e-4, 0.1, 2e-4, 5e-5])
_SHORTEST_TAU_S = 0.05
_READING, _SEARCHES = 0.2, 0.3  # of the time: reading, and of the rest the searches
_GAINS = (0.5, 2.0)  # limits of the scene key
_SPEEDS_APART = 0.2  # of the mean: at less, bias and gain cannot be separated


@dataclass(frozen=True, repr=False)
class MotionFit(Result):
    """Errors of the speed of a robot, with 95 % intervals, and what they were fitted to."""

    figure = "motion-fit"

    sources: tuple[Source, ...]
    """The files: of each run the commands, then the positions."""
    runs: int
    stretches: int
    """Straight stretches with a constant command that were used."""
    jumps: int
    """Stretches that were left out because the position jumped or was lost."""
    duration_s: float
    """Of all stretches together."""
    alignments: tuple[Alignment, ...]
    estimates: tuple[Estimate, ...]
    """One for each scene key that could be fitted, and for the noise of the positions."""
    misfit: float
    """How far the spread of the displacement error is from the model's, as a fraction: the root
    mean square over times from 0.2 s to 2 s."""
    misfit_without_white: float
    """The same of a model without the white part."""
    data: Displacements = field(metadata=NOT_IN_JSON)

    @property
    def keys(self) -> dict[str, float | bool]:
        """What was fitted, as overrides of a scene."""
        return fitted_keys(self.estimates)

    def lines(self) -> Iterator[Item]:
        """What was fitted, with intervals, and what the data are."""
        fitted = sum(one.is_identified for one in self.estimates if one.is_key)
        yield (
            f"fitted {plural(fitted, 'key')} to {plural(self.stretches, 'straight stretch')} of "
            f"{plural(self.runs, 'run')}"
        )
        yield Table(estimate_rows(self.estimates), ("", "value", "95 % interval"))
        lags = [one.lag_s for one in self.alignments]
        drifts = [one.drift_ppm for one in self.alignments]
        yield Table(
            [
                ("  duration of the stretches", f"{self.duration_s:.0f} s"),
                ("  left out, because the position jumped", f"{self.jumps}"),
                ("  lag of the positions", _range(lags, 1.0, "s")),
                ("  drift of the lag", _range(drifts, 1.0, "ppm")),
                ("  misfit of the displacement error", f"{100 * self.misfit:.0f} %"),
                ("  misfit without a white part", f"{100 * self.misfit_without_white:.0f} %"),
            ]
        )
        for one in self.estimates:
            if not one.is_identified:
                yield Line(f"{one.key}: {one.reason}", indent=2)


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


def _range(values: Sequence[float], factor: float, unit: str) -> str:
    low, high = factor * min(values), factor * max(values)
    return f"{low:.3g} {unit}" if len(values) == 1 else f"{low:.3g} to {high:.3g} {unit}"


def fit_motion(
    files: Sequence[str | os.PathLike[str]], on_progress: Callable[[float], None] | None = None
) -> MotionFit:
    """Fit the errors of a robot's speed.

    Args:
        files: of each run the commands, then the positions.
        on_progress: called with the completed fraction.

    Raises:
        PalmbotsError: the files are not in pairs, cannot be read, do not belong together, or
            identify nothing.
    """
    if len(files) % 2 or not files:
        raise PalmbotsError(
            f"--motion: {plural(len(files), 'file')}; expected pairs: of each run the commands, "
            "then the positions"
        )
    sources: list[Source] = []
    stretches: list[Stretch] = []
    alignments: list[Alignment] = []
    jumps = 0
    report = on_progress or (lambda fraction: None)
    for run, (one, other) in enumerate(zip(files[::2], files[1::2], strict=True)):
        report(_READING * 2 * run / len(files))
        commands = read_recording(one, COMMANDS, 2)
        positions = read_recording(other, POSITIONS, 2)
        check_units(commands, positions)
        alignments.append(align(commands, positions))
        found, left_out = stretches_of(commands, positions, alignments[-1].lag_s, run)
        stretches += found
        jumps += left_out
        sources += [Source(each.name, each.sha256) for each in (commands, positions)]
    runs = len(alignments)
    named = f"{sources[0].name} and {sources[1].name} have" if runs == 1 else f"{runs} runs have"
    if len(stretches) < LEAST_FOR_GAIN:
        raise PalmbotsError(
            f"--motion: {named} {plural(len(stretches), 'straight stretch')} with a constant "
            f"command of at least {LEAST_S + SETTLED_S + ENDS_S:g} s; expected {LEAST_FOR_GAIN} "
            f"for the gain, and {LEAST_STRETCHES} for the noise; nothing is written"
        )
    mean = float(np.median([_speed(each) / each.command_m_s for each in stretches]))
    if not _GAINS[0] < mean < _GAINS[1]:
        raise PalmbotsError(
            f"--motion: {named} a robot that moves {mean:.4g} times as fast as commanded; "
            f"expected m and m/s, and a gain from {_GAINS[0]:g} to {_GAINS[1]:g}"
        )
    fitted = fit_stretches(stretches, lambda part: report(_READING + (1 - _READING) * part))
    return MotionFit(
        sources=tuple(sources),
        runs=len(alignments),
        stretches=len(stretches),
        jumps=jumps,
        duration_s=float(sum(each.times_s[-1] for each in stretches)),
        alignments=tuple(alignments),
        estimates=fitted.estimates,
        misfit=_misfit(fitted.data.model_m, fitted.data),
        misfit_without_white=_misfit(fitted.data.without_white_m, fitted.data),
        data=fitted.data,
    )


@dataclass(frozen=True)
class FittedStretches:
    """The estimates from stretches, and the data for a figure."""

    estimates: tuple[Estimate, ...]
    data: Displacements


def fit_stretches(
    stretches: Sequence[Stretch], on_progress: Callable[[float], None] = lambda part: None
) -> FittedStretches:
    """Fit the parameters to stretches: greatest likelihood, and 95 % intervals."""
    arrays = Stretches(stretches)
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
    free[_BIAS] = has_bias
    best = _best(function, stretches, free, ends)
    on_progress(_SEARCHES / 2)
    without = free & (np.arange(len(free)) != _WHITE)
    plain = _best(function, stretches, without, ends)

    def of_intervals(part: float) -> None:
        on_progress(_SEARCHES + (1 - _SEARCHES) * part)

    found = _intervals(of_stretches, function, arrays.runs, best, free, ends, of_intervals)
    return FittedStretches(
        _estimates(best, found, len(stretches), has_bias, ends),
        _displacements(stretches, arrays, best.place, plain.place),
    )


def _best(
    function: Function,
    stretches: Sequence[Stretch],
    free: NDArray[np.bool_],
    ends: tuple[float, float],
) -> Maximum:
    """The best of searches that begin with a short and with a long correlation time."""
    ratios = np.array([_speed(each) / each.command_m_s for each in stretches])
    spread = float(np.std(ratios)) + 1e-3
    error = 0.5 * spread * float(np.mean([each.command_m_s for each in stretches]))
    found = []
    for part in (0.2, 0.8):
        start = np.zeros(len(_STEPS))
        start[[_GAIN, _GAIN_SD, _NOISE]] = float(np.median(ratios)), spread / 2, error
        start[[_LOG_TAU, _WHITE, _POSITION]] = ends[0] + part * (ends[1] - ends[0]), error, 5e-4
        start[~free] = 0.0
        found.append(maximum(function, start, _STEPS, free))
    best = max(found, key=lambda one: one.value)
    place = best.place.copy()
    place[_DEVIATIONS] = np.abs(place[_DEVIATIONS])
    place[_LOG_TAU] = np.clip(place[_LOG_TAU], *ends)
    return Maximum(place, best.value, best.information, best.steps)


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
    found = []
    for index, range_of in enumerate(ranges):
        on_progress(index / len(ranges))
        is_free = bool(free[index])
        found.append(interval(function, best, index, *range_of, free) if is_free else (0.0, 0.0))
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
    count: int,
    has_bias: bool,
    ends: tuple[float, float],
) -> tuple[Estimate, ...]:
    """The estimates of scene keys, with the reason where one is not identified."""
    few = (
        "" if count >= LEAST_STRETCHES else f"needs {LEAST_STRETCHES} stretches; there are {count}"
    )
    place = best.place.copy()
    for index in _DEVIATIONS:  # a deviation that is 0 is found within the accuracy of the search
        if place[index] < 0.01 * found[index][1]:
            place[index] = 0.0
    slow = "the commanded speeds differ by less than 20 % (as a standard deviation)"
    low, high = (math.exp(end) for end in found[_LOG_TAU])
    is_any = low <= math.exp(ends[0]) * 1.001 and high >= math.exp(ends[1]) * 0.999
    no_tau = few or ("the noise may be 0" if found[_NOISE][0] <= 0 else "")
    if not no_tau and is_any:
        no_tau = f"the stretches show {low:.2g} to {high:.2g} s, and it may be any of these times"
    rows = [
        ("robot.gain", place[_GAIN], found[_GAIN], ""),
        ("robot.bias_m_s", place[_BIAS], found[_BIAS], "" if has_bias else slow),
        ("robot.gain_sd", place[_GAIN_SD], found[_GAIN_SD], few),
        ("robot.noise_m_s", place[_NOISE], found[_NOISE], few),
        ("robot.noise_tau_s", math.exp(place[_LOG_TAU]), (low, high), no_tau),
        ("robot.white_noise_m_per_sqrt_s", place[_WHITE], found[_WHITE], few),
        ("position_noise_m", place[_POSITION], found[_POSITION], ""),
    ]
    given = [
        Estimate(key, float(value), float(ends[0]), float(ends[1]), reason)
        if reason != slow
        else Estimate(key, None, None, None, reason)
        for key, value, ends, reason in rows
    ]
    return (*given, *(Estimate(key, None, None, None, reason) for key, reason in _NOT_FITTED))


_NOT_FITTED = (
    ("robot.acceleration_m_s2", "the stretches begin when the robot has reached its speed"),
    ("dead time", "the lag of the positions is dead time and offset of the clocks together"),
    ("trim", "the robot's distance between its wheels is not in the recording"),
)


def _speed(stretch: Stretch) -> float:
    return float((stretch.positions_m[-1] - stretch.positions_m[0]) / stretch.times_s[-1])


_LAGS_S = np.linspace(0.2, 2.0, 19)


def _displacements(
    stretches: Sequence[Stretch], arrays: Stretches, best: Floats, plain: Floats
) -> Displacements:
    """The spread of the displacement error over time, of the data and of both models."""
    sums = np.zeros((3, len(_LAGS_S), len(stretches)))  # squares, squares of the models, weights
    for column, each in enumerate(stretches):
        expected = (best[_GAIN] * each.command_m_s + best[_BIAS]) * each.times_s
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
        speeds_m_s=np.array([_speed(each) for each in stretches]),
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


def _misfit(model_m: Floats, data: Displacements) -> float:
    return float(np.sqrt(np.mean((model_m / data.spread_m - 1) ** 2)))

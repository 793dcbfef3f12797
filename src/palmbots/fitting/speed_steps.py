# SPDX-License-Identifier: Apache-2.0
"""Acceleration and dead time of a robot, from changes of the commanded speed.

A robot that drives at u₀ gets the command for another speed at t₀. After the dead time d it changes
its speed with the acceleration a. Then it drives at u₁, and its line of places over time meets the
line of before at t₀ + κ, with

    κ = d + |Δu| / (2a).

κ of each step is measured, and a straight line over the commanded |Δu| separates a and d. Steps of
one size give the sum only. An offset of the clocks counts as dead time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palmbots._util.confidence_intervals import student_t95
from palmbots.fitting.fitted_values import LEAST_RUNS, Estimate

Floats = NDArray[np.float64]

SETTLED_S = 0.6
"""After this time a robot drives at its new speed."""
LEAST_STEPS = 20
_BEFORE_S, _AFTER_S = 0.3, 1.0
"""A command must be constant for `SETTLED_S` and this time: before a step, and after one to another
speed than 0."""
_MOST_S = 3.0  # of a command that is used
_EARLY_S = 0.2  # a lag contains half of the acceleration: a line ends earlier than it says
_ANCHOR_S = 0.15  # over which the place after a step is averaged
_LEAST_M_S = 0.02  # of a step
_SAME_M_S = 1e-4  # difference of equal commands
_APART = 0.2  # of the mean: sizes of steps that differ by less are alike
_FAR = 4.0  # standard deviations: a longer delay is an outlier
_FARTHEST_S = 1.0  # of κ from the lag: more is a lost position


@dataclass(frozen=True)
class Step:
    """A change of the commanded speed."""

    change_m_s: float
    """|Δu|, as commanded."""
    delay_s: float
    """κ."""
    run: int


def steps_in(
    commands: tuple[Floats, Floats], when_s: Floats, places_m: Floats, lag_s: float, run: int
) -> list[Step]:
    """The steps of one recording.

    Args:
        commands: when they began, and speeds; NaN where the robot turns.
        when_s: when the places were measured, increasing.
        places_m: along the heading, from any origin.
        lag_s: of the places, about.
        run: number of the recording.
    """
    times_s, speeds_m_s = commands
    changes = np.abs(np.diff(speeds_m_s)) > _SAME_M_S
    changes |= np.isnan(speeds_m_s[1:]) != np.isnan(speeds_m_s[:-1])
    edges = np.concatenate([[0], np.flatnonzero(changes) + 1, [len(times_s) - 1]])
    found = []
    for first, row, after in zip(edges[:-2], edges[1:-1], edges[2:], strict=True):
        before, new = float(speeds_m_s[row - 1]), float(speeds_m_s[row])
        now = float(times_s[row])
        start, end = (
            max(times_s[first] + SETTLED_S, now - _MOST_S),
            min(times_s[after], now + _MOST_S),
        )
        needed = SETTLED_S + (2 * _EARLY_S if new == 0 else _AFTER_S)  # the line at rest is known
        if not abs(new - before) > _LEAST_M_S or now - start < _BEFORE_S or end - now < needed:
            continue
        settled = now + lag_s + SETTLED_S
        until = now + lag_s - _EARLY_S
        old = _line(when_s, places_m, start + lag_s, until, before == 0)
        new_one = _line(when_s, places_m, settled, end + lag_s - _EARLY_S, new == 0)
        if old is None or new_one is None or abs(new_one - old) < 0.5 * abs(new - before):
            continue
        # Both lines near the step, where the noise has added the least to them.
        at, place = _anchor(when_s, places_m, until - _ANCHOR_S, until)
        then, there = _anchor(when_s, places_m, settled, settled + _ANCHOR_S)
        meet = (there - place + old * at - new_one * then) / (old - new_one)
        if abs(meet - now - lag_s) < _FARTHEST_S:
            found.append(Step(abs(new - before), float(meet - now), run))
    return found


def _line(when: Floats, places: Floats, start: float, end: float, stands: bool) -> float | None:
    """The speed in a time; None: there are too few places."""
    rows = slice(*np.searchsorted(when, [start, end]))
    times = when[rows]
    if len(times) < 4 or times[-1] - times[0] < 0.5 * (end - start):
        return None
    return 0.0 if stands else float(np.polyfit(times - times[0], places[rows], 1)[0])


def _anchor(when: Floats, places: Floats, start: float, end: float) -> tuple[float, float]:
    """Mean time and mean place."""
    times = np.linspace(start, end, 8)
    return float(times.mean()), float(np.interp(times, when, places).mean())


def step_estimates(steps: Sequence[Step], dead_time: str) -> list[Estimate]:
    """Acceleration and dead time: weighted least squares, with errors from the residuals.

    The error of κ is inversely proportional to the step. Residuals count as they are (White's
    estimate of the covariance), so no model of the noise is needed. Where there are enough runs,
    those of one run count together.

    Args:
        steps: of all runs.
        dead_time: what the constant part of κ is called.
    """
    keys = ("robot.acceleration_m_s2", dead_time)
    if len(steps) < LEAST_STEPS:
        reason = f"needs {LEAST_STEPS} changes between constant speeds; there are {len(steps)}"
        return [Estimate(key, reason=reason) for key in keys]
    table = np.array([(one.change_m_s, one.delay_s, one.run) for one in steps])
    sizes, delays = table[:, 0], table[:, 1]
    if np.std(sizes) < _APART * np.mean(sizes):
        reason = "all changes of the speed are of about one size"
        return [Estimate(key, reason=reason) for key in keys]
    kept = np.abs(delays - np.median(delays)) < _FAR * _spread(delays)
    sizes, delays, runs = table[kept].T
    terms = np.column_stack([np.ones(len(sizes)), sizes]) * sizes[:, None]
    inverse = np.linalg.inv(terms.T @ terms)
    dead, slope = inverse @ terms.T @ (delays * sizes)
    leverage = np.einsum("ij,jk,ik->i", terms, inverse, terms)
    scores = terms * ((delays * sizes - terms @ [dead, slope]) / (1 - leverage))[:, None]
    names = np.unique(runs)
    if len(names) >= LEAST_RUNS:
        scores = np.array([scores[runs == name].sum(axis=0) for name in names])
    errors = np.sqrt(np.diag(inverse @ scores.T @ scores @ inverse))
    halves = student_t95(len(scores) - 2) * errors
    low, high = slope - halves[1], slope + halves[1]
    acceleration = Estimate(keys[0], reason=_too_fast(float(high)))
    if low > 0:
        ends = float(0.5 / high), float(0.5 / low)
        acceleration = Estimate(keys[0], float(0.5 / slope), *ends)
    return [
        acceleration,
        Estimate(keys[1], float(dead), float(dead - halves[0]), float(dead + halves[0])),
    ]


def _too_fast(slope: float) -> str:
    if slope <= 0:
        return "larger changes of the speed do not take longer"
    return f"too great for the data: at least {0.5 / slope:.2g} m/s²"


def _spread(values: Floats) -> float:
    """A standard deviation that outliers do not change."""
    return 1.4826 * float(np.median(np.abs(values - np.median(values)))) + 1e-9

# SPDX-License-Identifier: Apache-2.0
"""The motion of a robot, fitted to recordings of its commands and its positions (`fit_motion`)."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palmbots._util.confidence_intervals import student_t95
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.results import Result
from palmbots._util.text import plural
from palmbots.errors import PalmbotsError
from palmbots.fitting.clock_alignment import Alignment, align, check_units
from palmbots.fitting.fitted_values import (
    LEAST_RUNS,
    Estimate,
    FittedPart,
    Source,
    refuse_twice,
)
from palmbots.fitting.motion_estimates import LEAST_STRETCHES, Displacements, fit_stretches
from palmbots.fitting.motion_likelihood import Stretch
from palmbots.fitting.replay_files import error_replay
from palmbots.fitting.speed_steps import Step, step_estimates, steps_in
from palmbots.fitting.straight_stretches import (
    COMMANDS,
    ENDS_S,
    LEAST_S,
    POSITIONS,
    SETTLED_S,
    straight,
    stretches_of,
    way_of,
)
from palmbots.scene.recorded_tables import read_recording

Floats = NDArray[np.float64]

LEAST_FOR_GAIN = 5
_MOST_APART_S = 600.0  # commands may have a row for each change
_READING = 0.2  # of the time
_GAINS = (0.5, 2.0)  # limits of the scene key
_WITH_OFFSET = "dead_time_and_clock_offset_s"
_DEAD_TIME = "dead_time_s"
_USABLE = f"with a constant command of at least {LEAST_S + SETTLED_S + ENDS_S:g} s"
_IN_LOGS = f"of at least {LEAST_S:g} s in which a robot does not stand"


@dataclass(frozen=True, repr=False)
class MotionFit(FittedPart, Result):
    """Errors of the speed of a robot, with 95 % intervals, and what they were fitted to."""

    figure = "motion-fit"
    name = "robot"

    runs: int
    stretches: int
    """Straight stretches with a constant command that were used."""
    jumps: int
    """Stretches that were left out because the position jumped or was lost."""
    duration_s: float
    """Duration of all stretches together."""
    alignments: tuple[Alignment, ...]
    """The alignment of the two clocks of each run; empty: logs have one clock."""
    misfit: float
    """Relative difference between the measured and the fitted spread of the displacement error:
    the root mean square over times from 0.2 s to 2 s."""
    misfit_without_white: float
    """The same for a model without the white part."""
    data: Displacements = field(metadata=NOT_IN_JSON)

    def basis(self) -> str:
        """What the keys were fitted to, as a part of a sentence."""
        return f"to {plural(self.stretches, 'straight stretch')} of {plural(self.runs, 'run')}"

    def rows(self) -> list[tuple[str, str]]:
        """What else the report has of the data: names and values."""
        rows = [("duration of the stretches", f"{self.duration_s:.0f} s")]
        if self.alignments:
            lags = [one.lag_s for one in self.alignments]
            drifts = [one.drift_ppm for one in self.alignments]
            rows += [
                ("left out, because the position jumped", f"{self.jumps}"),
                ("lag of the positions", _range(lags, "s")),
                ("drift of the lag", _range(drifts, "ppm")),
            ]
        return [
            *rows,
            ("misfit of the displacement error", f"{100 * self.misfit:.0f} %"),
            ("misfit without a white part", f"{100 * self.misfit_without_white:.0f} %"),
        ]


def _range(values: Sequence[float], unit: str) -> str:
    low, high = min(values), max(values)
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
    steps: list[Step] = []
    alignments: list[Alignment] = []
    jumps = 0
    report = on_progress or (lambda fraction: None)
    for run, (one, other) in enumerate(zip(files[::2], files[1::2], strict=True)):
        report(_READING * 2 * run / len(files))
        commands = read_recording(one, COMMANDS, 2, least_rows=2, most_apart_s=_MOST_APART_S)
        positions = read_recording(other, POSITIONS, 2)
        check_units(commands, positions)
        alignments.append(align(commands, positions))
        lag_s = alignments[-1].lag_s
        found, left_out = stretches_of(commands, positions, lag_s, run)
        way = way_of(commands, positions, lag_s)
        if way is not None:
            steps += steps_in(straight(commands), positions.times_s, way, lag_s, run)
        stretches += found
        jumps += left_out
        sources += [Source(each.name, each.sha256) for each in (commands, positions)]
    refuse_twice(sources[1::2])  # several runs may have the same commands
    return fit_recorded(
        stretches,
        tuple(sources),
        len(alignments),
        tuple(alignments),
        jumps,
        steps=steps,
        on_progress=lambda part: report(_READING + (1 - _READING) * part),
    )


def fit_recorded(
    stretches: Sequence[Stretch],
    sources: tuple[Source, ...],
    runs: int,
    alignments: tuple[Alignment, ...] = (),
    jumps: int = 0,
    *,
    steps: Sequence[Step],
    on_progress: Callable[[float], None] = lambda part: None,
) -> MotionFit:
    """Fit the errors of speeds to stretches, and acceleration and dead time to steps.

    Args:
        stretches: of all runs.
        sources: the files.
        runs: how many recordings there are.
        alignments: how their clocks lie, if there are two.
        jumps: stretches that were left out.
        steps: changes of the commanded speed.
        on_progress: called with the completed fraction.

    Raises:
        PalmbotsError: they identify nothing.
    """
    every, stretches = stretches, [one for one in stretches if not one.is_short]
    named = f"{runs} runs have"
    if runs == 1:
        names = [one.name for one in sources]
        named = f"{' and '.join(names)} {'has' if len(names) == 1 else 'have'}"
    if len(stretches) < LEAST_FOR_GAIN:
        raise PalmbotsError(
            f"--motion: {named} {plural(len(stretches), 'straight stretch')} "
            f"{_USABLE if alignments else _IN_LOGS}; expected {LEAST_FOR_GAIN} for the gain, and "
            f"{LEAST_STRETCHES} for the noise; nothing is written"
        )
    mean = float(np.median([each.speed_m_s / each.command_m_s for each in stretches]))
    if not _GAINS[0] < mean < _GAINS[1]:
        raise PalmbotsError(
            f"--motion: {named} a robot that moves {mean:.4g} times as fast as commanded; "
            f"expected m and m/s, and a gain from {_GAINS[0]:g} to {_GAINS[1]:g}"
        )
    fitted = fit_stretches(every, on_progress)
    others = step_estimates(steps, _WITH_OFFSET if alignments else _DEAD_TIME)
    estimates = (*fitted.estimates, *others, _curvature(stretches))
    return MotionFit(
        sources=sources,
        runs=runs,
        stretches=len(stretches),
        jumps=jumps,
        duration_s=float(sum(each.times_s[-1] for each in stretches)),
        alignments=alignments,
        estimates=estimates,
        misfit=_misfit(fitted.data.model_m, fitted.data),
        misfit_without_white=_misfit(fitted.data.without_white_m, fitted.data),
        data=fitted.data,
        replay=error_replay(stretches, fitted.parameters, _why_no_model(fitted.estimates)),
    )


def _curvature(stretches: Sequence[Stretch]) -> Estimate:
    """How a robot turns without a command: trim over the distance between its wheels."""
    key = "curvature_rad_per_m"
    known = [one for one in stretches if math.isfinite(one.curvature_rad_m)]
    if len(known) < LEAST_FOR_GAIN:
        return Estimate(key, reason="the recording does not have the heading")
    weights = np.array([abs(one.positions_m[-1] - one.positions_m[0]) for one in known])
    values = np.array([one.curvature_rad_m for one in known])
    mean = float(np.average(values, weights=weights))
    # What varies independently: runs, if there are enough of them.
    groups = np.array([one.run for one in known])
    if len(set(groups.tolist())) < LEAST_RUNS:
        groups = np.arange(len(known))
    rest = np.bincount(np.unique(groups, return_inverse=True)[1], weights * (values - mean))
    count = len(rest)
    error = math.sqrt(float(rest @ rest) * count / (count - 1)) / float(weights.sum())
    half = student_t95(count - 1) * error
    return Estimate(key, mean, mean - half, mean + half)


def _why_no_model(estimates: Sequence[Estimate]) -> str:
    """Why the noise is not known well enough to remove that of the positions; empty: it is."""
    return next((one.reason for one in estimates if one.key == "robot.noise_m_s"), "")


def _misfit(model_m: Floats, data: Displacements) -> float:
    return float(np.sqrt(np.mean((model_m / data.spread_m - 1) ** 2)))

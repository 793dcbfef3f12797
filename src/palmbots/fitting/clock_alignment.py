# SPDX-License-Identifier: Apache-2.0
"""How the clock of the positions lies to that of the commands, and whether both files are of one
robot in the expected units.

The two clocks need not agree: the positions lag behind the commands by the time at which the
commanded and the measured speed correlate most. The lag includes the dead time of the robot and
half of the time in which it accelerates: a recording does not separate them from an offset of the
clocks.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palmbots.errors import PalmbotsError
from palmbots.scene.recorded_tables import Recording

Floats = NDArray[np.float64]

FASTEST_M_S = 3.0
"""A faster command is taken for another unit."""
GAP = 8.0
"""A longer step between positions than this many usual ones is a gap."""
JUMP_M = 0.02
"""Beyond what a robot can travel: the position was lost."""

_WINDOW_S = 0.2  # over which the speed is measured
_GRID_S = 0.03  # between the times at which speeds are compared: no part of 0.05, a usual period
_LAGS_S = 0.02  # between the lags that are tried
_FINE_S = 0.01  # a part of both
_FARTHEST_S = 2.0
_LAGS: Floats = np.linspace(-_FARTHEST_S, _FARTHEST_S, round(2 * _FARTHEST_S / _LAGS_S) + 1)
_LEAST_CORRELATION = 0.3
_CLEAR_CORRELATION = 0.5
_PARTS = 4  # of a recording, between which a clock may have jumped
_LONGER = 100.0  # commands that last longer by this factor have times in another unit
_LEAST_AGREED = 0.5  # mean cosine of twice the angle between heading and motion
_SCALE = 10.0  # a ratio of speeds beyond this is another unit


@dataclass(frozen=True)
class Alignment:
    """How the clock of the positions lies to that of the commands."""

    lag_s: float
    """The positions lag behind the commands by this."""
    correlation: float
    """Of commanded and measured speed at that lag."""
    drift_ppm: float
    """How much the lag grows, of the time: from the halves of the recording."""


def check_units(commands: Recording, positions: Recording) -> None:
    """Refuse what cannot be commands in m/s and positions in m of the same time.

    Raises:
        PalmbotsError: it cannot.
    """
    most = float(np.abs(commands["speed_m_s"]).max())
    if most > FASTEST_M_S:
        raise PalmbotsError(
            f"{commands.name}: speed_m_s reaches {most:.4g}; expected m/s, at most {FASTEST_M_S:g}"
        )
    if np.ptp(commands["speed_m_s"]) == 0:
        raise PalmbotsError(
            f"{commands.name}: speed_m_s is constant; expected speeds that change, at least from 0"
        )
    if not any(np.ptp(positions[key]) > 0 for key in ("x_m", "y_m") if key in positions):
        raise PalmbotsError(f"{positions.name}: the position is constant; expected a moving robot")
    long, short = (float(np.ptp(one.times_s)) for one in (commands, positions))
    if long > _LONGER * short:
        raise PalmbotsError(
            f"{commands.name}: lasts {long:.4g} s, and {positions.name} {short:.4g} s; expected "
            "times in s in both"
        )
    _check_heading(positions)
    first = max(commands.times_s[0], positions.times_s[0])
    last = min(commands.times_s[-1], positions.times_s[-1])
    if last - first < 2 * _FARTHEST_S + 10:
        overlap = max(0.0, float(last - first))
        raise PalmbotsError(
            f"{positions.name}: overlaps with {commands.name} for {overlap:.4g} s; expected at "
            f"least {2 * _FARTHEST_S + 10:g} s, and one clock or nearly so"
        )


def _check_heading(positions: Recording) -> None:
    """Refuse a heading in degrees: it is not the direction in which the robot moves.

    Raises:
        PalmbotsError: it is not.
    """
    if "heading_rad" not in positions:
        return
    times, heading = positions.times_s, positions["heading_rad"]
    grid = np.arange(times[0], times[-1], 1.0)
    rows = np.searchsorted(times, grid)
    x, y = (np.diff(positions[key][rows]) for key in ("x_m", "y_m"))
    moves = np.hypot(x, y) > 0.5 * np.quantile(np.hypot(x, y), 0.9)
    way = np.arctan2(y, x)[moves]
    # Forward or backward: the double angle is the same.
    agreed, in_degrees = (
        np.cos(2 * (way - angle[rows[1:]][moves])).mean()
        for angle in (heading, np.radians(heading))
    )
    if agreed < _LEAST_AGREED < in_degrees:
        raise PalmbotsError(
            f"{positions.name}: heading_rad is the direction of motion in degrees; expected rad"
        )


def align(commands: Recording, positions: Recording) -> Alignment:
    """The lag of greatest correlation, within 2 s, and its change.

    Raises:
        PalmbotsError: the commands do not explain how the robot moves.
    """
    first = max(commands.times_s[0], positions.times_s[0]) + _FARTHEST_S + _WINDOW_S
    last = min(commands.times_s[-1], positions.times_s[-1]) - _FARTHEST_S - _WINDOW_S
    lag, correlation = _lag(commands, positions, first, last)
    _check_clocks(commands, positions, np.linspace(first, last, _PARTS + 1))
    if correlation < _LEAST_CORRELATION or abs(lag) > _FARTHEST_S - _LAGS_S:
        raise PalmbotsError(
            f"{positions.name}: the speed correlates with {commands.name} by {correlation:.2f} at "
            f"most, at a lag of {lag:.2f} s; expected a recording of the same robot with the "
            f"clocks within {_FARTHEST_S:g} s, and a correlation above {_LEAST_CORRELATION:g}"
        )
    times = np.arange(first, last, _GRID_S)
    wanted = held(commands, times - lag, _wanted(commands, positions))
    ratio = float(np.polyfit(wanted, _speed(positions, times), 1)[0])
    if not 1 / _SCALE < ratio < _SCALE:
        raise PalmbotsError(
            f"{positions.name}: the robot moves about {ratio:.2g} times as fast as commanded in "
            f"{commands.name}; expected m and m/s"
        )
    _check_turns(commands, positions, times, lag)
    middle = 0.5 * (first + last)
    early, late = (
        _lag(commands, positions, *ends)[0] for ends in ((first, middle), (middle, last))
    )
    return Alignment(lag, correlation, float(1e6 * (late - early) / (middle - first)))


def _check_turns(commands: Recording, positions: Recording, times: Floats, lag_s: float) -> None:
    """Refuse turns in degrees/s.

    Raises:
        PalmbotsError: the robot turns much less than commanded.
    """
    if "turn_rad_s" not in commands or "heading_rad" not in positions:
        return
    half = _WINDOW_S / 2
    wanted = held(commands, times - lag_s, commands["turn_rad_s"])
    heading = np.unwrap(positions["heading_rad"])
    ends = (np.interp(times + one, positions.times_s, heading) for one in (half, -half))
    turned = (next(ends) - next(ends)) / _WINDOW_S
    if wanted.std() == 0 or _correlation(wanted, turned) < _LEAST_CORRELATION:
        return
    ratio = float(np.polyfit(wanted, turned, 1)[0])
    if not 1 / _SCALE < ratio < _SCALE:
        raise PalmbotsError(
            f"{positions.name}: the robot turns about {ratio:.2g} times as fast as commanded in "
            f"{commands.name}; expected rad and rad/s"
        )


def _check_clocks(commands: Recording, positions: Recording, ends: Floats) -> None:
    """Refuse positions that follow the commands at one lag in some parts of a recording only.

    Raises:
        PalmbotsError: they do.
    """
    lag = float(_LAGS[_correlations(commands, positions, ends[0], ends[-1]).argmax()])
    every = np.arange(ends[0], ends[-1], _GRID_S)
    wanted = held(commands, every - lag, _wanted(commands, positions))
    measured = _speed(positions, every)
    follows = []
    for first, after in itertools.pairwise(ends):
        own = (every >= first) & (every < after)
        if wanted[own].std() > 0.5 * wanted.std():
            follows.append(_correlation(wanted[own], measured[own]))
    if sorted(follows)[-2:-1] > [_CLEAR_CORRELATION] and min(follows) < _LEAST_CORRELATION:
        raise PalmbotsError(
            f"{positions.name}: the positions lag behind {commands.name} by {lag:.2f} s in a part "
            "of the recording, and not in another; expected clocks that do not jump"
        )
    _check_gaps(commands, positions, lag)


def _check_gaps(commands: Recording, positions: Recording, lag_s: float) -> None:
    """Refuse a time without positions in which the robot did not drive as commanded.

    Raises:
        PalmbotsError: there is one.
    """
    steps = np.diff(positions.times_s)
    for row in np.flatnonzero(steps > GAP * float(np.median(steps)) + 0.05):
        times = np.arange(positions.times_s[row], positions.times_s[row + 1], _FINE_S) - lag_s
        if "turn_rad_s" in commands and held(commands, times, commands["turn_rad_s"]).any():
            continue
        way = abs(float(held(commands, times, commands["speed_m_s"]).sum())) * _FINE_S
        ends = [positions[key][row : row + 2] for key in ("x_m", "y_m") if key in positions]
        if way - 2 * math.hypot(*(end[1] - end[0] for end in ends)) > JUMP_M:
            raise PalmbotsError(
                f"{positions.name}: has no positions for {steps[row]:.2f} s, in which "
                f"{commands.name} commands {way:.2g} m and the robot moves less than half as far; "
                "expected clocks that do not jump"
            )


def _correlations(commands: Recording, positions: Recording, first: float, last: float) -> Floats:
    """Of commanded and measured speed, at each of the lags."""
    times = np.arange(first, last, _GRID_S)
    measured = _speed(positions, times)
    # The commands once on a grid that has the times of all lags.
    steps, shifts = round(_GRID_S / _FINE_S), round(_LAGS_S / _FINE_S)
    count = len(_LAGS) - 1
    size = len(times) * steps + count * shifts
    grid: Floats = np.arange(size, dtype=np.float64) * _FINE_S + (first - _FARTHEST_S)
    fine = held(commands, grid, _wanted(commands, positions))
    return np.array(
        [
            _correlation(fine[(count - k) * shifts :: steps][: len(times)], measured)
            for k in range(count + 1)
        ]
    )


def _lag(
    commands: Recording, positions: Recording, first: float, last: float
) -> tuple[float, float]:
    found = _correlations(commands, positions, first, last)
    best = int(found.argmax())
    if 0 < best < len(_LAGS) - 1:  # the vertex of a parabola through three points
        low, middle, high = found[best - 1 : best + 2]
        bend = low - 2 * middle + high
        shift = 0.5 * (low - high) / bend if bend < 0 else 0.0
        return float(_LAGS[best] + shift * _LAGS_S), float(middle)
    return float(_LAGS[best]), float(found[best])


def _wanted(commands: Recording, positions: Recording) -> Floats:
    """The commanded speed, without its sign where the positions do not show it."""
    has_sign = "heading_rad" in positions or "y_m" not in positions
    return commands["speed_m_s"] if has_sign else np.abs(commands["speed_m_s"])


def _correlation(one: Floats, other: Floats) -> float:
    one, other = one - one.mean(), other - other.mean()
    size = math.sqrt(float(one @ one) * float(other @ other))
    return float(one @ other) / size if size > 0 else 0.0


def held(commands: Recording, times: Floats, values: Floats) -> Floats:
    """A command holds until the next one."""
    at = np.searchsorted(commands.times_s, times, side="right") - 1
    return values[np.clip(at, 0, len(values) - 1)]


def _speed(positions: Recording, times: Floats) -> Floats:
    """Along the heading, over a window."""
    half = _WINDOW_S / 2
    when = positions.times_s

    def moved(key: str) -> Floats:
        values = positions[key]
        return np.interp(times + half, when, values) - np.interp(times - half, when, values)

    if "y_m" not in positions:
        return moved("x_m") / _WINDOW_S
    if "heading_rad" not in positions:
        return np.hypot(moved("x_m"), moved("y_m")) / _WINDOW_S
    heading = np.interp(times, when, np.unwrap(positions["heading_rad"]))
    return (moved("x_m") * np.cos(heading) + moved("y_m") * np.sin(heading)) / _WINDOW_S

# SPDX-License-Identifier: Apache-2.0
"""Straight stretches with a constant command, from a recording of commands and one of positions.

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
from palmbots.fitting.motion_likelihood import Stretch
from palmbots.scene.recorded_tables import Recording

Floats = NDArray[np.float64]

COMMANDS = ("time_s", "speed_m_s", "turn_rad_s")
POSITIONS = ("time_s", "x_m", "y_m", "heading_rad")

SETTLED_S, ENDS_S = 0.6, 0.2
"""Of a stretch this much is left out at its start, in which the robot still accelerates, and at its
end, because the lag is not exact."""
LEAST_S, MOST_S = 2.0, 30.0
"""Duration of a stretch. More of a long one is left out."""
STRAIGHT_RAD_S = 0.05
"""Greatest commanded turn rate of a straight stretch."""
FASTEST_M_S = 3.0
"""A faster command is taken for another unit."""

SPACING_S = 0.1
"""Positions that follow each other faster are thinned: what motion capture adds from one picture to
the next is correlated, and no error of the robot."""

_SAME_M_S = 1e-4  # difference of equal commands
SLOWEST_M_S = 0.02
_LEAST_ROWS = 10
_GAP = 8.0  # a longer step than this many usual ones is a gap
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
_WIDEST = 0.02  # of its length: a line of places that is wider has a bend
_JUMP_M = 0.02  # beyond what a robot can travel: the position was lost


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
    wanted = _held(commands, times - lag, _wanted(commands, positions))
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
    wanted = _held(commands, times - lag_s, commands["turn_rad_s"])
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
    at = int(_correlations(commands, positions, ends[0], ends[-1]).argmax())
    spread = float(
        _held(commands, np.arange(ends[0], ends[-1], _GRID_S), commands["speed_m_s"]).std()
    )
    follows = []
    for part in itertools.pairwise(ends):
        if _held(commands, np.arange(*part, _GRID_S), commands["speed_m_s"]).std() > 0.5 * spread:
            found = _correlations(commands, positions, *part)
            follows.append(float(found[at]))
    if sorted(follows)[-2:-1] > [_CLEAR_CORRELATION] and min(follows) < _LEAST_CORRELATION:
        raise PalmbotsError(
            f"{positions.name}: the positions lag behind {commands.name} by {_LAGS[at]:.2f} s in "
            "a part of the recording, and not in another; expected clocks that do not jump"
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
    fine = _held(commands, grid, _wanted(commands, positions))
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


def _held(commands: Recording, times: Floats, values: Floats) -> Floats:
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


def stretches_of(
    commands: Recording, positions: Recording, lag_s: float, run: int
) -> tuple[list[Stretch], int]:
    """The stretches of one run, and how many others were left out because the position jumped.

    Args:
        commands: commands.
        positions: positions.
        lag_s: of the positions.
        run: number of the run.
    """
    speed = commands["speed_m_s"]
    turn = commands["turn_rad_s"] if "turn_rad_s" in commands else np.zeros(len(speed))
    fits = (np.abs(turn) < STRAIGHT_RAD_S) & (np.abs(speed) > SLOWEST_M_S)
    changes = (np.abs(np.diff(speed)) > _SAME_M_S) | (fits[1:] != fits[:-1])
    edges = np.concatenate([[0], np.flatnonzero(changes) + 1, [len(speed)]])
    times = commands.times_s + lag_s
    usual = float(np.median(np.diff(positions.times_s)))
    found, jumps = [], 0
    for first, after in itertools.pairwise(edges):
        start = times[first] + SETTLED_S
        end = min(times[min(after, len(times) - 1)] - ENDS_S, start + MOST_S)
        if not fits[first] or end - start < LEAST_S:
            continue
        low, high = np.searchsorted(positions.times_s, [start, end])
        when = positions.times_s[low:high]
        keep = np.concatenate([[True], np.diff(when) > 0]) if high > low else np.zeros(0, bool)
        rows = np.arange(low, high)[keep]
        when = positions.times_s[rows]
        if len(rows) < _LEAST_ROWS or when[-1] - when[0] < LEAST_S / 2:
            continue
        moved, straight = _along(positions, rows, float(np.sign(speed[first])))
        farthest = 2 * abs(speed[first]) * np.diff(when) + _JUMP_M
        if not straight or (np.abs(np.diff(moved)) > farthest).any():
            jumps += 1
            continue
        if np.diff(when).max() > _GAP * usual + 0.05:
            jumps += 1
            continue
        kept = thinned(when)
        command = float(abs(speed[first]))
        since = when[kept] - when[0]
        curvature = math.nan
        if "heading_rad" in positions:
            heading = np.unwrap(positions["heading_rad"][rows])
            turned = heading[-1] - heading[0] - turn[first:after].mean() * (when[-1] - when[0])
            curvature = float(np.sign(speed[first]) * turned / moved[-1])
        found.append(Stretch(since, moved[kept], command * since, run, curvature))
    return found, jumps


def straight(commands: Recording) -> tuple[Floats, Floats]:
    """Times and speeds of the commands; a speed is NaN where the robot turns."""
    speed = commands["speed_m_s"]
    if "turn_rad_s" not in commands:
        return commands.times_s, speed
    turns = np.abs(commands["turn_rad_s"]) >= STRAIGHT_RAD_S
    return commands.times_s, np.where(turns, np.nan, speed)


def way_of(commands: Recording, positions: Recording, lag_s: float) -> Floats | None:
    """The places along the heading, over a whole recording; None: they are not known."""
    x = positions["x_m"]
    if "y_m" not in positions:
        return x
    y = positions["y_m"]
    if "heading_rad" in positions:
        heading = np.unwrap(positions["heading_rad"])
        middle = 0.5 * (heading[1:] + heading[:-1])
        return np.concatenate(
            [[0.0], np.cumsum(np.diff(x) * np.cos(middle) + np.diff(y) * np.sin(middle))]
        )
    places = np.column_stack([x - x.mean(), y - y.mean()])
    _, sizes, axes = np.linalg.svd(places, full_matrices=False)
    if sizes[1] > _WIDEST * sizes[0]:  # no straight line
        return None
    way = places @ axes[0]
    wanted = _held(commands, positions.times_s[:-1] - lag_s, commands["speed_m_s"])
    return way if wanted @ np.diff(way) >= 0 else -way


def thinned(times: Floats, commands: Floats | None = None) -> list[int]:
    """Places of times that are at least about `SPACING_S` apart, and where a command changes."""
    kept = [0]
    changes = np.zeros(len(times), bool)
    if commands is not None:
        changes[1:] = commands[1:] != commands[:-1]
    for place, time in enumerate(times):
        if changes[place] or time - times[kept[-1]] > 0.95 * SPACING_S:
            kept.append(place)
    return kept


def _along(positions: Recording, rows: NDArray[np.intp], sense: float) -> tuple[Floats, bool]:
    """Displacement in the sense of travel, and whether the robot kept to its direction."""
    x = positions["x_m"][rows]
    if "y_m" not in positions:
        return sense * (x - x[0]), True
    y = positions["y_m"][rows]
    if "heading_rad" in positions:
        heading = np.unwrap(positions["heading_rad"][rows])
        middle = 0.5 * (heading[1:] + heading[:-1])
        parts = np.diff(x) * np.cos(middle) + np.diff(y) * np.sin(middle)
        moved = sense * np.concatenate([[0.0], np.cumsum(parts)])
        return moved, bool(np.ptp(heading) < 0.5)
    chord = np.array([x[-1] - x[0], y[-1] - y[0]])
    length = float(np.hypot(*chord))
    if length == 0:
        return x - x[0], False
    moved = ((x - x[0]) * chord[0] + (y - y[0]) * chord[1]) / length
    return moved, True

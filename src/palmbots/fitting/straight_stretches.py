# SPDX-License-Identifier: Apache-2.0
"""Straight stretches with a constant command, from a recording of commands and one of positions."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from palmbots.fitting.clock_alignment import GAP, JUMP_M, held
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

BEFORE_S = 0.055
"""A command that changes answers to what the noise has just done. Positions before it show the
speed to which it answers; with fewer of them, the fit takes the answer for a part of the gain."""

SPACING_S = 0.1
"""Positions that follow each other faster are thinned: what motion capture adds from one picture to
the next is correlated, and no error of the robot."""

SLOWEST_M_S = 0.02
"""A robot with a slower command counts as standing."""

_SAME_M_S = 1e-4  # difference of equal commands
_LEAST_ROWS = 10
_WIDEST = 0.02  # of its length: a line of places that is wider has a bend


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
        farthest = 2 * abs(speed[first]) * np.diff(when) + JUMP_M
        if not straight or (np.abs(np.diff(moved)) > farthest).any():
            jumps += 1
            continue
        if np.diff(when).max() > GAP * usual + 0.05:
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
    wanted = held(commands, positions.times_s[:-1] - lag_s, commands["speed_m_s"])
    return way if wanted @ np.diff(way) >= 0 else -way


def thinned(times: Floats, commands: Floats | None = None) -> list[int]:
    """Places of times that are at least about `SPACING_S` apart, and all within `BEFORE_S` before a
    command changes."""
    kept = [0]
    is_near = np.zeros(len(times), bool)
    if commands is not None:
        changes = np.flatnonzero(commands[1:] != commands[:-1]) + 1
        for change, first in zip(
            changes, np.searchsorted(times, times[changes] - BEFORE_S), strict=True
        ):
            is_near[first : change + 1] = True
    for place in range(1, len(times)):
        if is_near[place] or times[place] - times[kept[-1]] > 0.95 * SPACING_S:
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

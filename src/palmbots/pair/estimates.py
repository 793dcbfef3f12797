# SPDX-License-Identifier: Apache-2.0
"""What a calibration computes from readings: values with the interval that the readings leave.

A person reads a tape or a protractor to the nearest division, so a reading is off by at most half
of one. Intervals are worst cases: they hold every value that fits all readings within these errors.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from palmbots.errors import PalmbotsError

TAPE_M = 0.0005
"""Largest error of a reading of the tape: half a millimetre."""
PROTRACTOR = math.radians(0.25)
"""Largest error of a reading of the protractor [rad]."""
_RULER_M = 0.001  # of the distance of the wheels
_NEWTON_STEPS = 30


@dataclass(frozen=True)
class Estimate:
    """A value, and the interval that holds it."""

    value: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half the width of the interval."""
        return (self.high - self.low) / 2


def spread(
    compute: Callable[..., float], values: Sequence[float], errors: Sequence[float]
) -> Estimate:
    """A function of readings, with the interval over all errors of the readings.

    The function is taken as monotonic in each reading over its error, so its extremes are at the
    corners.
    """
    corners = [
        compute(
            *(
                value + sign * error
                for value, sign, error in zip(values, signs, errors, strict=True)
            )
        )
        for signs in product((-1, 1), repeat=len(values))
    ]
    return Estimate(compute(*values), min(corners), max(corners))


@dataclass(frozen=True)
class Drive:
    """A drive along a tape: what a person measured at half and at full length, and the encoders."""

    half_offset_m: float
    """Offset to the left of the line, at half length."""
    along_m: float
    """Distance along the line, at full length."""
    offset_m: float
    """Offset to the left of the line, at full length."""
    half_turns: tuple[float, float]
    """What the left and right wheel had turned at half length [rad]."""
    turns: tuple[float, float]
    """The same at full length."""
    count_rad: float
    """Turn of a wheel for one count of its encoder [rad]."""


def curve_of(
    start: float, half: float, along: float, offset: float, half_share: float
) -> tuple[float, float]:
    """Length and turn [rad, to the left] of an arc.

    The arc begins at (0, `start`) in an unknown direction, passes the offset `half` at `half_share`
    of its length, and ends at (`along`, `offset`).
    """

    def place(heading: float, curvature: float, s: float) -> tuple[float, float]:
        # The chord of an arc has the mean heading; sin(x)/x is smooth at 0.
        x = curvature * s / 2
        chord = s * (math.sin(x) / x if abs(x) > 1e-8 else 1 - x * x / 6)
        return chord * math.cos(heading + x), start + chord * math.sin(heading + x)

    def misses(z: np.ndarray) -> np.ndarray:
        heading, curvature, length = z
        _, y_half = place(heading, curvature, half_share * length)
        x_end, y_end = place(heading, curvature, length)
        return np.array([y_half - half, x_end - along, y_end - offset])

    z = np.array([0.0, 0.0, along])
    for _ in range(_NEWTON_STEPS):
        miss = misses(z)
        steps = 1e-6 * np.array([1.0, 1.0, 1.0])
        slope = np.array([(misses(z + step) - miss) / size for step, size in
                          zip(np.diag(steps), steps, strict=True)]).T  # fmt: skip
        change = np.linalg.solve(slope, -miss)
        z = z + change
        if np.max(np.abs(change)) < 1e-12:
            break
    _, curvature, length = z
    return float(length), float(curvature * length)


def wheel_estimates(
    drive: Drive, radius_m: float, separation_m: float
) -> tuple[Estimate, Estimate]:
    """`wheel_scale` and `trim` of a robot that was commanded to drive straight.

    Args:
        drive: what was measured.
        radius_m: nominal radius of the wheels.
        separation_m: distance of the wheels, measured with a ruler.
    """
    half_share = sum(drive.half_turns) / sum(drive.turns)

    def scales(
        start: float,
        half: float,
        along: float,
        offset: float,
        wide: float,
        left: float,
        right: float,
    ) -> tuple[float, float]:
        length, turn = curve_of(start, half, along, offset, half_share)
        one = (length - wide * turn / 2) / (radius_m * left)
        other = (length + wide * turn / 2) / (radius_m * right)
        return (one + other) / 2, 2 * (one - other) / (one + other)

    values = (0.0, drive.half_offset_m, drive.along_m, drive.offset_m, separation_m, *drive.turns)
    # The distance is from mark to mark: both ends are read.
    errors = (TAPE_M, TAPE_M, 2 * TAPE_M, TAPE_M, _RULER_M, drive.count_rad, drive.count_rad)
    return (
        spread(lambda *readings: scales(*readings)[0], values, errors),
        spread(lambda *readings: scales(*readings)[1], values, errors),
    )


def line_estimates(
    x: Sequence[float], y: Sequence[float], error: float
) -> tuple[Estimate, Estimate]:
    """Zero and slope of x over y, for a line through (x, y) whose y are off by at most `error`.

    For a servo x is its command and y the angle of the palm: x = zero + slope · y.

    Raises:
        PalmbotsError: no line fits.
    """
    lows, highs = [v - error for v in y], [v + error for v in y]
    corners = [*zip(x, lows, strict=True), *zip(x, highs, strict=True)]
    lines = []
    for (x1, y1), (x2, y2) in combinations(corners, 2):
        if x1 == x2:
            continue
        a = (y2 - y1) / (x2 - x1)
        c = y1 - a * x1
        if all(
            low - 1e-12 <= a * at + c <= high + 1e-12
            for at, low, high in zip(x, lows, highs, strict=True)
        ):
            lines.append((a, c))
    lines = [(a, c) for a, c in lines if abs(a) > 1e-6]
    if not lines:
        raise PalmbotsError("the angles do not lie on a line: was one of them mistyped?")
    # The middle of all lines that fit is itself one: they form a convex set.
    a = sum(line[0] for line in lines) / len(lines)
    c = sum(line[1] for line in lines) / len(lines)
    zeros, slopes = [-c / a for a, c in lines], [1 / a for a, _ in lines]
    return (
        Estimate(-c / a, min(zeros), max(zeros)),
        Estimate(1 / a, min(slopes), max(slopes)),
    )

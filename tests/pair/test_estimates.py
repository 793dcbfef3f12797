# SPDX-License-Identifier: Apache-2.0
"""What a calibration computes, against paths in small steps and against linear programs."""

import math
import random

import numpy as np
import pytest
from scipy.optimize import linprog

from palmbots.pair.estimates import Drive, curve_of, line_estimates, wheel_estimates


def integrated(
    left_m: float,
    right_m: float,
    separation: float,
    start: float,
    heading: float,
    steps: int = 20_000,
) -> list[tuple[float, float]]:
    """The path of a robot whose wheels roll these distances, in small steps: half-way and end."""
    place, yaw = complex(0, start), heading
    found = []
    for step in range(steps):
        yaw += (right_m - left_m) / separation / steps
        place += (left_m + right_m) / 2 / steps * complex(math.cos(yaw), math.sin(yaw))
        if step + 1 in (steps // 2, steps):
            found.append((place.real, place.imag))
    return found


@pytest.mark.parametrize("seed", range(10))
def test_the_path_of_a_robot_gives_its_wheels(seed: int) -> None:
    chance = random.Random(seed)
    scale, trim = chance.uniform(0.9, 1.1), chance.uniform(-0.1, 0.1)
    radius, wide, turns = 0.04, chance.uniform(0.15, 0.3), chance.uniform(10, 40)
    left, right = (radius * scale * (1 + s * trim / 2) * turns for s in (1, -1))
    heading = chance.uniform(-0.02, 0.02)
    (_, half), (along, offset) = integrated(left, right, wide, 0.0, heading)
    length, turn = curve_of(0.0, half, along, offset, 0.5)
    assert length == pytest.approx((left + right) / 2, rel=1e-4)
    assert turn == pytest.approx((right - left) / wide, abs=1e-3)
    drive = Drive(half, along, offset, (turns / 2, turns / 2), (turns, turns), 2 * math.pi / 1440)
    found = wheel_estimates(drive, radius, wide)
    assert found[0].value == pytest.approx(scale, rel=1e-3)
    assert found[1].value == pytest.approx(trim, abs=1e-3)
    for one, truth in zip(found, (scale, trim), strict=True):
        assert one.low < truth < one.high


@pytest.mark.parametrize("sign", [-1, 1])
def test_the_interval_holds_what_a_tape_misread_at_both_ends_hides(sign: int) -> None:
    """The distance is from mark to mark, and each is read to half a millimetre."""
    turns = 20.0
    along = 0.04 * turns + sign * 0.0009
    drive = Drive(0.0, along, 0.0, (turns / 2, turns / 2), (turns, turns), 1e-9)
    scale, _ = wheel_estimates(drive, 0.04, 0.2)
    assert scale.low < 1.0 < scale.high


@pytest.mark.parametrize("seed", range(20))
def test_lines_through_readings_are_those_of_a_linear_program(seed: int) -> None:
    chance = np.random.default_rng(seed)
    zero, slope = chance.uniform(80, 100), chance.choice([-1, 1]) * chance.uniform(0.8, 1.2)
    x = np.sort(chance.uniform(40, 140, 7))
    y = np.round(2 * (x - zero) / slope) / 2
    found_zero, found_slope = line_estimates(list(x), list(y), 0.25)
    # a x + c is within 0.25 of every reading.
    rows = np.vstack([np.c_[x, np.ones(7)], -np.c_[x, np.ones(7)]])
    limits = np.r_[y + 0.25, 0.25 - y]
    slopes = [linprog([sign, 0], rows, limits, bounds=[(None, None)] * 2).x[0] for sign in (1, -1)]
    assert sorted((found_slope.low, found_slope.high)) == pytest.approx(
        sorted(1 / a for a in slopes)
    )
    # The zero is where the line crosses y = 0: bisection over feasibility of a line through it.
    for end, inside in ((found_zero.low, 1e-6), (found_zero.high, -1e-6)):
        for at, is_possible in ((end + inside, True), (end - inside, False)):
            through = linprog(
                [0, 0], rows, limits, A_eq=[[at, 1]], b_eq=[0], bounds=[(None, None)] * 2
            )
            assert through.success is is_possible
    assert found_zero.low <= zero <= found_zero.high
    assert found_slope.low <= slope <= found_slope.high
    assert found_zero.low <= found_zero.value <= found_zero.high

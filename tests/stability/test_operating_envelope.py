# SPDX-License-Identifier: Apache-2.0
"""What an envelope of conditions permits: property 0 and ranges, against brute force."""

import math
from itertools import product
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import Side
from palmbots.stability.problem import permitted, stability_problem
from sampled import amounts
from stability_oracle import STEEP_CASES, contacts, held_everywhere, uneven


def test_interval_of_com_height_and_slope_is_as_bad_as_its_ends() -> None:
    """And either end may be the one that decides."""
    rng = np.random.default_rng(12)
    decided = np.zeros((2, 2), int)
    cases: list[tuple[int, Side]] = [*STEEP_CASES, (0, "left")]
    for _ in range(200):
        at = uneven(rng)
        heights, slopes = np.sort(rng.uniform((0.01, -0.1), (0.15, 0.1), (2, 2)), axis=0).T
        for number, shallow in cases:
            box = at.envelope(com_y=(heights[0], heights[1]), slope=(slopes[0], slopes[1]))
            low, high = permitted(box, number, shallow, at.angles)
            ends = np.array(
                [
                    permitted(at.envelope(com_y=(y, y), slope=(s, s)), number, shallow, at.angles)
                    for y, s in product(heights, slopes)
                ]
            )
            lows, highs = ends[:, 0].reshape(2, 2), ends[:, 1].reshape(2, 2)
            if (lows > highs).any():
                assert low > high
                continue
            assert (low, high) == pytest.approx((lows.max(), highs.min()), abs=1e-12)
            decided[np.unravel_index(lows.argmax(), (2, 2))] += 1
            decided[np.unravel_index(highs.argmin(), (2, 2))] += 1
    assert decided.min() > 10


@pytest.mark.parametrize("cases", amounts(24, 60))
def test_property_zero_against_brute_force(cases: int) -> None:
    """Just inside the interval everything holds; just outside something does not."""
    rng = np.random.default_rng(7)
    held = 0
    step = 1e-7
    for _ in range(cases):
        at = uneven(rng)
        at = at.with_(friction=(at.friction[0] * rng.uniform(0.05, 0.6), at.friction[1]))
        low, high = permitted(at.envelope(), 0, "left", at.angles)
        if low > high:
            assert not any(held_everywhere(at, x) for x in (at.com[0], 0.5 * (low + high)))
            continue
        if high - low < 4 * step:
            continue
        held += 1
        for x in (low + step, 0.5 * (low + high), high - step):
            assert held_everywhere(at, x), at
        for x in (low - step, high + step):
            assert not held_everywhere(at, x), at
    assert cases / 6 < held < 5 * cases / 6


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"palm.left.pivot_offset_m": 0.02},
        {"palm.right.length_m": 0.1},
        {"task.slope_deg": 2.0},
        {"palm.left.friction": 0.35},
        {"palm.left.steep_deg": 17.0},
        {"palm.right.shallow_deg": 6.0},
        {"object.com_m": [0.12, 0.04]},
        {"palm.friction": 0.0945},  # property 0 decides
    ],
    ids=str,
)
def test_asymmetry_of_the_scene_ends_symmetric_ranges(
    changes: dict[str, Any],
) -> None:
    """All properties together permit what each of them does, mirror image or not."""
    report = pb.analyze("paper", overrides=changes)
    at = report.problem
    parts = []
    for found in report.properties.values():
        assert found.com_x_m == permitted(at.envelope(), found.number, found.shallow, at.angles)
        parts.append(found.com_x_m)
    low, high = max(part[0] for part in parts), min(part[1] for part in parts)
    assert low < high
    assert report.com_x_m == pytest.approx((low, high), abs=1e-12)
    middle = 0.5 * (low + high)
    assert at.envelope().com_x_all(at.angles, (middle, middle)) == pytest.approx(
        (low, high), abs=1e-12
    )
    even = changes == {} or bool({"object.com_m", "palm.friction"} & set(changes))
    assert (low + high == pytest.approx(at.width, abs=1e-9)) == even
    if "palm.friction" in changes:
        assert (low, high) == report.properties[0, "left"].com_x_m


def test_property_without_permitted_com_has_no_range() -> None:
    found = pb.analyze("paper", overrides={"palm.friction": 0.01, "palm.steep_deg": 40.0})
    assert found.properties[0, "left"].com_x_m is None
    assert found.com_x_m is None


def test_clearance_of_a_box_by_hand() -> None:
    """A flat bottom clears while −θ_L < ϑ < θ_R: in every pose, at all contacts of its region."""
    rng = np.random.default_rng(3)
    asked = near = 0
    for _ in range(150):
        beyond = float(rng.choice([0.0, rng.uniform(0, 0.05)]))
        at = stability_problem(pb.load_scene("paper"), beyond_m=beyond)
        shallow = float(rng.uniform(2, 10))
        flat, steep = map(
            math.radians, (shallow, shallow + rng.choice([0.2, 0.4, rng.uniform(1, 30)]))
        )
        poses: list[tuple[tuple[float, float], int, Side]] = [
            ((flat, flat), 0, "left"),
            ((steep, steep), 0, "left"),
            *(((flat, steep), number, "left") for number in (1, 2)),
            *(((steep, flat), number, "right") for number in (1, 2)),
        ]
        least: list[float] = []
        for angles, number, side in poses:
            left, right = contacts(at, number, side)
            turn = np.arcsin((right * np.sin(angles[1]) - left * np.sin(angles[0])) / at.width)
            least.append(float(min((angles[0] + turn).min(), (angles[1] - turn).min())))
        grid = np.array([flat]), np.array([steep])
        tolerance, margin = at.envelope().map(
            *grid, (at.com[0], at.com[0]), 0, 1.0, np.empty((0, 0))
        )
        if tolerance[0, 0] <= 0:  # then it is not asked for
            continue
        asked += 1
        assert margin[0, 0] == pytest.approx(min(least), abs=1e-12)
        near += int(np.argmin(least) == 0)
    assert asked > 30
    assert near > 2  # both palms shallow may decide, too


@pytest.mark.parametrize("slope_deg", [-3.0, 0.0, 2.0])
def test_slope_reduces_the_allowed_acceleration(slope_deg: float) -> None:
    """An acceleration adds to the slope, either way: the nearer end of the range counts."""
    found = pb.analyze("paper", overrides={"task.slope_deg": slope_deg})
    assert found.slope is not None
    here = np.tan(np.radians(slope_deg))
    low, high = found.slope
    assert found.slope == pytest.approx(pb.analyze("paper").slope)
    assert found.max_acceleration_m_s2 == pytest.approx(9.80665 * min(here - low, high - here))
    assert found.max_slope_deg == pytest.approx(np.degrees(np.arctan(min(-low, high))))

# SPDX-License-Identifier: Apache-2.0
"""Routes seen from above, against curves that are integrated step by step and points that are
tried one by one."""

import itertools
import math
from typing import Any

import numpy as np
import pytest

from palmbots.mujoco.curved_world import line_of
from palmbots.mujoco.path_curve import EASE_M, Spot, corner_length
from palmbots.mujoco.route_geometry import (
    Rectangle,
    ahead,
    crossing,
    divided,
    first_touch,
    heading,
    seen_from,
    turn_at,
)
from palmbots.mujoco.route_stage import Offset, Pair
from palmbots.scene.scene import load_scene

RNG = np.random.default_rng(44)
TURNS = [math.radians(degrees) for degrees in (-150, -90, -40, 12, 45, 90, 130)]


def driven(turn: float, radius: float, ease: float) -> tuple[float, float, float, float]:
    """Length, end (x, y) and heading of a corner, driven in steps of 20 µm from the origin along x:
    the curvature rises to 1 / radius over `ease`, and falls in the same way."""
    step, flat = 2e-5, abs(turn) * radius - ease
    long = flat + 2 * ease
    s = np.arange(0.5 * step, long, step)
    bend = np.clip(np.minimum(s, long - s) / ease, 0, 1) * math.copysign(1 / radius, turn)
    way = np.cumsum(bend) * step
    return long, float(np.cos(way).sum() * step), float(np.sin(way).sum() * step), float(way[-1])


def pair(points: list[list[float]], **keys: Any) -> Pair:
    route = {"task.route.waypoints_m": points, "task.route.radius_m": 0.6}
    return Pair(load_scene("around-wall", {**route, **keys}))


@pytest.mark.parametrize("turn", TURNS)
def test_a_rounded_corner_takes_as_much_of_both_lines_as_one_that_is_driven(turn: float) -> None:
    _, x, y, way = driven(turn, 0.6, EASE_M)
    assert way == pytest.approx(turn, abs=1e-3)
    used = corner_length(turn, 0.6)
    # From the corner, which is `used` ahead, the end lies `used` along the new heading.
    assert (x, y) == pytest.approx(ahead((used, 0.0), turn, used), abs=1e-4)


def test_the_curve_of_a_stage_is_as_long_as_one_that_is_driven_and_ends_on_the_last_line() -> None:
    points = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.5), (4.5, 2.5)]
    found = pair([list(point) for point in points])
    curve = found.curve(points)
    long = sum(math.dist(one, two) for one, two in itertools.pairwise(points))
    for turn in (math.pi / 2, -math.pi / 2):
        arc, x, y, _ = driven(turn, 0.6, EASE_M)
        used = x - y / math.tan(turn)
        long += arc - 2 * used
    assert curve.length + found.spread / 2 == pytest.approx(long, abs=1e-4)
    end = curve.at(curve.length)
    assert (end.x + found.spread / 2, end.y) == pytest.approx(points[-1], abs=1e-4)
    assert end.heading == pytest.approx(0.0, abs=1e-4)
    places = np.array(
        [[spot.x, spot.y] for spot in map(curve.at, np.linspace(0, curve.length, 999))]
    )
    ways = np.unwrap([curve.at(s).heading for s in np.linspace(0, curve.length, 999)])
    chords = np.diff(places, axis=0)
    middle = 0.5 * (ways[1:] + ways[:-1])
    assert np.arctan2(chords[:, 1], chords[:, 0]) == pytest.approx(middle, abs=1e-4)


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_divided_corner_leaves_and_meets_its_lines(turn: float, n: int) -> None:
    far, way, corner = 9.0, 0.7, (1.0, -2.0)
    points = [ahead(corner, way, -far), corner, ahead(corner, way + turn, far)]
    parts = divided(points, 1, n, 0.5, 0.6, EASE_M)
    chain = [points[0], *parts, points[-1]]
    assert len(parts) == n
    for k in range(1, n + 1):
        assert turn_at(chain, k) == pytest.approx(turn / n, abs=1e-9)
    used = corner_length(turn / n, 0.6)
    for one, two in itertools.pairwise(parts):
        assert math.dist(one, two) - 2 * used == pytest.approx(0.5)
    assert math.dist(parts[0], corner) == pytest.approx(math.dist(parts[-1], corner))


def test_two_lines_cross_where_both_lead() -> None:
    for _ in range(20):
        where = tuple(RNG.uniform(-3, 3, 2))
        one, other = RNG.uniform(-3, 3, 2)
        first, second = ahead(where, one, RNG.uniform(-2, 2)), ahead(where, other, 1.5)
        assert crossing(first, one, second, other) == pytest.approx(where, abs=1e-6)


def test_an_object_that_drifts_as_forecast_stands_on_the_route() -> None:
    """The path of the stage is driven, and the drift is added to its end."""
    points = ((0.0, 0.0), (2.0, 0.0), (3.5, 1.5))
    found = pair([[0, 0], [2, 0], [5, 3]])
    drift = Offset(0.0, -0.02, math.radians(2))
    stage = found.shifted(points, drift)
    assert stage[0] == points[0]
    curve = found.curve(stage)
    end = curve.at(curve.length)
    place = ahead((end.x + found.spread / 2, end.y), end.heading, 0.0, drift.aside_m)
    # The object is turned a little about the end of the axis, and on it to second order.
    assert place == pytest.approx(points[-1], abs=0.02 * math.radians(2) + 1e-4)
    assert end.heading + drift.turn == pytest.approx(heading(points[1], points[2]), abs=1e-4)


@pytest.mark.parametrize("seed", range(12))
def test_a_wall_meets_a_rectangle_where_one_of_its_points_is_inside(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(50):
        spot = Spot(*rng.uniform(-1, 1, 2), rng.uniform(-4, 4), 0.0)
        low, half = rng.uniform(-1, 0), rng.uniform(0.05, 0.5)
        rectangle = Rectangle("it", spot, low, low + rng.uniform(0.1, 1), half)
        wall = tuple(rng.uniform(-2, 2, 4))
        clear = rng.uniform(0, 0.2)
        share = np.linspace(0, 1, 4001)
        x = wall[0] + share * (wall[2] - wall[0]) - spot.x
        y = wall[1] + share * (wall[3] - wall[1]) - spot.y
        along = math.cos(spot.heading) * x + math.sin(spot.heading) * y
        across = math.cos(spot.heading) * y - math.sin(spot.heading) * x
        inside = np.minimum(
            np.minimum(along - rectangle.low, rectangle.high - along) + clear,
            half + clear - np.abs(across),
        ).max()
        if abs(inside) > 2e-3:
            assert rectangle.meets(wall, clear) == (inside > 0)


def test_the_first_wall_that_the_pair_would_touch_is_the_nearest_one() -> None:
    found = pair([[0, 0], [2, 0], [2, 2]])
    curve = found.curve([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)])
    body = 0.2 + 0.02  # the cube of 20 cm with its wheels
    for x in (0.7, 1.1):
        at = x - found.spread / 2  # in the frame of the curve
        walls = [(at + 0.1, -1.0, at + 0.1, 1.0), (at, -1.0, at, 1.0), (9.0, 0.0, 9.0, 1.0)]
        touch = first_touch(found.footprint.swept(curve, -found.spread / 2, 1.5), walls, 0.0)
        assert touch is not None
        s, what, which = touch
        assert (what, which) == ("the robot that leads", 1)
        front = s + found.spread / 2 + body
        assert front == pytest.approx(at, abs=0.03)


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_walls_of_a_stage_stand_where_the_route_has_them(direction: str) -> None:
    """As far from the start and the end of the path as in the route, and on the same side."""
    wall = (0.3, 0.9, 1.1, 1.4)
    points = [(0.2, 0.1), (1.3, 0.3), (1.9, 1.2)]
    keys = {"task.route.walls_m": [list(wall)], "task.direction": direction}
    found = pair([list(point) for point in points], **keys)
    offset = Offset(ahead_m=0.04)
    scene = found.stage_scene(points, offset)
    line = line_of(scene)
    start, end = line.at(0.0), line.at(found.sense * scene.task.distance_m)
    way = heading(points[0], points[1])
    begins = ahead(points[0], way, offset.ahead_m)
    (seen,) = found.walls_in_stage(points, offset)
    for place, shown in ((wall[:2], seen[:2]), (wall[2:], seen[2:])):
        assert math.dist(shown, (start.x, start.y)) == pytest.approx(math.dist(place, begins))
        assert math.dist(shown, (end.x, end.y)) == pytest.approx(
            math.dist(place, points[-1]), abs=1e-3
        )
    ahead_of, aside = seen_from(begins, way, wall[:2])
    assert found.sense * np.array(seen[:2]) == pytest.approx([ahead_of, aside])

# SPDX-License-Identifier: Apache-2.0
"""Paths on the floor: against circles, Fresnel integrals and brute force; bad ones refused."""

import itertools
import math
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import fresnel

from palmbots.mujoco.path_curve import Curve, curve_of
from palmbots.scene.path_section import Path
from palmbots.scene.scene import load_scene

APART = 0.25


def curve(**keys: Any) -> Curve:
    return curve_of(Path.model_validate(keys), 3.0, APART)


@pytest.mark.parametrize("radius", [0.25, 1.0, 4.0])
@pytest.mark.parametrize("turn", ["left", "right"])
def test_arc_is_a_circle_between_two_clothoids(radius: float, turn: str) -> None:
    ease, side = 0.1, 1.0 if turn == "left" else -1.0
    arc = curve(kind="arc", radius_m=radius, turn=turn, transition_m=ease, angle_deg=90.0)
    spots = [arc.at(s) for s in np.linspace(ease + 0.002, arc.length - ease - 0.002, 57)]
    # All are as far from one centre, at the inside of the turn.
    first = spots[0]
    centre = np.array([first.x, first.y]) + side * radius * np.array(
        [-math.sin(first.heading), math.cos(first.heading)]
    )
    far = [math.hypot(s.x - centre[0], s.y - centre[1]) for s in spots]
    assert far == pytest.approx(len(far) * [radius], abs=3e-6)
    assert all(s.curvature * side == pytest.approx(1 / radius, rel=1e-6) for s in spots)
    # The clothoid before it, by Fresnel's integrals: κ = s / (ease radius).
    scale = math.sqrt(math.pi * ease * radius)
    for s in (0.02, 0.05, 0.1):
        up, ahead = fresnel(s / scale)
        spot = arc.at(s)
        assert (spot.x, spot.y) == pytest.approx((scale * ahead, side * scale * up), abs=3e-6)
    # In all it turns by 90°, and goes straight on.
    assert arc.at(arc.length).heading == pytest.approx(side * math.pi / 2, abs=1e-4)
    after = arc.at(arc.length + 2.0)
    assert after.curvature == 0.0
    assert math.dist((after.x, after.y), (spots[-1].x, spots[-1].y)) > 2.0


def test_s_path_ends_parallel_to_its_start() -> None:
    s = curve(kind="s", radius_m=1.0, angle_deg=45.0)
    end = s.at(s.length)
    assert end.heading == pytest.approx(0.0, abs=1e-6)
    # Two arcs of 45° would end 2 R (1 − cos 45°) = 0.586 m aside; clothoids reach a little further.
    assert 0.586 < end.y < 0.70
    assert s.at(0.5 * s.length).heading == pytest.approx(math.pi / 4, abs=1e-3)
    assert s.sharpest == pytest.approx(1.0)


@pytest.mark.parametrize("corner", [(1.0, 1.0), (2.0, -1.0), (0.2, 1.0), (2.0, 0.0)])
def test_corners_are_rounded_with_the_radius(corner: tuple[float, float]) -> None:
    points = [[0, 0], [1, 0], [*corner], [corner[0], corner[1] + 1]]
    rounded = curve(kind="waypoints", waypoints_m=points, radius_m=0.3, transition_m=0.05)
    spots = [rounded.at(s) for s in np.linspace(0, rounded.length, 999)]
    assert rounded.sharpest == pytest.approx(1 / 0.3, rel=1e-6)
    assert (spots[0].x, spots[0].y, spots[0].curvature) == (0, 0, 0)
    assert (spots[-1].x, spots[-1].y) == pytest.approx(points[-1], abs=1e-4)
    for (ax, ay), (bx, by) in itertools.pairwise(points):  # it touches every line
        along = np.array([bx - ax, by - ay]) / math.hypot(bx - ax, by - ay)
        far = [abs((s.x - ax) * along[1] - (s.y - ay) * along[0]) for s in spots]
        assert min(far) < 1e-3


def test_arc_without_an_angle_extends_beyond_the_task() -> None:
    assert curve(kind="arc", radius_m=0.5).length > 3.0


def test_wide_arc_is_no_longer_than_the_task() -> None:
    wide = curve_of(Path.model_validate({"kind": "arc", "radius_m": 10_000.0}), 1.5, 0.25)
    assert 1.5 < wide.length < 30
    assert wide.at(1.0).curvature == pytest.approx(1e-4)


def test_short_turns_are_cut_and_still_turn_as_far() -> None:
    short = curve(kind="arc", radius_m=0.3, angle_deg=5.0, transition_m=0.5)
    assert short.heading[-1] == pytest.approx(math.radians(5), rel=1e-3)


def test_before_and_behind_the_curve_the_path_is_straight() -> None:
    arc = curve(kind="arc", angle_deg=30.0)
    before = arc.at(-1.5)
    assert (before.x, before.y, before.heading, before.curvature) == (-1.5, 0.0, 0.0, 0.0)


def test_path_through_waypoints_on_a_circle_is_that_circle() -> None:
    angles = np.linspace(0.0, 2.0, 25)
    turned, (ox, oy) = 0.7, (3.0, -1.0)  # in any frame
    points = [(math.sin(a), 1 - math.cos(a)) for a in angles]
    placed = [
        (ox + x * math.cos(turned) - y * math.sin(turned),
         oy + x * math.sin(turned) + y * math.cos(turned))
        for x, y in points
    ]  # fmt: skip
    way = curve(waypoints_m=placed)
    assert way.length == pytest.approx(2.0, rel=2e-3)
    assert way.at(0.5 * way.length).curvature == pytest.approx(1.0, rel=1e-3)
    track = np.stack([way.x, way.y], axis=1)
    start = np.array([track[0], track[-1]])
    assert math.dist(*start) == pytest.approx(math.dist(points[0], points[-1]), rel=1e-6)
    for one in points:  # turned back by the heading of the first point, which is nearly 0 here
        tilt = way_tilt(points)
        x = one[0] * math.cos(tilt) + one[1] * math.sin(tilt)
        y = one[1] * math.cos(tilt) - one[0] * math.sin(tilt)
        assert np.hypot(track[:, 0] - x, track[:, 1] - y).min() < 1.1e-3


def way_tilt(points: list[tuple[float, float]]) -> float:
    """The heading of the natural spline in its first point, by another solver."""
    from scipy.interpolate import make_interp_spline

    places = np.array(points)
    chords = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))))
    dx, dy = make_interp_spline(chords, places, k=3, bc_type="natural")(0.0, 1)
    return math.atan2(dy, dx)


@settings(max_examples=60)
@given(s=st.floats(-0.3, 2.0), off=st.floats(-0.1, 0.1), guess=st.floats(-0.03, 0.03))
def test_the_nearest_place_is_the_nearest(s: float, off: float, guess: float) -> None:
    way = curve(kind="s", radius_m=0.6)
    spot = way.at(s)
    x, y = spot.x - off * math.sin(spot.heading), spot.y + off * math.cos(spot.heading)
    found = way.nearest(x, y, s + guess)
    dense = [way.at(t) for t in np.linspace(s - 0.1, s + 0.1, 401)]
    least = min(math.hypot(p.x - x, p.y - y) for p in dense)
    at = way.at(found)
    assert math.hypot(at.x - x, at.y - y) <= least + 1e-6
    assert found == pytest.approx(s, abs=2e-4)


def test_heading_and_curvature_are_derivatives_of_the_place() -> None:
    way = curve(waypoints_m=[[0, 0], [0.7, 0.1], [1.2, 0.8], [2.0, 1.0]])
    h = 1e-4
    for s in np.linspace(0.01, way.length - 0.01, 23):
        a, b, mid = way.at(s - h), way.at(s + h), way.at(s)
        assert math.atan2(b.y - a.y, b.x - a.x) == pytest.approx(mid.heading, abs=2e-3)
        assert (b.heading - a.heading) / (2 * h) == pytest.approx(mid.curvature, abs=0.02)


def test_mirrored_path_is_the_mirror_image() -> None:
    for keys in (
        {"kind": "arc", "angle_deg": 60.0},
        {"kind": "s", "turn": "right"},
        {"waypoints_m": [[0, 0], [1, 0.2], [2, 1]]},
    ):
        path = Path.model_validate(keys)
        other = path.mirrored()
        assert other != path and other.mirrored() == path
        one, two = (curve_of(p, 3.0, APART) for p in (path, other))
        assert np.allclose(one.x, two.x) and np.allclose(one.y, -two.y)
    scene = load_scene("paper", {"task.path.kind": "s", "task.path.turn": "right"})
    assert scene.mirrored().task.path.turn == "left"
    assert scene.mirrored().mirrored() == scene


# --- files and refusals -------------------------------------------------------------------------


def test_file_of_waypoints_is_stored_as_points(tmp_path: File) -> None:
    file = tmp_path / "way.csv"
    file.write_text("# x,y in m\n0,0\n 1.0, 0.2\n\n2,1\n")
    scene = load_scene("paper", {"task.path.file": str(file)})
    assert scene.task.path.waypoints_m == ((0, 0), (1, 0.2), (2, 1))
    assert (scene.task.path.kind, scene.task.path.file) == ("waypoints", None)
    beside = tmp_path / "scene.toml"
    beside.write_text('task.path.file = "way.csv"\n')
    assert load_scene(beside).task.path == scene.task.path  # not in the working directory
    assert load_scene(beside, {"task.slope_deg": 0}).task.path == scene.task.path
    beside.write_text(f'task.path.file = "{file}"\n')
    assert load_scene(beside).task.path == scene.task.path
    file.unlink()
    assert load_scene(scene.model_dump()) == scene

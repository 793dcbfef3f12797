# SPDX-License-Identifier: Apache-2.0
"""Polygon geometry against an oracle in rational numbers that shares no formula with it."""

import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st

from exact_places import Exact, exact, place_in
from palmbots._core import crossing_edges, hull, is_in_hull, lower_vertices, turn, winding
from palmbots.scene.object_frame import object_frame
from strategies import objects

# On a small grid most polygons touch, overlap or fold somewhere; next to it, tiny steps that
# floating point alone would misjudge.
grid = st.tuples(st.integers(0, 4), st.integers(0, 4)).map(lambda p: (float(p[0]), float(p[1])))
tiny = st.sampled_from([0.0, 2.0**-52, -(2.0**-53), 1e-17, 5e-324])
near_grid = st.tuples(grid, tiny, tiny).map(lambda t: (t[0][0] + t[1], t[0][1] + t[2]))
tenths = st.tuples(st.integers(-9, 9), st.integers(-9, 9)).map(lambda p: (p[0] / 10, p[1] / 10))
anywhere = st.tuples(st.floats(-10, 10), st.floats(-10, 10))
points = st.one_of(grid, near_grid, tenths, anywhere)
polygons = st.one_of(*(st.lists(p, min_size=3, max_size=8) for p in (grid, near_grid, tenths)))

# Most random polygons cross themselves, and the tests of simple ones pass those over.
few_are_simple = settings(
    suppress_health_check=[*settings().suppress_health_check, HealthCheck.filter_too_much]
)


def common(a: Exact, b: Exact, c: Exact, d: Exact) -> list[Exact]:
    """What two segments have in common: nothing, a point, or the two ends of a stretch.

    Solves a + s (b − a) = c + t (d − c) for s and t in [0, 1].
    """
    u = (b[0] - a[0], b[1] - a[1])
    v = (d[0] - c[0], d[1] - c[1])
    k = (c[0] - a[0], c[1] - a[1])
    determinant = v[0] * u[1] - u[0] * v[1]
    if determinant != 0:
        s = (v[0] * k[1] - k[0] * v[1]) / determinant
        t = (u[0] * k[1] - k[0] * u[1]) / determinant
        return [(a[0] + s * u[0], a[1] + s * u[1])] if 0 <= s <= 1 and 0 <= t <= 1 else []
    if k[0] * u[1] != k[1] * u[0]:
        return []
    low, high = max(min(a, b), min(c, d)), min(max(a, b), max(c, d))  # along their line
    return [] if low > high else [low] if low == high else [low, high]


def is_simple(polygon) -> bool:
    ring = [exact(p) for p in polygon]
    n = len(ring)
    if any(ring[i] == ring[i - 1] for i in range(n)):
        return False
    for i in range(n):
        for j in range(i):
            shared = common(ring[i], ring[(i + 1) % n], ring[j], ring[(j + 1) % n])
            if j == i - 1:
                allowed = [ring[i]]
            elif j == 0 and i == n - 1:
                allowed = [ring[0]]
            else:
                allowed = []
            if shared != allowed:
                return False
    return True


def supports_from_below(polygon, left: int, right: int) -> set[int]:
    """The vertices under which some upward-facing line passes with all others above it."""
    ring = [exact(p) for p in polygon]
    dx, dy = ring[right][0] - ring[left][0], ring[right][1] - ring[left][1]
    turned = [(x * dx + y * dy, y * dx - x * dy) for x, y in ring]
    lower = set()
    for k, (x, y) in enumerate(turned):
        others = [(px - x, py - y) for i, (px, py) in enumerate(turned) if i != k]
        below = any(px == 0 and py <= 0 for px, py in others)
        least = [py / px for px, py in others if px < 0]
        most = [py / px for px, py in others if px > 0]
        if not below and (not least or not most or max(least) < min(most)):
            lower.add(k)
    return lower


@given(polygons)
@example([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])
@example([(0.0, 0.0), (2.0, 0.0), (1.0, 0.0)])
@example([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0), (0.0, 1.0)])
def test_crossing_edges_agree_with_exact_intersections(polygon):
    assert (crossing_edges(polygon) is None) == is_simple(polygon)


@given(polygons)
def test_reported_edges_meet(polygon):
    bad = crossing_edges(polygon)
    assume(bad is not None)
    assert bad is not None
    i, j = bad
    ring = [exact(p) for p in polygon]
    n = len(ring)
    assert i <= j
    assert common(ring[i], ring[(i + 1) % n], ring[j], ring[(j + 1) % n])


@few_are_simple
@given(polygons, points)
def test_points_in_the_hull_agree_with_an_exact_oracle(polygon, point):
    assume(crossing_edges(polygon) is None)
    corners = [polygon[k] for k in hull(polygon)]
    assert is_in_hull(point, polygon) == (place_in(point, corners) >= 0)
    assert is_in_hull(polygon[0], polygon)


@few_are_simple
@given(polygons)
def test_winding_is_the_sign_of_the_area(polygon):
    assume(crossing_edges(polygon) is None)
    ring = [exact(p) for p in polygon]
    area = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, ring[1:] + ring[:1], strict=True))
    assert winding(polygon) == (1 if area > 0 else -1)
    assert winding(polygon[::-1]) == -winding(polygon)


@few_are_simple
@given(polygons, st.data())
def test_lower_vertices_agree_with_brute_force(polygon, data):
    assume(crossing_edges(polygon) is None)
    left = data.draw(st.integers(0, len(polygon) - 1))
    right = data.draw(st.integers(0, len(polygon) - 1).filter(lambda k: k != left))
    assert set(lower_vertices(polygon, left, right)) == supports_from_below(polygon, left, right)


@given(points, points, points)
def test_turn_is_the_exact_sign_of_the_cross_product(a, b, c):
    (ax, ay), (bx, by), (cx, cy) = exact(a), exact(b), exact(c)
    cross = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    assert turn(a, b, c) == (cross > 0) - (cross < 0)
    assert turn(b, a, c) == -turn(a, b, c)


def test_points_on_a_side_are_no_corners_of_the_hull():
    square = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 1.0), (0.0, 2.0)]
    assert hull(square) == [0, 2, 3, 5]


def bits(frame) -> list[str]:
    corners = [frame.com, *frame.outline]
    numbers = [frame.width] + [x for c in corners for x in (c.from_left, c.from_right, c.height)]
    return [x.hex() for x in numbers]


@given(objects())
def test_the_frame_keeps_shape_and_winding(item):
    vertices = item["vertices_m"]
    left, right = item["contacts"]
    frame = object_frame([(x, y) for x, y in vertices], (left, right), tuple(item["com_m"]))
    assert (frame.outline[0].from_left, frame.outline[0].height) == (0, 0)
    assert frame.outline[frame.contact_right].from_right == 0
    outline = [(c.from_left, c.height) for c in frame.outline]
    assert winding(outline) == 1
    order = [(left + winding(vertices) * k) % len(vertices) for k in range(len(vertices))]
    distance = lambda a, b: ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) ** 0.5  # noqa: E731
    for p, i in zip(outline, order, strict=True):
        for q, j in zip(outline, order, strict=True):
            assert distance(p, q) == pytest.approx(distance(vertices[i], vertices[j]), abs=1e-12)
    for corner in (frame.com, *frame.outline):
        assert corner.from_left + corner.from_right == pytest.approx(frame.width, abs=1e-12)


def test_the_frame_of_the_papers_box_is_the_box():
    frame = object_frame([(0, 0), (0.25, 0), (0.25, 0.16), (0, 0.16)], (0, 1), (0.125, 0.04))
    assert frame.width == 0.25
    assert (frame.com.from_left, frame.com.from_right, frame.com.height) == (0.125, 0.125, 0.04)
    assert [(c.from_left, c.height) for c in frame.outline] == [
        (0, 0), (0.25, 0), (0.25, 0.16), (0, 0.16)
    ]  # fmt: skip


def test_the_frame_adds_no_negative_zeros():
    box = [(0.0, 0.0), (0.25, 0.0), (0.25, 0.16), (0.0, 0.16)]
    turned = [(-x, -y) for x, y in box]
    for vertices, com in ((box, (0.125, 0.04)), (turned, (-0.125, -0.04))):
        frame = object_frame(vertices, (0, 1), com)
        assert not any(x.startswith("-0x0.0p") for x in bits(frame))

# SPDX-License-Identifier: Apache-2.0
"""Rounded polygons are found again in their outlines: dense and noisy, or coarse facets.

Outlines are walked along edges and arcs here, without code of the package.
"""

import math
from pathlib import Path

import numpy as np
import pytest

import palmbots as pb
from palmbots.shapes.fitting import polygon_of
from palmbots.shapes.point_arrays import Points
from palmbots.shapes.rounded_outline import boundary, deviation_m
from sampled import amounts
from shape_files import prism, stl, written

DATA = Path(__file__).parents[3] / "shared" / "data" / "shapes"
BOX = np.array([(0.0, 0.0), (0.25, 0.0), (0.25, 0.16), (0.0, 0.16)])


def turns_of(vertices: Points) -> Points:
    """Angles by which the outline turns at its vertices, in [-π, π]."""
    after = np.roll(vertices, -1, axis=0) - vertices
    angles = np.arctan2(*after.T[::-1])
    return (angles - np.roll(angles, 1) + math.pi) % (2 * math.pi) - math.pi


def walked(vertices: Points, radii: Points, step: float = 0.0, facets: int = 0) -> Points:
    """Points every `step` along the outline, or only the ends of the `facets` of each arc."""
    found: list[Points] = []
    for k, (vertex, radius, turn) in enumerate(
        zip(vertices, radii, turns_of(vertices), strict=True)
    ):
        along = vertex - vertices[k - 1]
        along = along / math.hypot(*along)
        inward = np.array([-along[1], along[0]])
        count = facets or math.ceil(abs(radius * turn) / step)
        angles = np.linspace(0, turn, count + 1)[:, None] if radius else np.zeros((1, 1))
        centre = vertex - radius * math.tan(turn / 2) * along + radius * inward
        found.append(centre + radius * (np.sin(angles) * along - np.cos(angles) * inward))
    corners = np.vstack(found)
    if not step:
        return corners
    dense = []
    for one, other in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = max(1, math.ceil(math.dist(one, other) / step))
        dense.append(one + np.arange(count)[:, None] / count * (other - one))
    return np.vstack(dense)


def drawn(rng: np.random.Generator) -> tuple[Points, Points]:
    """A convex polygon on a level base, a quarter of its corners sharp."""
    while True:
        count = int(rng.integers(4, 9))
        width, height = rng.uniform(0.1, 0.3), rng.uniform(0.05, 0.2)
        angles = np.sort(rng.uniform(0.15, math.pi - 0.15, count - 2))
        above = np.column_stack([0.55 * width * np.cos(angles), 0.02 + height * np.sin(angles)])
        vertices = np.vstack([[(-width / 2, 0.0), (width / 2, 0.0)], above])
        turns, lengths = turns_of(vertices), np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
        if (
            turns.min() > math.radians(25)
            and turns.max() < math.radians(140)
            and lengths.min() > 0.03
        ):
            break
    room = 0.45 * np.minimum(lengths, np.roll(lengths, 1)) / np.tan(turns / 2)
    radii = np.minimum(rng.uniform(0.002, 0.03, count), room)
    return vertices, np.where(rng.random(count) < 0.25, 0.0, radii)


@pytest.mark.parametrize("noise_m", [0.0, 1e-7, 1e-6])
@pytest.mark.parametrize("count", amounts(5, 400))
def test_hidden_radii_are_found(noise_m: float, count: int) -> None:
    """To a micrometre, and what the noise is worth: between an arc and its corner is only the
    radius times (1 / cos(turn / 2) − 1), so a radius of 25° is uncertain by 40 times the noise."""
    rng = np.random.default_rng(5)
    for _ in range(count):
        vertices, radii = drawn(rng)
        outline = walked(vertices, radii, step=0.001)
        outline = outline + rng.normal(0.0, noise_m, outline.shape)
        size = np.ptp(outline, axis=0)
        fitted = polygon_of(outline, min(0.005 * size.max(), 0.02 * size.min()), 32)
        assert len(fitted.vertices) == len(vertices)
        order = np.argmin(
            np.hypot(*(fitted.vertices - vertices[:, None]).transpose(2, 0, 1)), axis=1
        )
        cut = 1 / np.cos(turns_of(vertices) / 2) - 1
        off = np.abs(fitted.radii[order] - radii)
        assert (off < 1e-6 + 3 * noise_m / cut).all()
        assert np.abs(fitted.vertices[order] - vertices).max() < 1e-6 + 5 * noise_m
        assert ((fitted.radii[order] == 0) == (radii == 0)).all()


@pytest.mark.parametrize("facets", [2, 3, 4, 6, 12, 24])
def test_facets_of_an_arc_are_one_corner(facets: int, tmp_path: Path) -> None:
    """The corners of a mesh lie on the arc. Its facets are chords, off by up to the deviation."""
    outline = 1000 * walked(BOX, np.full(4, 0.01), facets=facets)
    file = written(tmp_path / "box.stl", stl(prism([(x, y) for x, y in outline], 90.0)))
    found = pb.import_object(file, unit="mm")
    assert sorted(found.vertices_m) == sorted((x, y) for x, y in BOX.tolist())
    assert found.edge_radius_m == 0.01
    sagitta = 0.01 * (1 - math.cos(math.pi / 4 / facets))
    assert found.deviation_m == pytest.approx(sagitta, abs=2e-5)
    assert found.deviation_m <= found.tolerance_m


@pytest.mark.parametrize("bevel_m", [0.0, 0.001, 0.005])
def test_sharp_corners_and_bevels_stay(bevel_m: float, tmp_path: Path) -> None:
    """Also where the numbers of the file have single precision."""
    outline = walked(BOX, np.full(4, bevel_m), facets=1) if bevel_m else BOX
    outline = np.array(1000 * outline, np.float32)
    file = written(
        tmp_path / "box.stl", stl(prism([(float(x), float(y)) for x, y in outline], 90.0))
    )
    found = pb.import_object(file, unit="mm")
    exact = [(round(x / 1000, 6), round(y / 1000, 6)) for x, y in outline.tolist()]
    assert sorted(found.vertices_m) == sorted(exact)
    assert found.edge_radius_m == 0


@pytest.mark.parametrize("noise_m", [0.0001, 0.0002])
def test_a_noisy_scan_of_a_rounded_box_has_four_corners(noise_m: float) -> None:
    rng = np.random.default_rng(3)
    outline = walked(BOX, np.full(4, 0.012), step=0.002)
    outline = outline + rng.normal(0.0, noise_m, outline.shape)
    fitted = polygon_of(outline, 0.00125, 32)
    assert len(fitted.vertices) == 4
    assert fitted.radii == pytest.approx([0.012] * 4, abs=20 * noise_m)
    assert fitted.deviation_m <= 0.00125


@pytest.mark.parametrize("radius_m", [1.6, 6.4])
def test_no_arc_has_a_circle_that_leaves_the_outline(radius_m: float) -> None:
    """A side that bulges by 2 or by 0.5 mm. In MuJoCo each arc is a whole ball."""
    bulge = np.linspace(-0.08, 0.08, 62)[1:-1] / radius_m
    depth = radius_m * (np.cos(bulge) - math.cos(0.08 / radius_m))
    arc = np.column_stack([-depth, 0.08 - radius_m * np.sin(bulge)])
    fitted = polygon_of(np.vstack([BOX, arc]), 0.00125, 32)
    assert fitted.deviation_m < 0.0002
    assert fitted.radii.max() < 0.1


def test_deviation_is_measured_both_ways() -> None:
    """A spike of either outline counts."""
    spiked = np.insert(BOX, 2, [(0.25, 0.08), (0.27, 0.081), (0.25, 0.082)], axis=0)
    assert deviation_m(BOX, spiked) == pytest.approx(0.02)
    assert deviation_m(spiked, BOX) == pytest.approx(0.02)
    rounded = boundary(BOX, np.full(4, 0.02))
    assert deviation_m(rounded, BOX) == pytest.approx(0.02 * (math.sqrt(2) - 1), abs=2e-5)


@pytest.mark.skipif(not DATA.is_dir(), reason="needs ../shared/data/shapes")
@pytest.mark.parametrize(
    ("name", "up", "radius_mm"),
    [("006_mustard_bottle", "z", (9.0, 4.2)), ("004_sugar_box", "-z", (3.0, 3.9))],
)
def test_household_objects_roll_as_their_meshes(
    name: str, up: str, radius_mm: tuple[float, float]
) -> None:
    """Where palms of 2° to 20° touch the mesh they touch the object, within the tolerance, and at
    about the same place. The foot of the bottle is an arc."""
    file = DATA / "ycb" / f"{name}_textured.gltf"
    found = pb.import_object(
        file, up=up, across="x", align=True, view="silhouette", mass_kg=0.5, com_mm=(90.0, 30.0)
    )
    edge = boundary(np.array(found.vertices_m), np.array(found.radii_m))
    for side, out in enumerate((-1.0, 1.0)):
        assert found.radii_m[found.contacts[side]] == pytest.approx(
            radius_mm[side] / 1000, abs=5e-4
        )
        for tilt in np.radians(np.arange(2.0, 20.1)):
            normal = np.array([-out * math.sin(tilt), math.cos(tilt)])
            one, other = (points[np.argmin(points @ normal)] for points in (found.outline_m, edge))
            assert abs((one - other) @ normal) < found.tolerance_m
            assert math.dist(one, other) < 0.003

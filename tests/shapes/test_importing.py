# SPDX-License-Identifier: Apache-2.0
"""Objects from drawings and meshes: area, mass and centre of mass against closed forms, units, what
points upwards, and that a written object can be carried.

The closed forms share no code with the package: the shoelace formula, an ellipse, a prism.
"""

import math
import shlex
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from commands import Run
from palmbots.errors import MissingExtra
from palmbots.shapes.rounded_outline import boundary
from shape_files import Point, dxf, gltf, line, obj, prism, stl, svg, written

TRAPEZOID = [(0.0, 0.0), (240.0, 0.0), (320.0, 120.0), (-80.0, 120.0)]
DATA = Path(__file__).parents[3] / "shared" / "data" / "shapes"


def shoelace(points: Sequence[tuple[float, float]]) -> tuple[float, float, float]:
    """Area and centroid."""
    area = x = y = 0.0
    for (a, b), (c, d) in zip(points, [*points[1:], points[0]], strict=True):
        cross = a * d - b * c
        area, x, y = area + cross / 2, x + (a + c) * cross / 6, y + (b + d) * cross / 6
    return area, x / area, y / area


def imported(folder: Path, name: str, text: str, **options: Any) -> Any:
    return pb.import_object(written(folder / name, text), **options)


@pytest.mark.parametrize(
    ("name", "make", "options"),
    [
        ("t.stl", lambda mesh: stl(mesh), {"unit": "mm"}),
        ("t.obj", lambda mesh: obj(mesh), {"unit": "mm"}),
        ("t.gltf", lambda mesh: gltf(mesh), {"unit": "mm", "up": "z"}),
        ("t.gltf", lambda mesh: gltf(mesh), {"scale": 0.001, "up": "z"}),
    ],
    ids=["STL", "OBJ", "glTF in mm", "glTF scaled"],
)
def test_prism_has_its_volume_and_centre(
    name: str, make: Any, options: dict[str, Any], tmp_path: Path
) -> None:
    found = imported(tmp_path, name, make(prism(TRAPEZOID, 90.0)), density_kg_m3=200.0, **options)
    area, x, y = shoelace(TRAPEZOID)
    assert found.mass_kg == pytest.approx(200 * area * 90 * 1e-9, rel=1e-5)
    assert found.com_m == pytest.approx(((x + 80) / 1000, y / 1000), abs=2e-6)
    assert found.depth_m == pytest.approx(0.09, abs=1e-6)
    corners = {(round(1000 * x - 80), round(1000 * y)) for x, y in found.vertices_m}
    assert corners == {(x, y) for x, y in TRAPEZOID}
    assert [found.vertices_m[k] for k in found.contacts] == [(0.08, 0.0), (0.32, 0.0)]
    assert (found.edge_radius_m, found.remarks) == (0, ())
    silhouette = pb.import_object(tmp_path / name, view="silhouette", **options)
    assert np.allclose(sorted(silhouette.vertices_m), sorted(found.vertices_m), atol=2e-6)


def test_volume_is_that_of_the_whole_mesh_not_of_its_section(tmp_path: Path) -> None:
    """A pyramid with a square base: a third of the prism, whose section is a triangle."""
    a, h = 300.0, 120.0
    base: list[Point] = [(0.0, 0.0, 0.0), (a, 0.0, 0.0), (a, a, 0.0), (0.0, a, 0.0)]
    vertices = [*base, (a / 2, a / 2, h)]
    faces = [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    found = imported(tmp_path, "p.stl", stl((vertices, faces)), unit="mm", density_kg_m3=100.0)
    assert found.mass_kg == pytest.approx(100 * a * a * h / 3 * 1e-9, rel=1e-5)
    assert found.com_m == pytest.approx((a / 2000, h / 4000), abs=2e-6)
    assert len(found.vertices_m) == 3
    cut = pb.import_object(tmp_path / "p.stl", unit="mm", cut=0.75)
    assert max(y for _, y in cut.vertices_m) == pytest.approx(h / 2000, abs=2e-6)
    assert cut.mass_kg == pytest.approx(125 / 100 * found.mass_kg, rel=1e-5)


@pytest.mark.parametrize("tolerance_mm", [0.6, 1.0, None])
def test_half_ellipse_on_a_box(tolerance_mm: float | None, tmp_path: Path) -> None:
    """An SVG arc: the polygon keeps to the tolerance, the mass is that of the true curve."""
    a, b, h = 125.0, 80.0, 60.0
    text = svg(f'<path d="M0 160 H{2 * a} V{160 - h} A{a} {b} 0 0 0 0 {160 - h} Z"/>')
    found = imported(tmp_path, "dome.svg", text, tolerance_mm=tolerance_mm, depth_mm=200.0)
    box, dome = 2 * a * h, math.pi * a * b / 2
    area = box + dome
    y = (box * h / 2 + dome * (h + 4 * b / (3 * math.pi))) / area
    assert found.mass_kg == pytest.approx(125 * area * 200 * 1e-9, rel=3e-4)
    # From the left end of the object, which is off by up to the deviation.
    assert found.com_m == pytest.approx((a / 1000, y / 1000), abs=found.deviation_m)
    assert found.deviation_m <= found.tolerance_m
    assert any(found.radii_m)
    for x, y in 1000 * boundary(np.array(found.vertices_m), np.array(found.radii_m)) - (a, h):
        if y > 0 and abs(x) < 0.98 * a:
            assert abs(y - b * math.sqrt(1 - (x / a) ** 2)) < 2.5 * 1000 * found.tolerance_m


@pytest.mark.parametrize("box", [(1200, 30, 6), (250, 160, 20), (60, 60, 3)])
def test_a_rounded_box_becomes_one(box: tuple[int, int, int], tmp_path: Path) -> None:
    """Of a flat plank the tolerance follows the height. The object fares like one from a ruler."""
    length, height, radius = box
    text = svg(f'<rect x="10" y="10" width="{length}" height="{height}" rx="{radius}"/>')
    found = imported(tmp_path, "box.svg", text, depth_mm=200.0, mass_kg=1.0)
    assert found.tolerance_m <= 0.02 * height / 1000
    assert len(found.vertices_m) == 4 and not found.remarks
    assert found.edge_radius_m == pytest.approx(radius / 1000, rel=0.01)
    measured = [length / 1000, height / 1000]
    sides = np.ptp(np.array(found.vertices_m), axis=0)
    assert sides == pytest.approx(measured, abs=found.tolerance_m)
    assert found.com_m == pytest.approx(np.array(measured) / 2, abs=found.tolerance_m)
    drawn = found.object.model_dump(exclude={"box_m"})
    ruler = {"box_m": measured, "edge_radius_m": radius / 1000, "mass_kg": 1.0}
    palm = {"length_m": min(0.15, 0.6 * measured[0])}
    scenes = [{"object": one, "palm": palm} for one in (drawn, ruler)]
    ends = [pb.carry(scene, "shared-sign").outcome for scene in scenes]
    assert ends[0] == ends[1]


def test_only_convex_corners_are_rounded(tmp_path: Path) -> None:
    """A half circle is two of them; a hollow keeps its chords."""
    path = "M0 100 H200 V50 A50 50 0 0 0 100 50 V30 A10 10 0 0 1 90 20 H10 A10 10 0 0 0 0 30 Z"
    found = imported(tmp_path, "o.svg", svg(f'<path d="{path}"/>'), depth_mm=90.0)
    radii = [radius for radius in found.radii_m if radius]
    assert sorted(radii) == pytest.approx([0.01, 0.05, 0.05], abs=1e-4)
    assert found.deviation_m <= found.tolerance_m


def test_lines_and_arcs_of_a_dxf_are_joined_in_any_order_and_direction(tmp_path: Path) -> None:
    """A stadium on its side, of loose lines and arcs; units by $INSUNITS."""
    parts = [
        line(0, 0, 200, 0),
        ("ARC", 10, 100, 20, 100, 40, 100, 50, 0, 51, 180),
        line(0, 100, 0, 0),
        line(200, 100, 200, 0),
    ]
    found = imported(tmp_path, "d.dxf", dxf(parts))
    area = 200 * 100 + math.pi * 100**2 / 2
    assert found.mass_kg == pytest.approx(125 * area * 100 * 1e-9, rel=3e-4)
    y = (20000 * 50 + math.pi * 5000 * (100 + 400 / (3 * math.pi))) / area
    assert found.com_m == pytest.approx((0.1, y / 1000), abs=3e-5)
    inches = imported(tmp_path, "i.dxf", dxf([part for part in parts if part[0] == "LINE"] + [
        line(0, 100, 200, 100)], 1), scale=0.1)  # fmt: skip
    assert inches.metres_per_unit == pytest.approx(0.00254)
    assert max(inches.vertices_m) == pytest.approx((0.508, 0.254))


@pytest.mark.parametrize(
    ("size", "options", "metres"),
    [
        ('width="210mm" height="148mm" viewBox="0 0 2100 1480"', {}, 1e-4),
        ('width="21cm" viewBox="0 0 210 148"', {}, 1e-3),
        ('width="10in" height="5in"', {}, 0.0254 / 96),
        ('width="640" viewBox="0 0 320 240"', {"unit": "mm"}, 1e-3),
        ("", {"unit": "cm", "scale": 0.1}, 1e-3),
    ],
)
def test_unit_of_an_svg(size: str, options: dict[str, Any], metres: float, tmp_path: Path) -> None:
    shapes = '<g transform="translate(5 5)"><rect width="200" height="100"/></g>'
    found = imported(tmp_path, "u.svg", svg(shapes, size), **options)
    assert found.metres_per_unit == pytest.approx(metres)
    xs, ys = zip(*found.vertices_m, strict=True)
    assert (max(xs), max(ys)) == pytest.approx((200 * metres, 100 * metres), abs=2e-6)


@pytest.mark.parametrize(("up", "high"), [("y", 0.11), ("-y", 0.11), ("x", 0.25), ("-x", 0.25)])
def test_what_points_upwards(up: str, high: float, tmp_path: Path) -> None:
    """A box without its upper right corner: its centre is left and low."""
    text = svg('<path d="M0 0 H200 L250 40 V110 H0 Z"/>')
    found = imported(tmp_path, "l.svg", text, up=up)
    assert max(y for _, y in found.vertices_m) == pytest.approx(high)
    x, y = found.com_m
    left, low = x < max(x for x, _ in found.vertices_m) / 2, y < high / 2
    assert (left, low) == {"y": (True, True), "-y": (False, False), "x": (False, True),
                           "-x": (True, False)}[up]  # fmt: skip


def test_mesh_that_is_nearly_upright_is_turned(tmp_path: Path) -> None:
    c, s = math.cos(math.radians(1.5)), math.sin(math.radians(1.5))
    box = [(0.0, 0.0), (250.0, 0.0), (250.0, 160.0), (0.0, 160.0)]
    tilted = prism([(c * x - s * y, s * x + c * y) for x, y in box], 100.0)
    found = imported(tmp_path, "t.stl", stl(tilted), unit="mm")
    assert found.vertices_m[found.contacts[1]] == pytest.approx((0.25, 0.0), abs=2e-6)
    assert found.com_m == pytest.approx((0.125, 0.08), abs=2e-6)
    (remark,) = found.remarks
    assert remark == "It is turned clockwise by 1.5° to stand on its lower side."


def test_outline_with_many_corners_is_followed_less_closely(tmp_path: Path) -> None:
    teeth = "".join(f"L{250 - 12.5 * k} 60 L{243.75 - 12.5 * k} 52 " for k in range(20))
    text = svg(f'<path d="M0 160 H250 V60 {teeth} L0 60 Z"/>')
    found = imported(tmp_path, "saw.svg", text, depth_mm=100.0)
    assert len(found.vertices_m) <= 32
    assert 0.00125 < found.deviation_m <= found.tolerance_m
    (remark,) = found.remarks
    assert remark == "Within the usual tolerance of 1.2 mm it would need more than 32 corners."


def test_missing_package_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = written(tmp_path / "t.stl", stl(prism(TRAPEZOID, 90.0)))
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(MissingExtra, match=r"^import: the package trimesh is missing; run: "):
        pb.import_object(file, unit="mm")


def test_what_is_ignored_is_said(tmp_path: Path) -> None:
    shapes = '<rect width="200" height="100"/><circle cx="50" cy="50" r="9"/><rect x="220" width="9" height="9"/>'  # noqa: E501
    found = imported(tmp_path, "h.svg", svg(shapes), depth_mm=100.0)
    assert found.remarks == ("1 hole is ignored.", "1 smaller outline is ignored.")
    assert found.mass_kg == pytest.approx(0.25)


def test_mesh_that_is_not_closed_needs_mass_and_com(tmp_path: Path) -> None:
    vertices, faces = prism(TRAPEZOID, 90.0)
    file = written(tmp_path / "open.stl", stl((vertices, faces[1:])))
    with pytest.raises(pb.PalmbotsError, match="the mesh is not closed"):
        pb.import_object(file, unit="mm", mass_kg=0.4)
    found = pb.import_object(file, unit="mm", mass_kg=0.4, com_mm=(200.0, 50.0))
    assert (found.mass_kg, found.com_m) == (0.4, (0.2, 0.05))


def test_written_object_is_carried(tmp_path: Path, here: Run) -> None:
    file = written(tmp_path / "t.stl", stl(prism(TRAPEZOID, 90.0)))
    result = here("import", str(file), "--unit", "mm", "--out", str(tmp_path / "t.toml"))
    assert result.returncode == 0, result
    assert (tmp_path / "t.png").stat().st_size > 1000
    command = result.stdout.partition("carry it: palmbots ")[2].splitlines()[0]
    assert here(*shlex.split(command)).stdout.startswith("DELIVERED")
    table = tomllib.loads((tmp_path / "t.toml").read_text("utf-8"))
    scene = pb.load_scene("paper", {"object": str(tmp_path / "t.toml")})
    assert scene.object.model_dump(exclude={"box_m"}) == pb.load_scene(
        "paper", table
    ).object.model_dump(exclude={"box_m"})


def test_object_that_is_too_narrow_comes_with_palms_that_have_room(
    tmp_path: Path, here: Run
) -> None:
    """The longest palms: with one millimetre more they would collide. The command carries it."""
    box: list[Point] = [(0.0, 0.0), (120.0, 0.0), (120.0, 60.0), (0.0, 60.0)]
    narrow = written(tmp_path / "narrow.stl", stl(prism(box, 90.0)))
    result = here("import", str(narrow), "--unit", "mm", "--out", str(tmp_path / "n.toml"))
    found = pb.import_object(narrow, unit="mm")
    assert found.palm_length_m is not None and 0.1 < found.palm_length_m < 0.15
    command = result.stdout.partition("carry it: palmbots ")[2].splitlines()[0]
    assert here(*shlex.split(command)).stdout.startswith("DELIVERED")
    longer = shlex.split(command.replace(f"{found.palm_length_m}", f"{found.palm_length_m + 1e-3}"))
    assert "the palms would collide" in here(*longer).stderr
    flat = [(x / 8, z / 4) for x, z in box]
    result = here("import", str(written(tmp_path / "f.stl", stl(prism(flat, 90.0)))), "--unit=mm")
    assert "refused: palm.length_m" in result.stdout and "carry it" not in result.stdout


def test_plane_of_the_section_is_counted_from_the_least_coordinate(tmp_path: Path) -> None:
    """A long box in front of a short one."""
    vertices: list[Point] = []
    faces: list[tuple[int, int, int]] = []
    for low, x in ((0.0, 240.0), (60.0, 140.0)):
        one, sides = prism([(-x / 2, 0.0), (x / 2, 0.0), (x / 2, 90.0), (-x / 2, 90.0)], 40.0)
        n = len(vertices)
        faces += [(n + i, n + j, n + k) for i, j, k in sides]
        vertices += [(px, low + py, pz) for px, py, pz in one]
    file = written(tmp_path / "two.stl", stl((vertices, faces)))
    for cut, length in ((0.3, 0.24), (0.7, 0.14)):
        found = pb.import_object(file, unit="mm", cut=cut)
        assert max(x for x, _ in found.vertices_m) == pytest.approx(length)


def test_given_com_is_that_of_the_object_as_it_stands(tmp_path: Path) -> None:
    """From the left end and the bottom of a box that leans by 2° in its file."""
    c, s = math.cos(math.radians(2)), math.sin(math.radians(2))
    box: list[Point] = [(0.0, 0.0), (240.0, 0.0), (240.0, 120.0), (0.0, 120.0)]
    leans: list[Point] = [(c * x - s * z, s * x + c * z) for x, z in box]
    file = written(tmp_path / "leans.stl", stl(prism(leans, 90.0)))
    found = pb.import_object(file, unit="mm", com_mm=(100.0, 30.0))
    assert "clockwise by 2°" in found.remarks[0]
    assert found.com_m == (0.1, 0.03)


def test_bodies_that_overlap_are_reported(tmp_path: Path) -> None:
    """Neither bodies beside each other, nor the cavity of a hollow one."""
    vertices, faces = prism(TRAPEZOID, 90.0)
    size = len(vertices)

    def remark(shift: float, scale: float = 1.0, *, inwards: bool = False) -> bool:
        middle = np.mean(vertices, axis=0)
        other = [tuple(middle + scale * (np.array(v) - middle) + (shift, 0, 0)) for v in vertices]
        turned = [(k, j, i) if inwards else (i, j, k) for i, j, k in faces]
        more = [(size + i, size + j, size + k) for i, j, k in turned]
        file = written(tmp_path / "two.stl", stl((vertices + other, faces + more)))
        return any("overlap" in line for line in pb.import_object(file, unit="mm").remarks)

    assert remark(5.0) and not remark(500.0, 0.1)
    assert remark(0.0, 0.5) and not remark(0.0, 0.5, inwards=True)


def test_a_scan_that_is_turned_in_space_is_aligned(tmp_path: Path) -> None:
    """A box turned about two axes, each way; without `align`, it is longer."""
    box: list[Point] = [(0.0, 0.0), (240.0, 0.0), (240.0, 120.0), (0.0, 120.0)]
    vertices, faces = prism(box, 90.0)
    for name, (about_up, about_x) in {"one": (25.0, 8.0), "other": (-31.0, -12.0)}.items():
        a, b = math.radians(about_up), math.radians(about_x)
        spin = np.array([[math.cos(a), -math.sin(a), 0], [math.sin(a), math.cos(a), 0], [0, 0, 1]])
        lean = np.array([[1, 0, 0], [0, math.cos(b), -math.sin(b)], [0, math.sin(b), math.cos(b)]])
        turned = [tuple(map(float, point)) for point in np.array(vertices) @ (spin @ lean).T]
        file = written(tmp_path / f"{name}.stl", stl((turned, faces)))
        found = pb.import_object(file, unit="mm", align=True)
        corners = {(round(1000 * x), round(1000 * y)) for x, y in found.vertices_m}
        assert corners == {(x, y) for x, y in box}
        assert found.com_m == pytest.approx((0.12, 0.06), abs=1e-5)
        assert found.depth_m == pytest.approx(0.09, abs=1e-5)
        assert "parallel to the axes" in found.remarks[0]
        as_it_is = pb.import_object(file, unit="mm", view="silhouette")
        assert max(as_it_is.vertices_m)[0] > 0.25


@pytest.mark.parametrize(("rise", "is_outer"), [(0.5, True), (0.6, True), (4.0, False)])
def test_contacts_are_where_steep_palms_touch(rise: float, is_outer: bool, tmp_path: Path) -> None:
    """Both ends of the bottom rise by `rise` over 10 mm. Palms of 15° touch what lies lowest along
    their normal; with contacts elsewhere no carry begins."""
    w = 250.0
    shape = [(-10.0, rise), (0.0, 0.0), (w, 0.0), (w + 10, rise), (w + 10, 100.0), (-10.0, 100.0)]
    line_ = " ".join(f"{x + 10},{120 - y}" for x, y in shape)
    found = imported(tmp_path, "t.svg", svg(f'<polygon points="{line_}"/>'), tolerance_mm=0.05)
    ends = [tuple(round(1000 * x, 3) for x in found.vertices_m[k]) for k in found.contacts]
    outer, inner = [(0.0, rise), (w + 20, rise)], [(10.0, 0.0), (w + 10, 0.0)]
    assert ends == (outer if is_outer else inner)
    assert (rise < 10 * math.tan(math.radians(15))) == is_outer
    assert found.carried == "delivered"
    wrong = [k for k, (x, _) in enumerate(found.vertices_m) if round(1000 * x) in (10, w + 10)]
    if is_outer:
        table = {name: getattr(found, name) for name in ("vertices_m", "com_m", "mass_kg")}
        with pytest.raises(pb.SceneError, match=r"would lie in the object, by 2\.\d mm at the"):
            pb.carry("paper", overrides={"object": table | {"contacts": sorted(wrong)}})


@pytest.mark.skipif(not DATA.is_dir(), reason="needs ../shared/data/shapes")
def test_scan_of_a_household_object() -> None:
    """The cracker box of the YCB set is 60 mm × 158 mm × 210 mm by its makers."""
    found = pb.import_object(DATA / "ycb" / "003_cracker_box_textured.gltf")
    xs, ys = zip(*found.vertices_m, strict=True)
    assert max(ys) == pytest.approx(0.21, abs=0.005)
    assert max(xs) == pytest.approx(0.066, abs=0.01)
    assert found.deviation_m <= found.tolerance_m

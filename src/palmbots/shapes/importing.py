# SPDX-License-Identifier: Apache-2.0
"""The command ``import``: an object from a drawing or a mesh.

The steps: lines or triangles from the file (`drawings`, `meshes`), one closed outline in metres
(`outlines`), few corners in its place (`fitting`), then mass and centre of mass from the volume.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import ValidationError

import palmbots._core as _core
from palmbots._types import Interval
from palmbots._util.arguments import one_of, show, two_numbers
from palmbots._util.atomic_files import read_regular
from palmbots._util.command import Option, command
from palmbots._util.text import millimetres
from palmbots._util.user_paths import user_path
from palmbots.errors import MissingExtra, PalmbotsError, one_line
from palmbots.scene.core_keys import most_records
from palmbots.scene.error_messages import validation_message
from palmbots.scene.object_library import IMPORTED
from palmbots.scene.object_section import Object
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.shapes.body_from_file import (
    SEEN,
    UNITS,
    Body,
    Given,
    of_drawing,
    of_mesh,
    refuse_one_point,
    settled,
)
from palmbots.shapes.drawings import read_dxf, read_svg
from palmbots.shapes.fitting import Fitted, polygon_of
from palmbots.shapes.imported_object import ImportedObject
from palmbots.shapes.meshes import read_mesh
from palmbots.shapes.outlines import area_and_centroid
from palmbots.shapes.point_arrays import Points
from palmbots.shapes.rounded_outline import boundary, rounded
from palmbots.simulation.single import carry

_AXES = ("x", "y", "z", "-x", "-y", "-z")
_DRAWINGS = {".svg": read_svg, ".dxf": read_dxf}
_MESHES = {".stl": "z", ".obj": "z", ".gltf": "y", ".glb": "y"}  # and the axis that points upwards
_USUAL, _COARSEST = 0.005, 0.1  # tolerance, of the size
_USUAL_OF_LESSER = 0.02  # of the smaller of length and height
_SHORTEST_PALM_MM = 20  # of which the zero zone is half


@command(
    "import",
    order=125,
    example="palmbots import bottle.stl --unit mm --out bottle.toml",
    file=Option(is_file=True),
    unit=Option(metavar="mm|cm|m|in"),
    scale=Option(metavar="FACTOR"),
    up=Option(metavar="AXIS"),
    across=Option(metavar="AXIS"),
    align=Option(),
    view=Option(metavar="section|silhouette"),
    cut=Option("--cut-percent", percent=True, least=0.01, most=0.99),
    tolerance_mm=Option(),
    depth_mm=Option(),
    density_kg_m3=Option("--density", least=1.0, most=30000.0),
    mass_kg=Option(),
    com_mm=Option(metavar="X Y"),
)
def import_object(
    file: str | os.PathLike[str],
    *,
    unit: str | None = None,
    scale: float | None = None,
    up: str | None = None,
    across: str | None = None,
    align: bool = False,
    view: Literal["section", "silhouette"] = "section",
    cut: float = 0.5,
    tolerance_mm: float | None = None,
    depth_mm: float | None = None,
    density_kg_m3: float = 125.0,
    mass_kg: float | None = None,
    com_mm: Interval | None = None,
) -> ImportedObject:
    """Make an object from an SVG, DXF, STL, OBJ or glTF file.

    The outline of a drawing, or of a mesh seen from the side, becomes a polygon. Mass and centre of
    mass follow from the volume and the density. The object stands on its lowest corners.

    Args:
        file: drawing (.svg, .dxf) or mesh (.stl, .obj, .gltf, .glb).
        unit: unit of the file: mm, cm, m or in; None: that of the file, if it has one.
        scale: multiply all lengths by this factor; None: 1. It also confirms an unusual size.
        up: axis of the file that points upwards: x, y, z, -x, -y or -z; None: y of drawings and
            glTF, z of others.
        across: axis of a mesh across the direction of travel: x, y or z; None: y, or z if y points
            upwards.
        align: turn a mesh so that its sides are parallel to the axes, as those of a scan may not
            be.
        view: outline of a mesh: that of its section by a vertical plane, or its silhouette.
        cut: position of this plane within the depth of the mesh.
        tolerance_mm: greatest deviation of the outline; None: 0.5 % of its size, or what 32 corners
            need.
        depth_mm: extent across the direction of travel; None: that of the mesh, or 100 of a
            drawing.
        density_kg_m3: density of the body [kg/m³].
        mass_kg: mass; None: volume times density.
        com_mm: centre of mass from the left end and above the bottom of the outline; None: that of
            the volume.

    Raises:
        PalmbotsError: the file cannot be read or has no unit, its outline is no object, or an
            argument is out of range.
        MissingExtra: a package that reads the file is not installed.
    """
    path = user_path(file)
    suffix = path.suffix.lower()
    if suffix not in IMPORTED:
        raise PalmbotsError(f"{path}: is no drawing or mesh; allowed: {', '.join(IMPORTED)}")
    if unit is not None:
        one_of("unit", unit, tuple(UNITS))
    up = up or _MESHES.get(suffix, "y")
    one_of("up", up, _AXES if suffix in _MESHES else ("x", "y", "-x", "-y"))
    one_of("view", view, ("section", "silhouette"))
    scale, tolerance_mm = _above_0("scale", scale), _above_0("tolerance_mm", tolerance_mm)
    depth_mm, mass_kg = _above_0("depth_mm", depth_mm), _above_0("mass_kg", mass_kg)
    given = Given(path.name, unit, scale, None if depth_mm is None else depth_mm / 1000)
    if suffix in _DRAWINGS:
        if (across, align, view, cut) != (None, False, "section", 0.5):
            raise PalmbotsError(
                f"{path}: is a drawing; allowed without across, align, view and cut, which are for "
                "meshes"
            )
        drawing = _read(path, lambda data: _DRAWINGS[suffix](data))
        body = of_drawing(drawing, up, given)
    else:
        across = across or ("z" if up[-1] == "y" else "y")
        one_of("across", across, tuple(axis for axis in "xyz" if axis != up[-1]))
        mesh = _read(path, lambda data: read_mesh(path, data, up, across, align))
        metres = 1.0 if suffix in (".gltf", ".glb") else None
        if mesh.open_edges and (mass_kg is None or com_mm is None):
            edges = "1 edge does" if mesh.open_edges == 1 else f"{mesh.open_edges} edges do"
            raise PalmbotsError(
                f"{path}: the mesh is not closed ({edges} not join two triangles), so it has no "
                "volume; allowed: a repaired mesh, or --mass-kg and --com-mm"
            )
        body = of_mesh(mesh, metres, given, None if view == "silhouette" else cut)
    return _object(body, tolerance_mm, density_kg_m3, mass_kg, com_mm)


def _above_0(name: str, value: float | None) -> float | None:
    if value is not None and not 0 < value < 1e9:
        raise PalmbotsError(f"{name}: value is {show(value)}; allowed: a number above 0")
    return None if value is None else float(value)  # also of NumPy's single precision


def _read(path: Path, reader: Callable[[bytes], Any]) -> Any:
    """What a reader makes of a file.

    Raises:
        PalmbotsError: the file cannot be read, or is of another kind than its name says.
    """
    try:
        data = read_regular(path)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise PalmbotsError(f"{path}: cannot be read: {reason}") from None
    if not data.strip():
        raise PalmbotsError(f"{path}: the file is empty")
    try:
        return reader(data)
    except MissingExtra:
        raise
    except PalmbotsError as error:
        raise PalmbotsError(f"{path}: {error}") from None
    except Exception as error:  # of a library, on a file that is damaged
        # A reader may ask for a package that guesses the encoding of what is no text.
        internal = (
            TypeError | AttributeError | LookupError | AssertionError | ImportError | UnicodeError
        )
        is_internal = isinstance(error, internal)
        reason = "it is damaged" if is_internal or not str(error) else one_line(str(error))
        kind = path.suffix[1:].upper()
        raise PalmbotsError(f"{path}: cannot be read as {kind}: {reason}") from None


def _object(
    body: Body,
    tolerance_mm: float | None,
    density_kg_m3: float,
    mass_kg: float | None,
    com_mm: Interval | None,
) -> ImportedObject:
    """The object with the outline of a body, in the frame of `ImportedObject`."""
    area, centre = area_and_centroid(body.outline.points)
    volume = area * body.depth_m if body.volume_m3 is None else body.volume_m3
    centre = centre if body.centre_m is None else body.centre_m
    given = None if com_mm is None else np.array(two_numbers("com_mm", com_mm)) / 1000
    if given is not None:
        centre = body.outline.points.min(axis=0) + given
    points, centre, turn = settled(body.outline.points, centre)
    fitted, tolerance_m = _fitted(body.name, points, tolerance_mm)
    refuse_one_point(points, tolerance_m, body)
    corner = boundary(fitted.vertices, fitted.radii).min(axis=0)
    com = centre - corner if given is None else given
    remarks = body.remarks
    if abs(turn) > SEEN:
        way = "counter-clockwise" if turn > 0 else "clockwise"
        angle = abs(math.degrees(turn))
        remarks = (*remarks, f"It is turned {way} by {angle:.2g}° to stand on its lower side.")
    usual = _usual(points)
    if tolerance_mm is None and tolerance_m > usual:
        remarks = (
            *remarks,
            f"Within the usual tolerance of {millimetres(usual)} it would need more than "
            f"{most_records('object.vertices_m')} corners.",
        )
    radii = [float(radius) for radius in fitted.radii]
    contacts = _touched(fitted)
    table: dict[str, Any] = {
        "vertices_m": _pairs(fitted.vertices - corner),
        "edge_radius_m": radii[0] if len({*radii}) == 1 else radii,
        "com_m": _pairs([com])[0],
        "mass_kg": float(f"{volume * density_kg_m3 if mass_kg is None else mass_kg:.6g}"),
        "depth_m": round(body.depth_m, 6),
    }
    if contacts is not None:
        table["contacts"] = contacts
    try:
        made = Object.model_validate(table)
    except ValidationError as error:
        raise PalmbotsError(f"{body.name}: object.{validation_message(error, Object)}") from None
    whole = {"object": made.model_dump(exclude={"box_m"})}
    for key, value, problem, allowed in _core.check_scene(whole):
        shown = f"{show(value)} " if value else ""
        raise PalmbotsError(f"{body.name}: {key}: {shown}{problem}; allowed: {allowed}")
    palms = _palm_length_m(made)
    return ImportedObject(
        source=body.name,
        view=body.view,
        metres_per_unit=body.metres,
        vertices_m=made.vertices_m,
        edge_radius_m=made.edge_radius_m,
        contacts=made.contacts,
        com_m=made.com_m,
        mass_kg=made.mass_kg,
        depth_m=made.depth_m,
        tolerance_m=tolerance_m,
        deviation_m=fitted.deviation_m,
        palm_length_m=palms,
        carried=_carried(made, palms),
        remarks=remarks,
        outline_m=points - corner,
    )


def _usual(points: Points) -> float:
    """The greatest deviation by default [m]."""
    lesser, greater = sorted(np.ptp(points, axis=0))
    return float(min(_USUAL * greater, _USUAL_OF_LESSER * lesser))


def _fitted(name: str, points: Points, tolerance_mm: float | None) -> tuple[Fitted, float]:
    """The polygon, and the tolerance that it keeps to.

    Raises:
        PalmbotsError: the given tolerance needs more corners than an object may have.
    """
    most = most_records("object.vertices_m")
    size = float(np.ptp(points, axis=0).max())
    tolerance = _usual(points) if tolerance_mm is None else tolerance_mm / 1000
    if not 1e-6 <= tolerance <= _COARSEST * size:
        raise PalmbotsError(
            f"tolerance_mm: value is {tolerance_mm:g}; allowed: 0.001 to {100 * size:.3g}, a tenth "
            "of the size"
        )
    fitted = polygon_of(points, tolerance, most)
    needed = len(fitted.vertices)
    while len(fitted.vertices) > most:
        tolerance *= 1.25
        if tolerance > _COARSEST * size:
            raise PalmbotsError(
                f"{name}: needs {needed} corners within {millimetres(tolerance)}; allowed: at most "
                f"{most}"
            )
        fitted = polygon_of(points, tolerance, most)
    if tolerance_mm is not None and needed > most:
        raise PalmbotsError(
            f"tolerance_mm: value is {tolerance_mm:g}, which needs {needed} corners; allowed: what "
            f"needs at most {most}, such as {1000 * tolerance:.3g}"
        )
    return fitted, tolerance


def _pairs(points: Any) -> list[tuple[float, float]]:
    """Points in whole micrometres."""
    return [(round(float(x), 6) + 0.0, round(float(y), 6) + 0.0) for x, y in points]


def _touched(fitted: Fitted) -> tuple[int, int] | None:
    """The corners that both palms of the scene `paper` touch where they are steep, as at the start
    of a carry; None: it is the same one."""
    corners = rounded(fitted.vertices, fitted.radii)
    left, right = (
        int(
            np.argmin(
                [(points @ (-out * math.sin(tilt), math.cos(tilt))).min() for points in corners]
            )
        )
        for out, tilt in zip(
            (-1, 1), [one.steep for one in to_spec(load_scene("paper")).palms], strict=True
        )
    )
    return None if left == right else (left, right)


def _keys(made: Object, palms: float | None) -> dict[str, Any]:
    """What the scene paper changes to for this object."""
    changed = {} if palms is None else {"palm.length_m": palms}
    return {"object": made.model_dump(exclude={"box_m"})} | changed


def _palm_length_m(made: Object) -> float | None:
    """The length in whole millimetres of the longest palms that do not collide under the object
    [m]; None: those of the scene paper do not, or shorter ones are no remedy."""

    def collide(palms: float | None) -> bool:
        try:
            spec = to_spec(load_scene("paper", _keys(made, palms)))
        except PalmbotsError:
            return True
        return bool(_core.palm_refusal(spec))

    fitting, colliding = _SHORTEST_PALM_MM, round(1000 * load_scene("paper").palm.length_m)
    if not collide(None) or collide(fitting / 1000):
        return None
    while colliding - fitting > 1:
        middle = (fitting + colliding) // 2
        fitting, colliding = (fitting, middle) if collide(middle / 1000) else (middle, colliding)
    return fitting / 1000


def _carried(made: Object, palms: float | None) -> str:
    """How a carry of the object in the scene paper ends, on palms of its length or of this one."""
    try:
        found = carry("paper", overrides=_keys(made, palms))
    except PalmbotsError as error:
        return f"refused: {error}"
    return found.outcome if found.outcome == "delivered" else f"{found.outcome} ({found.reason})"

# SPDX-License-Identifier: Apache-2.0
"""An object made from a file: what people read of it, and its TOML file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from palmbots._util.atomic_files import check_file, write_whole
from palmbots._util.command import Option, writes
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.report import Item, Line, Table
from palmbots._util.results import Result
from palmbots._util.text import millimetres
from palmbots._util.toml_writer import toml_text
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.scene.command_text import command_text
from palmbots.scene.object_frame import Point
from palmbots.scene.object_section import Object
from palmbots.shapes.point_arrays import Points
from palmbots.shapes.rounded_outline import boundary


@dataclass(frozen=True, repr=False)
class ImportedObject(Result):
    """An object of a scene, made from a drawing or a mesh. Its frame begins at the left end of the
    object, at the height of its lowest points."""

    figure = "imported-object"

    source: str
    """Name of the file."""
    view: str
    """What was taken: the ``drawing``, a ``section`` or the ``silhouette`` of a mesh."""
    metres_per_unit: float
    """Length of the unit of the file, `scale` included."""
    vertices_m: tuple[Point, ...]
    edge_radius_m: float | tuple[float, ...]
    """Radius of the rounded corners: one for all, or one for each vertex."""
    contacts: tuple[int, int]
    com_m: Point
    mass_kg: float
    depth_m: float
    tolerance_m: float
    """Greatest deviation that was allowed."""
    deviation_m: float
    """Greatest distance between the outline of the file and that of the object."""
    palm_length_m: float | None
    """Length of the longest palms that do not collide under the object. None: those of the scene
    `paper` do not."""
    carried: str
    """How the scene `paper` with this object, and palms of this length, ends: an outcome, or why it
    is refused."""
    remarks: tuple[str, ...]
    """What was ignored or assumed."""
    outline_m: Points = field(metadata=NOT_IN_JSON)
    """The outline of the file, in the frame of `vertices_m`."""

    @property
    def radii_m(self) -> tuple[float, ...]:
        """The radius of each corner [m]."""
        given = self.edge_radius_m
        return given if isinstance(given, tuple) else (given,) * len(self.vertices_m)

    @property
    def object(self) -> Object:
        """The section `object` of a scene."""
        return Object.model_validate(
            {
                "vertices_m": self.vertices_m,
                "edge_radius_m": self.edge_radius_m,
                "contacts": self.contacts,
                "com_m": self.com_m,
                "mass_kg": self.mass_kg,
                "depth_m": self.depth_m,
            }
        )

    @property
    def _palms(self) -> str:
        """Which palms have room, if those of the scene do not."""
        given = self.palm_length_m
        return "" if given is None else f", with palms of {millimetres(given)}, which have room"

    def toml(self) -> str:
        """The text of an object file."""
        head = [
            f"Made from {self.source} ({self.view}).",
            f"Its outline deviates by {millimetres(self.deviation_m)} at most.",
        ]
        comment = "".join(f"# {line}\n" for line in [*head, *self.remarks])
        return f"{comment}\n{toml_text({'object': self.object.model_dump(exclude={'box_m'})})}"

    def lines(self) -> Iterator[Item]:
        """Size and mass, how exact the outline is, and how the object is carried."""
        outline = boundary(np.array(self.vertices_m), np.array(self.radii_m))
        size = [*map(float, np.ptp(outline, axis=0)), self.depth_m]
        yield (
            f"imported  {' × '.join(map(millimetres, size))} (length, height, depth), "
            f"{self.mass_kg:.4g} kg"
        )
        (left, _), (right, _) = (self.vertices_m[k] for k in self.contacts)
        x, y = map(millimetres, self.com_m)
        corners = f"{len(self.vertices_m)}"
        radii = self.radii_m
        if any(radii):
            rounded = sorted(radius for radius in radii if radius > 0)
            ends = dict.fromkeys(map(millimetres, (rounded[0], rounded[-1])))
            corners += f", {len(rounded)} rounded with a radius of {' to '.join(ends)}"
        yield Table(
            [
                ("  corners", corners),
                (
                    "  greatest deviation",
                    f"{millimetres(self.deviation_m)}; tolerance {millimetres(self.tolerance_m)}",
                ),
                ("  contacts", f"{millimetres(right - left)} apart"),
                ("  centre of mass", f"{x} from the left end, {y} above the bottom"),
                ("  in the scene paper", self.carried + self._palms),
            ]
        )
        for remark in self.remarks:
            yield Line(remark, indent=2)


@writes("import", path=Option("--out -o", metavar="FILE.toml"))
def write_object(result: ImportedObject, path: str | os.PathLike[str]) -> list[Path | Item]:
    """Write an object file, and beside it a picture of the outline and the corners.

    Args:
        result: the object.
        path: write the object to this TOML file, and a picture beside it.

    Raises:
        PalmbotsError: the name does not end in .toml, or a file cannot be written.
    """
    file = user_path(path)
    if file.suffix != ".toml":
        raise PalmbotsError(f"--out: value is {file}; allowed: a name that ends in .toml")
    picture = file.with_suffix(".png")
    check_file(picture)
    write_whole(file, result.toml())
    result.save_figure(picture)
    keys: dict[str, Any] = {"object": str(path)}
    if result.palm_length_m is not None:
        keys["palm.length_m"] = result.palm_length_m
    if result.carried.startswith("refused"):
        return [file, picture]
    return [file, picture, Line(f"carry it: {command_text('carry', 'paper', keys)}", is_whole=True)]

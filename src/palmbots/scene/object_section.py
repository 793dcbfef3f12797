# SPDX-License-Identifier: Apache-2.0
"""The section `object` of a scene: what is carried.

The defaults are the paper's box. An outline of the user's own brings its own defaults: contacts,
centre of mass and mass follow from it, never from the paper's box.
"""

import math
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, TypeAdapter, ValidationError, model_validator

from palmbots.scene.fields import Index, Mass, Place, Size, field_error, from_list
from palmbots.scene.polygon import Point, area_and_centroid, bottom_ends, crossing_edges
from palmbots.scene.section import Section
from palmbots.scene.support_check import check_support

DEFAULT_DENSITY = 125.0
"""Density of the paper's box, 0.5 kg in 25 × 16 × 10 cm [kg/m³]."""

LEVEL_M = 1e-9  # vertices at most this far above the lowest one are at its height
_COM_DIGITS = 12  # of a metre: hides rounding, so that the COM of a 0.6 m box is 0.3
_MASS_DIGITS = 12

Coordinates = Annotated[
    tuple[Place, Place], BeforeValidator(from_list("[x, y], two numbers in m", 2, 2))
]
Vertices = Annotated[
    tuple[Coordinates, ...], BeforeValidator(from_list("a list of 3 to 32 points [x, y]", 3, 32))
]
Contacts = Annotated[
    tuple[Index, Index],
    BeforeValidator(from_list("[left, right], two indices into object.vertices_m", 2, 2)),
]

_VERTICES: TypeAdapter[tuple[Point, ...]] = TypeAdapter(Vertices)
_SIZE: TypeAdapter[float] = TypeAdapter(Size)


class Object(Section):
    """[object] An extruded polygon seen from the side, in any frame and turned in any way."""

    vertices_m: Vertices = ((0.0, 0.0), (0.25, 0.0), (0.25, 0.16), (0.0, 0.16))
    """The outline: a simple polygon, clockwise or counter-clockwise. If it is given, the three keys
    below follow from it unless they are given, too."""
    contacts: Contacts = (0, 1)
    """The vertices that rest on the left and on the right palm. Not set, with an outline of your
    own: the leftmost and the rightmost of its lowest vertices, which must be level."""
    com_m: Coordinates = (0.125, 0.04)
    """Centre of mass, in the frame of the vertices, inside the convex hull of the outline. Not set,
    with an outline of your own: its centroid."""
    mass_kg: Mass = 0.5
    """Mass; matters in the MuJoCo world only. Not set, with an outline of your own: volume times
    the density of the paper's box, 125 kg/m³."""
    depth_m: Size = 0.1
    """Length of the extrusion, across the direction of travel."""

    @property
    def width_m(self) -> float:
        """Distance between the two contact vertices, about that between the robots' pivots."""
        (lx, ly), (rx, ry) = (self.vertices_m[k] for k in self.contacts)
        return math.hypot(rx - lx, ry - ly)

    @property
    def rest_angle_deg(self) -> float:
        """Angle by which the outline is turned, counter-clockwise, when both contacts are level.

        From -180 to 180; 0 where the right contact is level with the left one in `vertices_m`.
        """
        (lx, ly), (rx, ry) = (self.vertices_m[k] for k in self.contacts)
        return math.degrees(math.atan2(ly - ry, rx - lx)) + 0.0

    @property
    def is_upside_down(self) -> bool:
        """Whether the outline is turned by more than a right angle: contacts are upper vertices."""
        return abs(self.rest_angle_deg) > 90

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, data: Any) -> Any:
        """Contacts, centre of mass and mass of an outline that is given without them."""
        if not isinstance(data, dict) or "vertices_m" not in data:
            return data
        try:
            vertices = _VERTICES.validate_python(data["vertices_m"])
        except ValidationError:
            return data  # the field reports what is wrong with it
        if crossing_edges(vertices) is not None:
            return data  # `_check` reports it
        area, centroid = area_and_centroid(vertices)
        filled = dict(data)
        if "contacts" not in data:
            filled["contacts"] = _bottom_contacts(vertices)
        if "com_m" not in data:
            com = round(centroid[0], _COM_DIGITS), round(centroid[1], _COM_DIGITS)
            _check_centroid(vertices, filled["contacts"], com)
            filled["com_m"] = com
        if "mass_kg" not in data:
            filled["mass_kg"] = _mass(
                area, data.get("depth_m", cls.model_fields["depth_m"].default)
            )
        return filled

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_support(self.vertices_m, self.contacts, self.com_m)
        return self


def _bottom_contacts(vertices: tuple[Point, ...]) -> tuple[int, int]:
    ends = bottom_ends(vertices, LEVEL_M)
    if ends is None:
        lowest = min(range(len(vertices)), key=lambda k: vertices[k][1])
        raise field_error(
            None,
            f"is not set, and the outline has no level lower side: vertex {lowest} alone is lowest",
            "[left, right], two indices into object.vertices_m",
            "contacts",
        )
    return ends


def _check_centroid(vertices: tuple[Point, ...], contacts: object, com: Point) -> None:
    """Raise the fault of a centroid that cannot be carried, without blaming a key that is set."""
    try:
        pair = TypeAdapter(Contacts).validate_python(contacts)
    except ValidationError:
        return  # the field reports what is wrong with it
    check_support(vertices, pair, com, is_centroid=True)


def _mass(area: float, depth: object) -> float | None:
    """The mass of an outline at the default density."""
    try:
        mass = round(DEFAULT_DENSITY * area * _SIZE.validate_python(depth), _MASS_DIGITS)
    except ValidationError:
        return Object.model_fields["mass_kg"].default  # the field reports what is wrong with it
    if not 0.001 <= mass <= 1000:
        raise field_error(
            None,
            f"is not set, and the outline at {DEFAULT_DENSITY:g} kg/m³ has {mass:g} kg",
            "a number in kg, from 0.001 to 1000",
            "mass_kg",
        )
    return mass

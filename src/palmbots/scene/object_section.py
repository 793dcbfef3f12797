# SPDX-License-Identifier: Apache-2.0
"""The section `object` of a scene: what is carried.

The defaults are the paper's box. An outline of the user's own brings its own defaults: contacts,
centre of mass and mass follow from it, never from the paper's box.
"""

import math
from typing import Annotated, Any, cast

from pydantic import BeforeValidator, TypeAdapter, ValidationError, model_validator

import palmbots._core as _core
from palmbots.scene.core_keys import default_pair, default_points, key, limits, most_records
from palmbots.scene.fields import OneOrList, Range, field_error, from_list
from palmbots.scene.section import Section

_TWO_NUMBERS = BeforeValidator(from_list("[x, y], two numbers in m", 2, 2))
_MOST_VERTICES = most_records("object.vertices_m")
Place = Annotated[float, limits("object.vertices_m[][0]")]
Index = Annotated[int, limits("object.contacts[0]")]
Coordinates = Annotated[tuple[Place, Place], _TWO_NUMBERS]
Vertices = Annotated[
    tuple[Coordinates, ...],
    BeforeValidator(from_list(f"a list of 3 to {_MOST_VERTICES} points [x, y]", 3, _MOST_VERTICES)),
]
Length = Annotated[float, limits("object.box_m[0]")]
Height = Annotated[float, limits("object.box_m[1]")]
Box = Annotated[
    tuple[Length, Height], BeforeValidator(from_list("[length, height], two numbers in m", 2, 2))
]
Contacts = Annotated[
    tuple[Index, Index],
    BeforeValidator(from_list("[left, right], two indices into object.vertices_m", 2, 2)),
]

_RADIUS = limits("object.edge_radius_m[]")
_RADII = from_list("a number in m, or a list of one for each vertex", 1, _MOST_VERTICES)
Radius = Annotated[float, _RADIUS]
EdgeRadii = Annotated[
    Radius | Annotated[tuple[Radius, ...], BeforeValidator(_RADII)],
    BeforeValidator(OneOrList(cast(Range, _RADIUS.func), _RADII)),
]

_OUTLINES: dict[str, TypeAdapter[Any]] = {
    "vertices_m": TypeAdapter(Vertices),
    "box_m": TypeAdapter(Box),
}


class Object(Section):
    """[object] An extruded polygon seen from the side, in any frame and turned in any way."""

    vertices_m: Vertices = default_points("object.vertices_m")
    """The outline: a simple polygon, clockwise or counter-clockwise, which closes itself. If it is
    given, contacts, centre of mass and mass follow from it unless they are given, too."""
    box_m: Box | None = None
    """In place of `vertices_m`: length and height of a box."""
    edge_radius_m: EdgeRadii = 0.0
    """Radius of the rounded corners of the outline, one for all convex corners or a list of one for
    each vertex. The vertices are where the straight edges would meet. A contact vertex that is
    rounded rolls on its palm."""
    contacts: Contacts = default_pair("object.contacts")
    """The vertices that rest on the left and on the right palm. Not set, with an outline of your
    own: the leftmost and the rightmost of its lowest vertices, which must be level."""
    com_m: Coordinates = default_pair("object.com_m")
    """Centre of mass, in the frame of the vertices, inside the convex hull of the outline. Not set,
    with an outline of your own: its centroid."""
    mass_kg: float = key("object.mass_kg")
    """Mass: what the robots have to hold (palmbots load). The quasistatic world needs no mass. Not
    set, with an outline of your own: volume times the density of the paper's box, 125 kg/m³."""
    depth_m: float = key("object.depth_m")
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

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, data: Any) -> Any:
        """The outline of a box; contacts, centre of mass and mass of an outline without them."""
        if not isinstance(data, dict):
            return data
        given = [name for name in _OUTLINES if data.get(name) is not None]
        try:
            outline = {name: _OUTLINES[name].validate_python(data[name]) for name in given}
        except ValidationError:
            return data  # the field reports what is wrong with it
        if not outline:
            return data
        whole = {"object": data | outline}
        for blamed, value, problem, allowed in _core.check_scene(whole):
            section, _, name = blamed.partition(".")
            if section == "object" and (name not in data or name == "box_m"):
                raise field_error(value or None, problem, allowed, name)
        others = {name: value for name, value in data.items() if name not in _OUTLINES}
        return _core.complete_object(whole) | others

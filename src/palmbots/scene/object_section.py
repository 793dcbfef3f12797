# SPDX-License-Identifier: Apache-2.0
"""The section `object` of a scene: what is carried.

The defaults are the paper's box. An outline of the user's own brings its own defaults: contacts,
centre of mass and mass follow from it, never from the paper's box.
"""

import math
from typing import Annotated, Any

from pydantic import BeforeValidator, TypeAdapter, ValidationError, model_validator

import palmbots._core as _core
from palmbots.scene.core_keys import default_pair, default_points, key, limits, most_records
from palmbots.scene.fields import field_error, from_list
from palmbots.scene.object_frame import Point
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
Contacts = Annotated[
    tuple[Index, Index],
    BeforeValidator(from_list("[left, right], two indices into object.vertices_m", 2, 2)),
]

_VERTICES: TypeAdapter[tuple[Point, ...]] = TypeAdapter(Vertices)


class Object(Section):
    """[object] An extruded polygon seen from the side, in any frame and turned in any way."""

    vertices_m: Vertices = default_points("object.vertices_m")
    """The outline: a simple polygon, clockwise or counter-clockwise. If it is given, the three keys
    below follow from it unless they are given, too."""
    contacts: Contacts = default_pair("object.contacts")
    """The vertices that rest on the left and on the right palm. Not set, with an outline of your
    own: the leftmost and the rightmost of its lowest vertices, which must be level."""
    com_m: Coordinates = default_pair("object.com_m")
    """Centre of mass, in the frame of the vertices, inside the convex hull of the outline. Not set,
    with an outline of your own: its centroid."""
    mass_kg: float = key("object.mass_kg")
    """Mass; matters in the MuJoCo world only. Not set, with an outline of your own: volume times
    the density of the paper's box, 125 kg/m³."""
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
        given = {"object": {**data, "vertices_m": vertices}}
        for blamed, value, problem, allowed in _core.check_scene(given):
            section, _, name = blamed.partition(".")
            if section == "object" and name not in data:
                raise field_error(value or None, problem, allowed, name)
        return _core.complete_object(given) | data

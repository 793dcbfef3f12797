# SPDX-License-Identifier: Apache-2.0
"""The section `task.route` of a scene: where robots carry an object that they may put down on the
way.

Frame: seen from above, metres. The stages in which a pair follows a route are planned in
`palmbots.mujoco.route_planner`.
"""

from typing import Annotated, Any, Self

from pydantic import BeforeValidator, model_validator

from palmbots.scene.fields import Range, field_error, from_list
from palmbots.scene.path_section import Points, Spot, refuse_near_points
from palmbots.scene.section import Section

_MOST_WALLS = 1_000
_END = "[x1, y1, x2, y2], the ends of a wall in m"

Ends = Annotated[tuple[Spot, Spot, Spot, Spot], BeforeValidator(from_list(_END, 4, 4))]
Walls = Annotated[
    tuple[Ends, ...],
    BeforeValidator(from_list(f"a list of at most {_MOST_WALLS} walls {_END}", 0, _MOST_WALLS)),
]
Radius = Annotated[float, BeforeValidator(Range("m", least=0.01, most=10_000))]


class Route(Section):
    """[task.route] Way points between which the object is carried, in as many jobs as it takes."""

    waypoints_m: Points | None = None
    """Points on the floor, in any frame. The object stands at the first one, and the first line is
    its axis; it is put down at the last one. Not set: there is no route."""
    radius_m: Radius | None = None
    """Radius with which the corners are rounded. Not set: 1."""
    walls_m: Walls | None = None
    """Walls in the same frame: a list of [x1, y1, x2, y2], the ends of each wall. A route on which
    the pair would touch one is refused. Walls have no other effect."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.waypoints_m is not None:
            refuse_near_points(self.waypoints_m)
            return self
        for key in ("radius_m", "walls_m"):
            if (given := getattr(self, key)) is not None:
                shown = [list(wall) for wall in given] if key == "walls_m" else given
                raise field_error(shown, "is given without waypoints_m", "waypoints_m", key)
        return self

    @property
    def is_set(self) -> bool:
        """Whether there is a route."""
        return self.waypoints_m is not None

    def mirrored(self) -> "Route":
        """The mirror image: left turns become right turns."""
        table: dict[str, Any] = self.model_dump()
        if self.waypoints_m is not None:
            table["waypoints_m"] = tuple((x, 0.0 - y) for x, y in self.waypoints_m)
        if self.walls_m is not None:
            table["walls_m"] = tuple((a, 0.0 - b, c, 0.0 - d) for a, b, c, d in self.walls_m)
        return Route.model_validate(table)

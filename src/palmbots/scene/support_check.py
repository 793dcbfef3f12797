# SPDX-License-Identifier: Apache-2.0
"""The check that an object can rest on its two contact vertices.

The outline must be a simple polygon. With both contact vertices level, each must be a corner of the
lower side of the convex hull, so that it can touch a floor. The centre of mass must lie inside the
convex hull (the centroid of an L or a U lies outside its outline), above the line between the
contacts and between them.
"""

from palmbots._types import SIDES
from palmbots.scene.fields import field_error
from palmbots.scene.object_frame import object_frame
from palmbots.scene.polygon import (
    Point,
    crossing_edges,
    hull,
    lower_vertices,
    place_of_point,
)

LEAST_WIDTH_M = 0.001


def check_support(
    vertices: tuple[Point, ...],
    contacts: tuple[int, int],
    com: Point,
    *,
    is_centroid: bool = False,
) -> None:
    """Raise the first fault of an object; the keys are those of the scene's section `object`.

    With `is_centroid` the message says that the centre of mass was not given.
    """
    count = len(vertices)
    bad = crossing_edges(vertices)
    if bad is not None:
        one, two = (f"the edge from vertex {k} to {(k + 1) % count}" for k in bad)
        problem = f"crosses itself: {one} meets {two}"
        if one == two:
            problem = f"repeats vertex {bad[0]} as the next one"
        raise field_error(
            [list(point) for point in vertices],
            problem,
            "a simple polygon, whose edges share nothing but the vertices between them",
            "vertices_m",
        )

    for k in contacts:
        if k >= count:
            raise field_error(
                list(contacts),
                f"names vertex {k}, but there are {count}",
                f"two different whole numbers from 0 to {count - 1}",
                "contacts",
            )
    (lx, ly), (rx, ry) = (vertices[k] for k in contacts)
    if (rx - lx) * (rx - lx) + (ry - ly) * (ry - ly) < LEAST_WIDTH_M * LEAST_WIDTH_M:
        raise field_error(
            list(contacts),
            "names contacts at the same place",
            f"two vertices at least {LEAST_WIDTH_M:g} m apart",
            "contacts",
        )
    lower = lower_vertices(vertices, *contacts)
    for side, k in zip(SIDES, contacts, strict=True):
        if k not in lower:
            raise field_error(
                list(contacts),
                f"cannot support the object: with both level and the left one on the left, "
                f"vertex {k} ({side}) is not a corner of its lower side",
                "[left, right], two lower corners of the outline's convex hull",
                "contacts",
            )

    if place_of_point(com, [vertices[k] for k in hull(vertices)]) < 0:
        raise field_error(
            list(com),
            "is outside the convex hull of the outline",
            "a point inside it",
            "com_m",
        )
    centre = object_frame(vertices, contacts, com).com
    if not (centre.from_left > 0 and centre.from_right > 0 and centre.height > 0):
        raise field_error(
            list(com),
            ("is the centroid of the outline, which " if is_centroid else "")
            + "is not above the line between the contact vertices",
            "a point above that line and between its ends",
            "com_m",
        )

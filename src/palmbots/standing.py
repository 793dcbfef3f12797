"""Can an object of this outline stand on these two vertices?

It can when the outline is a simple polygon, each contact vertex could touch a floor below it when
the two are level (a corner of the lower side of the convex hull), and the centre of mass lies in
the outline, above the line between the contacts and between them.
"""

from palmbots.frame import object_frame
from palmbots.outline import Point, crossing_edges, lower_vertices, place_of_point
from palmbots.quantities import fault

__all__ = ["check_standing"]

_LEAST_WIDTH_M = 0.001


def check_standing(vertices: tuple[Point, ...], contacts: tuple[int, int], com: Point) -> None:
    """Raise the first fault of an object; the keys are those of the scene's section `object`."""
    count = len(vertices)
    bad = crossing_edges(vertices)
    if bad is not None:
        one, two = (f"the edge from vertex {k} to {(k + 1) % count}" for k in bad)
        problem = f"crosses itself: {one} meets {two}"
        if one == two:
            problem = f"repeats vertex {bad[0]} as the next one"
        raise fault(
            [list(point) for point in vertices],
            problem,
            "a simple polygon, whose edges share nothing but the vertices between them",
            "vertices_m",
        )

    for k in contacts:
        if k >= count:
            raise fault(
                list(contacts),
                f"names vertex {k}, but there are {count}",
                f"two different whole numbers from 0 to {count - 1}",
                "contacts",
            )
    (lx, ly), (rx, ry) = (vertices[k] for k in contacts)
    if (rx - lx) * (rx - lx) + (ry - ly) * (ry - ly) < _LEAST_WIDTH_M * _LEAST_WIDTH_M:
        raise fault(
            list(contacts),
            "names contacts that are not apart",
            f"two vertices at least {_LEAST_WIDTH_M:g} m from each other",
            "contacts",
        )
    lower = lower_vertices(vertices, *contacts)
    for side, k in zip(("left", "right"), contacts, strict=True):
        if k not in lower:
            raise fault(
                list(contacts),
                f"cannot carry the object: with the left one on the left and both level, "
                f"vertex {k} ({side}) is no corner of its lower side",
                "[left, right], two lower corners of the outline's convex hull",
                "contacts",
            )

    if place_of_point(com, vertices) < 0:
        raise fault(list(com), "is outside the outline", "a point of the object", "com_m")
    centre = object_frame(vertices, contacts, com).com
    if not (centre.from_left > 0 and centre.from_right > 0 and centre.height > 0):
        raise fault(
            list(com),
            "is not above the line between the contact vertices",
            "a point above that line and between its ends",
            "com_m",
        )

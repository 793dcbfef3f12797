# SPDX-License-Identifier: Apache-2.0
"""The box of a scene with intervals of uncertainty, checked against what a scene allows."""

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np

from palmbots._core import crossing_edges
from palmbots._types import SIDES
from palmbots._util.arguments import ordered_pair, show
from palmbots.errors import PalmbotsError
from palmbots.scene.object_frame import Corner, object_frame
from palmbots.scene.palm_section import PalmParameters
from palmbots.scene.scene import Scene
from palmbots.scene.spec import contact_radii, to_spec
from palmbots.stability.certificates.parameter_box import Ends, ParameterBox, exact

_SLOPE_DIGITS = 12
_STEEPEST_DEG = 45.0
_MOST_M = 10.0

_ROUNDING = 10**9
"""The outline is rounded to this part of the width, since the frame contains a square root."""


def slope_interval(scene: Scene, slope_deg: Any) -> Ends:
    """The box's slopes s of an interval of degrees, rounded outward.

    The interval is seen in the direction of travel, as ``task.slope_deg`` of a scene.

    Raises:
        PalmbotsError: the interval is out of range.
    """
    low, high = _ends("slope_deg", slope_deg, None, -_STEEPEST_DEG, _STEEPEST_DEG)
    if scene.task.direction == "backward":
        low, high = -high, -low
    return _tangent(low, math.floor, -1), _tangent(high, math.ceil, 1)


def _tangent(degrees: Fraction, rounded: Any, sign: int) -> Fraction:
    """The tangent, rounded to one side; exact at 0."""
    if degrees == 0:
        return Fraction(0)
    scale = 10**_SLOPE_DIGITS
    # The error of the floating-point tangent is far below a tenth of the last digit.
    return Fraction(rounded(math.tan(math.radians(degrees)) * scale + 0.1 * sign), scale)


def _ends(name: str, interval: Any, default: Any, least: float, most: float) -> Ends:
    """The ends of an interval; None stands for the default alone."""
    if interval is None:
        return exact(default), exact(default)
    low, high = ordered_pair(name, interval, least, most)
    return exact(low), exact(high)


def _distance(name: str, value: Any) -> Fraction:
    is_number = isinstance(value, (int, float, np.number)) and not isinstance(value, bool)
    if not (is_number and 0 <= value <= _MOST_M):
        raise PalmbotsError(f"{name}: value is {show(value)}; allowed: 0 to {_MOST_M:g}")
    return exact(value)


def box_of(
    scene: Scene,
    *,
    com_x_m: Any = None,
    com_y_m: Any = None,
    com_polygon_m: Any = None,
    friction: Any = None,
    friction_right: Any = None,
    common_friction: bool = False,
    shallow_deg: Any = None,
    steep_deg: Any = None,
    width_m: Any = None,
    length_m: Any = None,
    offset_m: Any = None,
    slope_deg: Any = None,
    slope: Any = None,
    region_m: Any = None,
    beyond_m: Any = 0.0,
) -> ParameterBox:
    """A scene with intervals of uncertainty; quantities without an interval are as in the scene.

    Args:
        scene: the scene.
        com_x_m: COM along the line of contacts, from the left contact.
        com_y_m: COM above the line of contacts.
        com_polygon_m: corners of a polygon of COMs, instead of both.
        friction: coefficients of both palms.
        friction_right: coefficients of the right palm, where they differ.
        common_friction: whether both palms have the same coefficient, anywhere in the interval.
        shallow_deg: shallow angle of both palms.
        steep_deg: steep angle of both palms.
        width_m: distance of the contact vertices; contains the scene's.
        length_m: length of both palms.
        offset_m: pivot offset of both palms.
        slope_deg: slope of the floor, uphill in the direction of travel > 0.
        slope: the same as an interval of s, the specific force towards −x.
        region_m: contact coordinates on either palm.
        beyond_m: how far a correction continues past p = 0.

    Raises:
        PalmbotsError: an interval is out of range.
    """
    body = scene.object
    frame = object_frame(body.vertices_m, body.contacts, body.com_m)
    radii = contact_radii(to_spec(scene, unrolled=True))
    palms = tuple(scene.palm_of(side) for side in SIDES)
    width = _ends("width_m", width_m, frame.width, 0.001, 10)
    rounding = exact(frame.width) / _ROUNDING
    if not width[0] - rounding <= exact(frame.width) <= width[1] + rounding:
        raise PalmbotsError(
            f"width_m: value is {show(list(width_m))}; allowed: an interval that contains the "
            f"width of the scene's outline, {frame.width:g}"
        )
    shallow = _angles("shallow_deg", shallow_deg, palms)
    steep = _angles("steep_deg", steep_deg, palms)
    for low, high in zip(shallow, steep, strict=True):
        if not low[1] < high[0]:
            raise PalmbotsError(
                f"shallow_deg: value is {show([float(low[0]), float(low[1])])}; allowed: an "
                f"interval below steep_deg, {float(high[0]):g}"
            )
    halves, contacts = _palm_regions(palms, length_m, region_m)
    offset = tuple(_ends("offset_m", offset_m, palm.pivot_offset_m, -1, 1) for palm in palms)
    if slope_deg is not None:
        slopes = slope_interval(scene, slope_deg)
    elif slope is not None:
        slopes = exact(slope[0]), exact(slope[1])
    else:
        own = exact(to_spec(scene).slope if scene.task.slope_deg else 0.0)
        slopes = own, own
    box = ParameterBox(
        com=_coms(frame.com, com_x_m, com_y_m, com_polygon_m),
        width=width,
        friction=_frictions(palms, friction, friction_right, common_friction),
        common=common_friction,
        shallow_deg=shallow,
        steep_deg=steep,
        contacts=contacts,
        beyond=_distance("beyond_m", beyond_m),
        half_length=halves,
        offset=(offset[0], offset[1]),
        slope=slopes,
        outline=tuple(
            (exact(c.from_left), exact(c.from_right), exact(c.height)) for c in frame.outline
        ),
        right_contact=frame.contact_right,
        radius=(exact(radii[0]), exact(radii[1])),
    )
    _refuse_crossing(box)
    return box


def _refuse_crossing(box: ParameterBox) -> None:
    """Refuse a width at which the outline, whose contact vertex moves, crosses itself."""
    for side, w in product((0, 1), box.width):
        if crossing_edges([(float(x), float(y)) for x, y in box.seen(side, w)]) is not None:
            raise PalmbotsError(
                f"width_m: value is {show([float(end) for end in box.width])}; allowed: widths at "
                f"which the outline does not cross itself, unlike at {float(w):g}"
            )


def _coms(com: Corner, x_m: Any, y_m: Any, polygon_m: Any) -> tuple[tuple[Fraction, Fraction], ...]:
    """The corners of the polygon of COMs."""
    if polygon_m is None:
        xs = _ends("com_x_m", x_m, com.from_left, -10, 10)
        ys = _ends("com_y_m", y_m, com.height, -10, 10)
        return tuple(dict.fromkeys((x, y) for x in xs for y in ys))
    if x_m is not None or y_m is not None or len(polygon_m) < 1:
        raise PalmbotsError(
            "com_polygon_m: allowed: one point [x, y] or more, and neither com_x_m nor com_y_m"
        )
    return tuple((exact(x), exact(y)) for x, y in polygon_m)


def _frictions(
    palms: Sequence[PalmParameters], both: Any, right: Any, common: bool
) -> tuple[Ends, Ends]:
    frictions = (
        _ends("friction", both, palms[0].friction, 0, 100),
        _ends("friction_right", both if right is None else right, palms[1].friction, 0, 100),
    )
    if common and frictions[0] != frictions[1]:
        raise PalmbotsError(
            "common_friction: the palms have different intervals of friction; allowed: the same "
            "interval for both, or independent friction"
        )
    return frictions


def _angles(name: str, interval: Any, palms: Sequence[PalmParameters]) -> tuple[Ends, Ends]:
    left, right = (_ends(name, interval, getattr(palm, name), -79, 79) for palm in palms)
    return left, right


def _palm_regions(
    palms: Sequence[PalmParameters], length_m: Any, region_m: Any
) -> tuple[tuple[Ends, Ends], tuple[Ends, Ends]]:
    """Half-lengths and contact coordinates of both palms."""
    halves: list[Ends] = []
    regions: list[Ends] = []
    for palm in palms:
        shortest, longest = _ends("length_m", length_m, palm.length_m, 0.001, 10)
        halves.append((shortest / 2, longest / 2))
        usable = longest
        if palm.usable_m is not None:
            usable = min(longest, exact(palm.usable_m))
        low, high = -usable / 2, usable / 2
        if region_m is not None:
            low, high = _ends("region_m", region_m, None, float(low), float(high))
            if not low <= 0 <= high:
                raise PalmbotsError(
                    f"region_m: value is {show(list(region_m))}; allowed: an interval around 0"
                )
        regions.append((low, high))
    return (halves[0], halves[1]), (regions[0], regions[1])

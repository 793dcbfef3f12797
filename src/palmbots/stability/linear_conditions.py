# SPDX-License-Identifier: Apache-2.0
"""The conditions of a property on the object's angle: linear forms in (dx, dy).

(dx, dy) is the vector from the left contact to the right one. At given palm angles, frictions, COM
and slope every condition of a property is P dx + Q dy ≥ 0. It bounds tan ϑ = dy / dx on one side,
at k = w tan ϑ / √(1 + tan² ϑ) in the paper's z (k_B and k_D of equations 6 to 8). The formulas use
only + − ×, so each form is a polynomial of degree at most two in friction, COM or slope, and a
condition begins or ceases to hold at its roots. An array in place of a number gives the forms at
several values. Source: docs/theory/mechanics.md and stability.md.
"""

import math
from dataclasses import dataclass
from typing import Any

from palmbots._types import SIDES, Side

UP, DOWN = 1, -1

NEEDS: dict[int, tuple[tuple[int, int, bool], ...]] = {
    #   shallow  steep  whether the shallow contact slips first
    0: ((UP, DOWN, False), (DOWN, UP, True)),
    1: ((UP, UP, True), (UP, DOWN, False)),
    2: ((DOWN, DOWN, True), (UP, DOWN, False)),
}
"""The comparisons of squeezes that a property needs, by property number."""

SLIDING_EDGES = {1: ("shallow", UP), 2: ("steep", DOWN)}
"""The edge that slides, and therefore must not be wedged, by property number."""

_TEXTS = {
    (0, "first"): "the shallow palm cannot hold against the steep one: its contact slides up, and "
    "the other one down",
    (0, "second"): "the steep palm cannot hold against the shallow one: its contact slides up, and "
    "the other one down",
    (1, "first"): "on closing, the steep palm's contact would slide up first",
    (1, "second"): "on closing, the steep palm's contact would slide down",
    (2, "first"): "on opening, the shallow palm's contact would slide down first",
    (2, "second"): "on opening, the shallow palm's contact would slide up",
    (1, "wedged"): "the shallow palm's contact is wedged and never slides up",
    (2, "wedged"): "the steep palm's contact is wedged and never slides down",
}


def text_of(number: int, name: str) -> str:
    """What happens where a condition of a property fails, in words."""
    if name.startswith("lift"):
        return f"the object tips: nothing presses on the {name.removeprefix('lift_')} palm"
    return _TEXTS.get((number, name), "")


@dataclass(frozen=True)
class Form:
    """P dx + Q dy ≥ 0; the condition is void where one of the forms `void` is negative."""

    name: str
    p: Any
    q: Any
    void: tuple[tuple[Any, Any], ...] = ()

    def at(self, dx: float, dy: float) -> Any:
        """The form's value at a span."""
        return self.p * dx + self.q * dy


def _edge(angle: float, slide: int, mu: Any) -> tuple[Any, Any]:
    sin, cos = math.sin(angle), math.cos(angle)
    return sin + mu * (slide * cos), cos - mu * (slide * sin)


def forms(
    number: int,
    shallow: Side,
    *,
    width: float,
    angles: tuple[float, float],
    friction: tuple[Any, Any],
    com: tuple[Any, Any],
    slope: Any,
) -> list[Form]:
    """All conditions of a property with this palm shallow; pairs are (left, right).

    Args:
        number: 0, 1 or 2, the property.
        shallow: the side whose palm is shallow.
        width: w [m].
        angles: of the palms [rad].
        friction: coefficients.
        com: (c_x, c_y) [m].
        slope: s, the horizontal specific force towards -x.
    """
    x, y = com
    s, w = slope, width
    is_left = shallow == "left"
    conditions = [
        Form("lift_left", (w - x) + s * y, y - s * (w - x)),
        Form("lift_right", x - s * y, (s * x + y) * -1.0),
    ]

    def wedge(edge: tuple[Any, Any], side: int) -> tuple[Any, Any]:
        """The form that is > 0 where the edge bounds a squeeze."""
        lateral, vertical = edge
        return vertical, (lateral * -1.0 if side == 0 else lateral)

    for name, (shallow_slide, steep_slide, shallow_first) in zip(
        ("first", "second"), NEEDS[number], strict=True
    ):
        slides = (shallow_slide, steep_slide) if is_left else (steep_slide, shallow_slide)
        left, right = (_edge(angles[i], slides[i], friction[i]) for i in (0, 1))
        a, b = left[0] * right[1], left[1] * right[0]
        c, d = left[1] * right[1], left[0] * right[0]
        # > 0 where the squeeze at the left edge is the higher one
        p = (a + b) * (s * y - x) + w * (a - s * c)
        q = (a + b) * (s * x + y) + w * (d - s * b)
        sign = 1.0 if shallow_first != is_left else -1.0
        void = (wedge(left, 0), wedge(right, 1))
        conditions.append(Form(name, p * sign, q * sign, void))
    sliding = SLIDING_EDGES.get(number)
    if sliding is not None:
        side = SIDES.index(shallow) if sliding[0] == "shallow" else 1 - SIDES.index(shallow)
        conditions.append(
            Form("wedged", *wedge(_edge(angles[side], sliding[1], friction[side]), side))
        )
    return conditions


def failing(form: Form, width: float) -> tuple[float, float] | None:
    """The height differences z at which a form fails, an open interval [m]; None: nowhere.

    A form fails where it is negative and not void. Ends that do not exist are ±width.
    """
    low, high = -math.inf, math.inf  # of tan ϑ
    for p, q in ((-form.p, -form.q), *form.void):  # all > 0 where it fails
        if q > 0:
            low = max(low, -p / q)
        elif q < 0:
            high = min(high, -p / q)
        elif not p > 0:
            return None
    if not low < high:
        return None

    def height(slope: float) -> float:
        if math.isinf(slope):
            return math.copysign(width, slope)
        return width * slope / math.sqrt(1 + slope * slope)

    return height(low), height(high)

# SPDX-License-Identifier: Apache-2.0
"""The conditions of a property on the object's angle: linear forms in (dx, dy).

(dx, dy) is the vector from the left contact to the right one. At given palm angles, frictions, COM
and slope every condition of a property is P dx + Q dy + K ≥ 0. K is 0 for sharp contact vertices;
with rounded ones dx and dy lead from the centre of the left arc to that of the right one, and K is
the contribution of the arcs. If K = 0, the condition bounds tan ϑ = dy / dx on one side; in the
paper's z the bound is w tan ϑ / √(1 + tan² ϑ) (k_B and k_D of equations 6 to 8). The formulas use
only + − ×, so each form is a polynomial of degree at most two in friction, COM or slope, and a
condition begins or ceases to hold at its roots. An array in place of a number gives the forms at
several values. Source: docs/theory/mechanics.md and stability.md.
"""

import math
from collections.abc import Iterator
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
    """P dx + Q dy + K ≥ 0; the condition is void where one of the forms in `void`, each given as
    (P, Q, K), is negative."""

    name: str
    p: Any
    q: Any
    k: Any = 0.0
    void: tuple[tuple[Any, Any, Any], ...] = ()

    def values(self, dx: float, dy: float, weight: float = 1.0) -> Iterator[Any]:
        """The values of the form and of its `void` at a span, with K multiplied by a weight."""
        for p, q, k in ((self.p, self.q, self.k), *self.void):
            yield p * dx + q * dy + k * weight


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
    radius: tuple[float, float] = (0.0, 0.0),
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
        radius: of the arcs that round the contact vertices [m].
    """
    x, y = com
    s, w = slope, width
    is_left = shallow == "left"
    # From the centres of the arcs to the points that touch the palms, outward and down.
    back = [r * math.sin(angle) for r, angle in zip(radius, angles, strict=True)]
    down = [r * math.cos(angle) for r, angle in zip(radius, angles, strict=True)]
    wider, higher = back[0] + back[1], down[0] - down[1]
    left_arm, right_arm = back[0] - s * down[0], back[1] + s * down[1]
    conditions = [
        Form("lift_left", (w - x) + s * y, y - s * (w - x), w * right_arm),
        Form("lift_right", x - s * y, (s * x + y) * -1.0, w * left_arm),
    ]

    def wedge(edge: tuple[Any, Any], side: int) -> tuple[Any, Any, Any]:
        """The form that is > 0 where the edge bounds a squeeze."""
        lateral, vertical = edge
        across = lateral * -1.0 if side == 0 else lateral
        return vertical, across, vertical * wider + across * higher

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
        k = w * (wider * (a - s * c) + higher * (d - s * b) - (a + b) * left_arm)
        sign = 1.0 if shallow_first != is_left else -1.0
        void = (wedge(left, 0), wedge(right, 1))
        conditions.append(Form(name, p * sign, q * sign, k * sign, void))
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
    for p, q, k in ((-form.p, -form.q, -form.k), *form.void):  # all > 0 where it fails
        if k != 0:
            ends = _tangents(p * width, q * width, k)
            if ends is None:
                return None
            low, high = max(low, ends[0]), min(high, ends[1])
        elif q > 0:
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


def _tangents(p: float, q: float, k: float) -> tuple[float, float] | None:
    """The interval of tan ϑ, for |ϑ| < 90°, where p cos ϑ + q sin ϑ + k > 0; None: nowhere.

    If it is positive on both sides of a gap, the interval contains the gap.
    """
    far = math.hypot(p, q)
    if k <= -far:
        return None
    if k >= far:
        return -math.inf, math.inf
    middle, half = math.atan2(q, p), math.acos(-k / far)
    turns = [middle + turn for turn in (-half, half)]
    quarter = 0.5 * math.pi
    pieces = [
        (max(turns[0] + shift, -quarter), min(turns[1] + shift, quarter))
        for shift in (-2 * math.pi, 0.0, 2 * math.pi)
    ]
    found = [piece for piece in pieces if piece[0] < piece[1]]
    if not found:
        return None
    low, high = min(a for a, _ in found), max(b for _, b in found)
    return (
        math.tan(low) if low > -quarter else -math.inf,
        math.tan(high) if high < quarter else math.inf,
    )

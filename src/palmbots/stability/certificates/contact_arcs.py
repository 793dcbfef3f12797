# SPDX-License-Identifier: Apache-2.0
"""Where rounded contact vertices touch the palms in a part of a box, in ball arithmetic.

In every single state an arc acts like a sharp vertex at the point where it touches its palm. So a
part with arcs is proved as one with sharp vertices, whose width and COM range over all states of
the part. With ϑ the angle of the line of the centres, c its length, and

    ρ = (r_L sin θ_L + r_R sin θ_R, r_L cos θ_L − r_R cos θ_R),

the line from the left touching point to the right one is c (cos ϑ, sin ϑ) + ρ in the world.
Source: docs/theory/stability.md, "Certificates of rounded contact vertices".
"""

from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any

from flint import arb

from palmbots.stability.certificates.ball_arithmetic import ball, radians
from palmbots.stability.certificates.obligations import Subbox
from palmbots.stability.certificates.parameter_box import Ends, ParameterBox


def _hull(ends: Ends) -> Any:
    return ball(ends[0]).union(ball(ends[1]))


def _ends(values: Any) -> Ends:
    low, high = values.lower().fmpq(), values.upper().fmpq()
    return Fraction(int(low.p), int(low.q)), Fraction(int(high.p), int(high.q))


def _inset(box: ParameterBox, side: int) -> tuple[Any, Any]:
    """The centre of an arc, (inward, up) from its contact vertex."""
    own, count = box.right_contact if side else 0, len(box.outline)
    edges = []
    for k in (own - 1, (own + 1) % count):
        x, y = ball(box.outline[k][side]), ball(box.outline[k][2])
        length = (x * x + y * y).sqrt()
        edges.append((x / length, y / length))
    (ax, ay), (bx, by) = edges
    scale = ball(box.radius[side]) / abs(ax * by - ay * bx)
    return scale * (ax + bx), scale * (ay + by)


def at_contacts(box: ParameterBox, part: Subbox) -> tuple[ParameterBox, Subbox] | None:
    """The box and the part with COM and width from the touching points; None: no object spans it.

    Without arcs they are the same.
    """
    if not box.rounded:
        return box, part
    r = [ball(radius) for radius in box.radius]
    theta = [radians(low).union(radians(high)) for low, high in part.angles]
    sin, cos = [angle.sin() for angle in theta], [angle.cos() for angle in theta]
    heights = [
        _hull(part.contacts[i]) * sin[i] + (_hull(box.offset[i]) + r[i]) * cos[i] for i in (0, 1)
    ]
    (left_in, left_up), (right_in, right_up) = (_inset(box, side) for side in (0, 1))
    run, step = _hull(part.width) - left_in - right_in, right_up - left_up
    between = (run * run + step * step).sqrt()
    turn = (heights[1] - heights[0]) / between
    if not (run > 0 and abs(turn) < 1):
        return None
    level = (1 - turn * turn).sqrt().min(arb(1))  # cos ϑ
    along = r[0] * sin[0] + r[1] * sin[1]
    across = r[0] * cos[0] - r[1] * cos[1]
    square = between * between + along * along + across * across
    square += 2 * between * (level * along + turn * across)
    if not square > 0:
        return None
    width = square.sqrt()
    # The line of the touching points, seen from that of the centres.
    ahead = (between + level * along + turn * across) / width
    aside = (level * across - turn * along) / width
    arm = r[0] * (sin[0] * level + cos[0] * turn), r[0] * (cos[0] * level - sin[0] * turn)
    coms: list[tuple[Ends, Ends]] = []
    for x, y in box.com:
        right, up = ball(x) - left_in, ball(y) - left_up
        from_x = (run * right + step * up) / between + arm[0]
        from_y = (run * up - step * right) / between + arm[1]
        coms.append(
            (_ends(ahead * from_x + aside * from_y), _ends(ahead * from_y - aside * from_x))
        )
    corners = tuple(corner for xs, ys in coms for corner in product(xs, ys))
    if box.com_is_upright:
        xs, ys = ({corner[axis] for corner in corners} for axis in (0, 1))
        corners = tuple(product((min(xs), max(xs)), (min(ys), max(ys))))
    return replace(box, com=corners), replace(part, width=_ends(width))

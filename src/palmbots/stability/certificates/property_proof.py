# SPDX-License-Identifier: Apache-2.0
"""Proof or refutation of a property for a part of a box, at its corners, in ball arithmetic.

With the tangents of the palm angles and of the object's angle as variables, every condition is
linear in each uncertain quantity alone. It therefore holds on a part if it holds at the corners of
the part, with the object's tangent enclosed over the part.
Source: docs/theory/stability.md, "Why corners suffice".
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

from palmbots._types import SIDES
from palmbots.stability.certificates.ball_arithmetic import ball, object_tangents, radians
from palmbots.stability.certificates.contact_arcs import at_contacts
from palmbots.stability.certificates.obligations import Obligation, Subbox, exact
from palmbots.stability.certificates.parameter_box import Ends, ParameterBox, text
from palmbots.stability.linear_conditions import NEEDS, SLIDING_EDGES


@dataclass(frozen=True)
class Corner:
    """One corner of a part: tangents t and frictions per palm, COM, tan ϑ, w and s; as balls."""

    t: tuple[Any, Any]
    mu: tuple[Any, Any]
    com: tuple[Any, Any]
    turn: Any
    width: Any
    slope: Any

    def edge(self, side: int, slide: int) -> tuple[Any, Any]:
        """(lateral, vertical) of the edge that slides up (1) or down (-1)."""
        t, mu = self.t[side], self.mu[side]
        return (t + mu, 1 - mu * t) if slide > 0 else (t - mu, 1 + mu * t)

    def bounds(self, side: int, slide: int) -> Any:
        """> 0 where this edge bounds the squeeze, < 0 where it is wedged."""
        lateral, vertical = self.edge(side, slide)
        return vertical - lateral * self.turn if side == 0 else vertical + lateral * self.turn

    def compare(self, left: int, right: int) -> Any:
        """> 0 where the squeeze at the left palm's edge is less than at the right one's."""
        one, two = self.edge(0, left), self.edge(1, right)
        x, y = self.com
        s, turn = self.slope, self.turn
        a, b = one[0] * two[1], one[1] * two[0]
        line = x - s * turn * x - turn * y - s * y
        meet = a - s * (one[1] * two[1]) + turn * (one[0] * two[0] - s * b)
        return (a + b) * line - self.width * meet

    def lift(self, side: int) -> Any:
        """> 0 where the object presses on this palm."""
        x, y = self.com
        s, turn = self.slope, self.turn
        if side == 0:
            arm = self.width - x
            return arm + s * y + turn * (y - s * arm)
        return x - s * y - turn * (y + s * x)


def corners(box: ParameterBox, part: Subbox) -> list[Corner] | None:
    """The corners of a part; None: the object cannot span its contacts."""
    touching = at_contacts(box, part)
    turns = object_tangents(*touching) if touching else None
    if touching is None or turns is None:
        return None
    box, part = touching

    def balls(ends: Ends) -> list[Any]:
        return [ball(end) for end in dict.fromkeys(ends)]

    t = [[radians(end).tan() for end in dict.fromkeys(angle)] for angle in part.angles]
    coms = [(ball(x), ball(y)) for x, y in box.com]
    return [
        Corner((t_left, t_right), (mu_left, mu_right), com, turn, w, s)
        for t_left, t_right, mu_left, mu_right, com, turn, w, s in product(
            t[0],
            t[1],
            balls(part.friction[0]),
            balls(part.friction[1]),
            coms,
            turns,
            balls(part.width),
            balls(box.slope),
        )
    ]


def _conditions(number: int, shallow: int) -> dict[str, Callable[[Corner], Any]]:
    """The conditions that have to be positive, by name."""
    steep = 1 - shallow
    forms: dict[str, Callable[[Corner], Any]] = {
        "lift_left": lambda c: c.lift(0),
        "lift_right": lambda c: c.lift(1),
    }
    if number in SLIDING_EDGES:
        palm, slide = SLIDING_EDGES[number]
        side = shallow if palm == "shallow" else steep
        forms["wedged"] = lambda c: c.bounds(side, slide)
    for name, (one, two, shallow_first) in zip(("first", "second"), NEEDS[number], strict=True):
        slides = (one, two) if shallow == 0 else (two, one)
        forms[name] = _comparison(slides, shallow_first == (shallow == 0))
    return forms


def _comparison(slides: tuple[int, int], left_less: bool) -> Callable[[Corner], Any]:
    return lambda c: c.compare(*slides) if left_less else -c.compare(*slides)


def _slides(number: int, shallow: int, name: str) -> tuple[int, int]:
    one, two, _ = NEEDS[number][0 if name == "first" else 1]
    return (one, two) if shallow == 0 else (two, one)


def proved(box: ParameterBox, obligation: Obligation, part: Subbox) -> bool:
    """Whether the corners of a part prove a property for all of it."""
    at = corners(box, part)
    if at is None:
        return False
    number, shallow = obligation.number, obligation.side
    for name, form in _conditions(number, shallow).items():
        if all(form(corner) > 0 for corner in at):
            continue
        if name not in ("first", "second"):
            return False
        slides = _slides(number, shallow, name)
        if not any(all(c.bounds(i, slides[i]) < 0 for c in at) for i in (0, 1)):
            return False
    return True


def refuted(box: ParameterBox, obligation: Obligation, part: Subbox) -> dict[str, Any] | None:
    """A corner of the box at which a condition certainly fails: the worst one."""
    worst: tuple[float, dict[str, Any]] | None = None
    forms = _conditions(obligation.number, obligation.side)
    for point, exactly in points(box, part):
        at = corners(exactly, point)
        for name, form in forms.items() if at else ():
            values = [form(corner) for corner in at or ()]
            if not all(value < 0 for value in values):
                continue
            if name in ("first", "second"):
                slides = _slides(obligation.number, obligation.side, name)
                if not all(c.bounds(i, slides[i]) > 0 for c in at or () for i in (0, 1)):
                    continue
            size = float(values[0].mid())
            if worst is None or size < worst[0]:
                worst = size, witness(obligation, name, point, exactly)
    return worst[1] if worst else None


def points(box: ParameterBox, part: Subbox) -> Iterator[tuple[Subbox, ParameterBox]]:
    """Every corner of a part, as a part of one point and a box of one COM, slope and offset."""
    frictions = list(product(*(dict.fromkeys(f) for f in part.friction)))
    if box.common:
        frictions = [(mu, mu) for mu in dict.fromkeys(part.friction[0])]
    extreme = [
        (part.contacts[0][i], part.contacts[1][j]) for i, j in ((0, 1), (1, 0), (0, 0), (1, 1))
    ]
    choices = product(
        product(*(dict.fromkeys(a) for a in part.angles)),
        frictions,
        box.com,
        dict.fromkeys(part.width),
        dict.fromkeys(box.slope),
        dict.fromkeys(extreme),
        product(*(dict.fromkeys(o) for o in box.offset)),
    )
    for angles, mu, com, w, s, contacts, offset in choices:
        point = Subbox(
            (exact(angles[0]), exact(angles[1])),
            (exact(mu[0]), exact(mu[1])),
            exact(w),
            (exact(contacts[0]), exact(contacts[1])),
        )
        exactly = replace(
            box, com=(com,), slope=exact(s), offset=(exact(offset[0]), exact(offset[1]))
        )
        yield point, exactly


def witness(
    obligation: Obligation, fails: str, point: Subbox, exactly: ParameterBox
) -> dict[str, Any]:
    """A point at which a condition fails, as a certificate contains it."""

    def sides(pair: tuple[Ends, Ends]) -> dict[str, str]:
        return {side: text(ends[0]) for side, ends in zip(SIDES, pair, strict=True)}

    (com,) = exactly.com
    return {
        "claim": obligation.name,
        "fails": fails,
        "angle_deg": sides(point.angles),
        "friction": sides(point.friction),
        "contacts_m": sides(point.contacts),
        "offset_m": sides(exactly.offset),
        "com_m": [text(com[0]), text(com[1])],
        "width_m": text(point.width[0]),
        "slope": text(exactly.slope[0]),
    }

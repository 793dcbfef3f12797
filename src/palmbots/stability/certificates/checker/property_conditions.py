# SPDX-License-Identifier: Apache-2.0
"""The checker's conditions for the properties: forms at the corners of a box, in exact rationals.

Claim: let the palm angles, the frictions, the COM, the width w, the slope s and the contacts p be
any values of the certificate's box. With t the tangent of a palm's angle, T the tangent of the
object's angle, and the edges of a friction cone

    up:   lateral t + μ, vertical 1 − μ t        down: lateral t − μ, vertical 1 + μ t

the squeeze at the left edge (a, b) is less than that at the right edge (c, d) iff

    (a d + b c) ((1 − s T) x − (T + s) y) > w (a d − s b d + T (a c − s b c))

(docs/theory/stability.md, both sides times dx). A property is a few such comparisons, "the object
is not lifted off" on either side, and "the edge that slides is not wedged". Each of these forms is
linear in each of t, μ, x, y, T, w and s alone. It is therefore positive on a whole box if it is
positive at all corners of the box; no other theorem is used. T belongs to the box as an interval
that contains every T of the palm angles and contacts.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from itertools import product

from palmbots._util.arguments import show
from palmbots.stability.certificates.checker.enclosures import (
    Ends,
    cosine_of_degrees,
    down,
    root,
    sine_of_degrees,
    up,
)

F = Fraction
LEFT, RIGHT = 0, 1


class CheckFailed(Exception):
    """The certificate does not prove what it claims."""


# ---- the box -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ParameterBox:
    """The quantities that may be bisected: palm angles, frictions, width and contacts."""

    angles: tuple[Ends, Ends]  # degrees
    friction: tuple[Ends, Ends]
    width: Ends
    contacts: tuple[Ends, Ends]
    common: bool

    def halves(self, name: str, at: Fraction) -> tuple["ParameterBox", "ParameterBox"]:
        """The parts of the box below and above a value of one quantity."""

        def split(ends: Ends) -> tuple[Ends, Ends]:
            if not ends[0] < at < ends[1]:
                raise CheckFailed(
                    f"{name} is bisected at {show(str(at))}, which is not inside its interval"
                )
            return (ends[0], at), (at, ends[1])

        def split_side(pair: tuple[Ends, Ends], side: int) -> list[tuple[Ends, Ends]]:
            keep = pair[1 - side]
            return [(one, keep) if side == LEFT else (keep, one) for one in split(pair[side])]

        if name in ("left", "right"):
            both = split_side(self.angles, LEFT if name == "left" else RIGHT)
            return replace(self, angles=both[0]), replace(self, angles=both[1])
        if name in ("p left", "p right"):
            both = split_side(self.contacts, LEFT if name == "p left" else RIGHT)
            return replace(self, contacts=both[0]), replace(self, contacts=both[1])
        if name == "width":
            low, high = split(self.width)
            return replace(self, width=low), replace(self, width=high)
        if name == "friction" and self.common:
            low, high = split(self.friction[0])
            return replace(self, friction=(low, low)), replace(self, friction=(high, high))
        raise CheckFailed(f"{show(name)} is not a quantity that can be bisected")


@dataclass(frozen=True)
class ObjectParams:
    """The quantities that all obligations share: COM, slope and pivot offsets."""

    com: tuple[tuple[Fraction, Fraction], ...]
    slope: Ends
    offset: tuple[Ends, Ends]


def object_tangent(box: ParameterBox, given: ObjectParams) -> Ends:
    """Encloses tan ϑ over the angles, widths and contacts of a box."""
    heights: list[Ends] = []
    for side in (LEFT, RIGHT):
        low, high = box.angles[side]
        sines = (sine_of_degrees(low)[0], sine_of_degrees(high)[1])
        cosines = [c for angle in (low, high) for c in cosine_of_degrees(angle)]
        if low < 0 < high:
            cosines.append(F(1))
        along = [p * s for p in box.contacts[side] for s in sines]
        across = [o * c for o in given.offset[side] for c in cosines]
        heights.append((min(along) + min(across), max(along) + max(across)))
    rise = (heights[RIGHT][0] - heights[LEFT][1], heights[RIGHT][1] - heights[LEFT][0])
    if max(-rise[0], rise[1]) >= box.width[0]:
        raise CheckFailed("the object cannot span the palms everywhere in the parameter box")

    def tangent(z: Fraction, upward: bool) -> Fraction:
        outward = (z > 0) == upward
        w = box.width[0] if outward else box.width[1]
        run = root(w * w - z * z, upward=not outward)
        return z / run

    return down(tangent(rise[0], False)), up(tangent(rise[1], True))


@lru_cache(maxsize=4096)  # parts of a box have most of their ends in common
def _tangent_of_degrees(degrees: Fraction) -> Ends:
    """Encloses tan of −80° to 80°."""
    sine, cosine = sine_of_degrees(degrees), cosine_of_degrees(degrees)
    quotients = [s / c for s in sine for c in cosine]
    return down(min(quotients)), up(max(quotients))


def palm_tangents(box: ParameterBox) -> tuple[Ends, Ends]:
    """tan θ at both ends of each palm's angle."""
    left, right = (
        (_tangent_of_degrees(low)[0], _tangent_of_degrees(high)[1]) for low, high in box.angles
    )
    return left, right


# ---- the forms -----------------------------------------------------------------------------------

UP, DOWN = 1, -1

# Per property: (edge of the shallow palm, edge of the steep one, which has the smaller squeeze),
# and the edge that slides.
NEEDS: dict[int, tuple[tuple[tuple[int, int, str], ...], tuple[str, int] | None]] = {
    0: (((UP, DOWN, "steep"), (DOWN, UP, "shallow")), None),
    1: (((UP, UP, "shallow"), (UP, DOWN, "steep")), ("shallow", UP)),
    2: (((DOWN, DOWN, "shallow"), (UP, DOWN, "steep")), ("steep", DOWN)),
}


@dataclass(frozen=True)
class Corner:
    """One corner of a box, in the symbols above; pairs are (left, right)."""

    t: tuple[Fraction, Fraction]
    mu: tuple[Fraction, Fraction]
    x: Fraction
    y: Fraction
    turn: Fraction  # T
    w: Fraction
    s: Fraction

    def edge(self, side: int, slide: int) -> tuple[Fraction, Fraction]:
        """(lateral, vertical) of the edge that slides up (1) or down (−1)."""
        t, mu = self.t[side], slide * self.mu[side]
        return t + mu, 1 - mu * t

    def bounded(self, side: int, slide: int) -> Fraction:
        """> 0 where this edge bounds the squeeze (is not wedged)."""
        lateral, vertical = self.edge(side, slide)
        return vertical - (lateral if side == LEFT else -lateral) * self.turn

    def left_smaller(self, left: int, right: int) -> Fraction:
        """> 0 where the squeeze at the left edge is the smaller one."""
        (a, b), (c, d) = self.edge(LEFT, left), self.edge(RIGHT, right)
        gravity = (1 - self.s * self.turn) * self.x - (self.turn + self.s) * self.y
        meeting = a * d - self.s * b * d + self.turn * (a * c - self.s * b * c)
        return (a * d + b * c) * gravity - self.w * meeting

    def pressed(self, side: int) -> Fraction:
        """> 0 where the object presses on this palm."""
        if side == LEFT:
            right_arm = self.w - self.x
            return right_arm + self.s * self.y + self.turn * (self.y - self.s * right_arm)
        return self.x - self.s * self.y - self.turn * (self.s * self.x + self.y)


def corners(box: ParameterBox, given: ObjectParams) -> Iterator[Corner]:
    """All corners of a box."""
    # For a common friction, all pairs of its ends are more than necessary.
    t, turn = palm_tangents(box), object_tangent(box, given)
    for values in product(
        set(t[0]),
        set(t[1]),
        set(box.friction[0]),
        set(box.friction[1]),
        given.com,
        set(turn),
        set(box.width),
        set(given.slope),
    ):
        t_left, t_right, mu_left, mu_right, (x, y), tan_turn, w, s = values
        yield Corner((t_left, t_right), (mu_left, mu_right), x, y, tan_turn, w, s)


def prove_property(number: int, shallow: int, at: list[Corner]) -> None:
    """Raise `CheckFailed` unless the corners of a box prove a property."""
    steep = 1 - shallow
    side_of = {"shallow": shallow, "steep": steep}

    def everywhere(form: Callable[[Corner], Fraction]) -> bool:
        return all(form(corner) > 0 for corner in at)

    needs, sliding = NEEDS[number]
    for side in (LEFT, RIGHT):
        if not everywhere(lambda c, side=side: c.pressed(side)):
            raise CheckFailed("the object may tip")
    if sliding is not None:
        side, slide = side_of[sliding[0]], sliding[1]
        if not everywhere(lambda c: c.bounded(side, slide)):
            raise CheckFailed("the contact that should slide may be wedged")
    for shallow_slide, steep_slide, smaller in needs:
        slides = {shallow: shallow_slide, steep: steep_slide}
        if everywhere(comparison(slides, side_of[smaller])):
            continue
        wedged = [all(c.bounded(side, slides[side]) < 0 for c in at) for side in slides]
        if not any(wedged):  # an unbounded squeeze is never the smaller one
            raise CheckFailed("the wrong contact may slide")


def comparison(slides: dict[int, int], smaller: int) -> Callable[[Corner], Fraction]:
    """The form that is > 0 where the squeeze at this side's edge is the smaller one."""
    sign = 1 if smaller == LEFT else -1
    return lambda corner: sign * corner.left_smaller(slides[LEFT], slides[RIGHT])


def refute_property(number: int, shallow: int, what: str, at: list[Corner]) -> None:
    """Raise `CheckFailed` unless a property's condition fails at all corners around a point."""
    steep = 1 - shallow
    needs, sliding = NEEDS[number]
    forms: dict[str, Callable[[Corner], Fraction]] = {
        "lift_left": lambda c: c.pressed(LEFT),
        "lift_right": lambda c: c.pressed(RIGHT),
    }
    if sliding is not None:
        side = shallow if sliding[0] == "shallow" else steep
        forms["wedged"] = lambda c: c.bounded(side, sliding[1])
    slides_of: dict[str, dict[int, int]] = {}
    for word, (shallow_slide, steep_slide, smaller) in zip(("first", "second"), needs, strict=True):
        slides_of[word] = {shallow: shallow_slide, steep: steep_slide}
        forms[word] = comparison(slides_of[word], shallow if smaller == "shallow" else steep)
    if what not in forms:
        raise CheckFailed(f"{show(what)} is not a condition of this property")
    if not all(forms[what](corner) < 0 for corner in at):
        raise CheckFailed("the property does not certainly fail at the witness")
    for side, slide in slides_of.get(what, {}).items():
        if not all(corner.bounded(side, slide) > 0 for corner in at):
            raise CheckFailed("a wedged edge makes the condition void at the witness")

"""Certificates: proofs that the properties hold for everything in a box of uncertainty, or do not.

The prover works with ball arithmetic (Arb, through python-flint), so rounding and trigonometry are
included. Every condition is linear in each uncertain quantity alone once tangents of the palms'
angles and of the object's angle stand for those; so a box is proved at its corners, the
object's tangent being enclosed over the box. Where corners do not suffice, the box is halved along
the quantity that matters most and each half is proved. What is written is the box, the claims and
where it was halved, nothing else; `palmbots.check` verifies it with exact rationals and code of its
own. Source: MECHANICS section 3, "Vertex certificate".
"""

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from os import PathLike
from typing import Any, Literal

from flint import arb, ctx, fmpq

from palmbots.files import write_whole
from palmbots.scene import Scene, load_scene
from palmbots.sections import SIDES
from palmbots.stability.box import Box, Ends, box_of, text
from palmbots.stability.forms import LETS_GO, NEEDS

__all__ = ["CLAIMS", "Certificate", "certify", "prove"]

CLAIMS = ("property 1", "property 2", "property 0", "clearance")
_FORMAT = "palmbots certificate 1"
_MOST_PARTS = 20_000
_BITS = 128

Verdict = Literal["holds", "fails", "undecided"]


@dataclass(frozen=True)
class Certificate:
    """What could be proved of a box; `data` is what stands in the file."""

    verdict: Verdict
    data: dict[str, Any]
    parts: int
    """Boxes whose corners were looked at."""
    undecided: str = ""
    """The first obligation that could be neither proved nor refuted."""

    def save(self, path: str | PathLike[str]) -> None:
        """Write the certificate, whole or not at all."""
        write_whole(path, json.dumps(self.data, indent=1) + "\n")


@dataclass(frozen=True)
class _Part:
    """Palm angles [degrees], frictions and width: what is halved, and the contacts."""

    angles: tuple[Ends, Ends]
    friction: tuple[Ends, Ends]
    width: Ends
    contacts: tuple[Ends, Ends]


@dataclass(frozen=True)
class _Obligation:
    name: str
    number: int
    shallow: int
    part: _Part


def _just(value: Fraction) -> Ends:
    return value, value


def _ball(value: Fraction) -> Any:
    return arb(fmpq(value.numerator, value.denominator))


def _radians(degrees: Fraction) -> Any:
    return _ball(degrees) * arb.pi() / 180


def _clipped(box: Box, number: int, shallow: int) -> tuple[Ends, Ends]:
    left, right = box.contacts
    if number == 1:
        low, high = box.contacts[shallow]
        less = (low, min(high, box.beyond))
        return (less, right) if shallow == 0 else (left, less)
    if number == 2:
        low, high = box.contacts[1 - shallow]
        less = (max(low, -box.beyond), high)
        return (left, less) if shallow == 0 else (less, right)
    return box.contacts


def _obligations(box: Box, claims: tuple[str, ...]) -> Iterator[_Obligation]:
    low, high = box.shallow_deg, box.steep_deg

    def one(name: str, number: int, shallow: int, angles: Any, region: int) -> _Obligation:
        contacts = _clipped(box, region, shallow)
        return _Obligation(name, number, shallow, _Part(angles, box.friction, box.width, contacts))

    for number in (1, 2):
        if f"property {number}" in claims:
            for side, word in enumerate(SIDES):
                angles = (low[0], high[1]) if side == 0 else (high[0], low[1])
                yield one(f"{number} {word}", number, side, angles, number)
    if "property 0" in claims or "clearance" in claims:
        yield one("0 steep", 0, 0, high, 0)
        yield one("0 shallow", 0, 0, low, 0)
        for side, word in enumerate(SIDES):
            turning = (low[side][0], high[side][1])
            angles = (turning, high[1]) if side == 0 else (high[0], turning)
            for region in (1, 2):
                yield one(f"0 {word} {region}", 0, side, angles, region)


def _object_tangents(box: Box, part: _Part) -> tuple[Any, Any] | None:
    """Balls around the least and the greatest tan ϑ of a part; None: it cannot reach."""
    heights: list[tuple[Any, Any]] = []
    for side in (0, 1):
        low, high = (_radians(angle) for angle in part.angles[side])
        sines = (low.sin(), high.sin())
        cosines = [low.cos(), high.cos()]
        if part.angles[side][0] < 0 < part.angles[side][1]:
            cosines.append(arb(1))
        along = [_ball(p) * s for p in part.contacts[side] for s in sines]
        across = [_ball(box.offset[side]) * c for c in cosines]
        heights.append((_least(along) + _least(across), _most(along) + _most(across)))
    rise = (heights[1][0] - heights[0][1], heights[1][1] - heights[0][0])

    def tangent(z: Any, upward: bool) -> Any | None:
        outward = (z > 0) == upward
        w = _ball(part.width[0] if outward else part.width[1])
        square = w * w - z * z
        return z / square.sqrt() if square > 0 else None

    found = tangent(rise[0], False), tangent(rise[1], True)
    return None if found[0] is None or found[1] is None else (found[0], found[1])


def _least(balls: list[Any]) -> Any:
    least = balls[0]
    for ball in balls[1:]:
        least = least.min(ball)
    return least


def _most(balls: list[Any]) -> Any:
    most = balls[0]
    for ball in balls[1:]:
        most = most.max(ball)
    return most


@dataclass(frozen=True)
class _Corner:
    """One corner of a part: tangents t and frictions per palm, COM, tan ϑ, w and s; as balls."""

    t: tuple[Any, Any]
    mu: tuple[Any, Any]
    com: tuple[Any, Any]
    turn: Any
    width: Any
    slope: Any

    def edge(self, side: int, slide: int) -> tuple[Any, Any]:
        t, mu = self.t[side], self.mu[side]
        return (t + mu, 1 - mu * t) if slide > 0 else (t - mu, 1 + mu * t)

    def bounds(self, side: int, slide: int) -> Any:
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
        x, y = self.com
        s, turn = self.slope, self.turn
        if side == 0:
            arm = self.width - x
            return arm + s * y + turn * (y - s * arm)
        return x - s * y - turn * (y + s * x)


def _corners(box: Box, part: _Part) -> list[_Corner] | None:
    turns = _object_tangents(box, part)
    if turns is None:
        return None

    def balls(ends: Ends) -> list[Any]:
        return [_ball(end) for end in dict.fromkeys(ends)]

    t = [[_radians(end).tan() for end in dict.fromkeys(angle)] for angle in part.angles]
    coms = [(_ball(x), _ball(y)) for x, y in box.com]
    return [
        _Corner((t_left, t_right), (mu_left, mu_right), com, turn, w, s)
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


def _conditions(number: int, shallow: int) -> dict[str, Callable[[_Corner], Any]]:
    """What has to be positive, by name."""
    steep = 1 - shallow
    forms: dict[str, Callable[[_Corner], Any]] = {
        "lift_left": lambda c: c.lift(0),
        "lift_right": lambda c: c.lift(1),
    }
    if number in LETS_GO:
        who, slide = LETS_GO[number]
        side = shallow if who == "shallow" else steep
        forms["wedged"] = lambda c: c.bounds(side, slide)
    for name, (one, two, shallow_first) in zip(("first", "second"), NEEDS[number], strict=True):
        slides = (one, two) if shallow == 0 else (two, one)
        forms[name] = _comparison(slides, shallow_first == (shallow == 0))
    return forms


def _comparison(slides: tuple[int, int], left_less: bool) -> Callable[[_Corner], Any]:
    return lambda c: c.compare(*slides) if left_less else -c.compare(*slides)


def _slides(number: int, shallow: int, name: str) -> tuple[int, int]:
    one, two, _ = NEEDS[number][0 if name == "first" else 1]
    return (one, two) if shallow == 0 else (two, one)


def _proved(box: Box, claims: tuple[str, ...], obligation: _Obligation, part: _Part) -> bool:
    corners = _corners(box, part)
    if corners is None:
        return False
    number, shallow = obligation.number, obligation.shallow
    if number or "property 0" in claims:
        for name, form in _conditions(number, shallow).items():
            if all(form(corner) > 0 for corner in corners):
                continue
            if name not in ("first", "second"):
                return False
            slides = _slides(number, shallow, name)
            if not any(all(c.bounds(i, slides[i]) < 0 for c in corners) for i in (0, 1)):
                return False
    if number == 0 and "clearance" in claims:
        for corner in corners:
            for side in (0, 1):
                turn = corner.turn if side == 0 else -corner.turn
                across, upright = corner.t[side] + turn, 1 - corner.t[side] * turn
                if not across > 0:
                    return False
                for from_left, from_right, height in box.outline:
                    along = from_left if side == 0 else from_right
                    if not _ball(along) * across + _ball(height) * upright > 0:
                        return False
    return True


def _refuted(box: Box, obligation: _Obligation, part: _Part) -> dict[str, Any] | None:
    """A corner of the box at which a condition certainly fails: the worst one."""
    worst: tuple[float, dict[str, Any]] | None = None
    forms = _conditions(obligation.number, obligation.shallow)
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
    )
    for angles, mu, com, w, s, contacts in choices:
        point = _Part(
            (_just(angles[0]), _just(angles[1])),
            (_just(mu[0]), _just(mu[1])),
            _just(w),
            (_just(contacts[0]), _just(contacts[1])),
        )
        corners = _corners(replace(box, com=(com,), slope=_just(s)), point)
        for name, form in forms.items() if corners else ():
            values = [form(corner) for corner in corners or ()]
            if not all(value < 0 for value in values):
                continue
            if name in ("first", "second"):
                slides = _slides(obligation.number, obligation.shallow, name)
                if not all(c.bounds(i, slides[i]) > 0 for c in corners or () for i in (0, 1)):
                    continue
            size = float(values[0].mid())
            if worst is None or size < worst[0]:
                worst = (
                    size,
                    {
                        "claim": obligation.name,
                        "fails": name,
                        "angle_deg": dict(zip(SIDES, map(text, angles), strict=True)),
                        "friction": dict(zip(SIDES, map(text, mu), strict=True)),
                        "contacts_m": dict(zip(SIDES, map(text, contacts), strict=True)),
                        "com_m": [text(com[0]), text(com[1])],
                        "width_m": text(w),
                        "slope": text(s),
                    },
                )
    return worst[1] if worst else None


def _halving(box: Box, part: _Part) -> tuple[str, Fraction, _Part, _Part] | None:
    """The two halves of a part along what turns the forces most."""

    def extent(ends: Ends) -> float:
        return float(ends[1] - ends[0])

    sizes = {side: math.radians(extent(part.angles[i])) for i, side in enumerate(SIDES)}
    if box.common:
        sizes["friction"] = extent(part.friction[0])
    sizes["width"] = extent(part.width) / float(part.width[0])
    name = max(sizes, key=lambda key: sizes[key])
    if sizes[name] < 1e-7:
        return None

    def cut(ends: Ends) -> tuple[Fraction, Ends, Ends]:
        at = (ends[0] + ends[1]) / 2
        return at, (ends[0], at), (at, ends[1])

    if name == "width":
        at, low, high = cut(part.width)
        return name, at, replace(part, width=low), replace(part, width=high)
    if name == "friction":
        at, low, high = cut(part.friction[0])
        halves = [replace(part, friction=(one, one)) for one in (low, high)]
        return name, at, halves[0], halves[1]
    side = SIDES.index("left" if name == "left" else "right")
    at, low, high = cut(part.angles[side])
    keep = part.angles[1 - side]
    halves = [replace(part, angles=(a, keep) if side == 0 else (keep, a)) for a in (low, high)]
    return name, at, halves[0], halves[1]


def prove(
    box: Box, claims: tuple[str, ...] = CLAIMS, *, most_parts: int = _MOST_PARTS
) -> Certificate:
    """Prove or refute the claims for a whole box, with at most so many parts looked at."""
    with ctx.workprec(_BITS):
        return _prove(box, claims, most_parts)


def _prove(box: Box, claims: tuple[str, ...], most_parts: int) -> Certificate:
    head = {"format": _FORMAT, "claims": list(claims), "box": box.as_dict()}
    parts = 0
    proof: dict[str, Any] = {}
    obligations = list(_obligations(box, claims))
    for obligation in obligations:
        if obligation.number == 0 and "property 0" not in claims:
            continue
        witness = _refuted(box, obligation, obligation.part)
        if witness is not None:
            return Certificate("fails", head | {"verdict": "fails", "witness": witness}, parts)
    for obligation in obligations:
        holder: list[Any] = [None]
        pending: list[tuple[_Part, list[Any], int]] = [(obligation.part, holder, 0)]
        while pending:
            part, into, index = pending.pop()
            parts += 1
            if _proved(box, claims, obligation, part):
                into[index] = "corners"
                continue
            halves = _halving(box, part)
            if halves is None or parts > most_parts:
                # Undecided as a whole; inside the box there may be a point that fails.
                if obligation.number or "property 0" in claims:
                    witness = _refuted(box, obligation, part)
                    if witness is not None:
                        data = head | {"verdict": "fails", "witness": witness}
                        return Certificate("fails", data, parts)
                return Certificate(
                    "undecided", head | {"verdict": "undecided"}, parts, obligation.name
                )
            name, at, low, high = halves
            node: list[Any] = [name, text(at), None, None]
            into[index] = node
            pending += [(high, node, 3), (low, node, 2)]
        proof[obligation.name] = holder[0]
    return Certificate("holds", head | {"verdict": "holds", "proof": proof}, parts)


def certify(
    scene: Any = "paper",
    *,
    overrides: Any = None,
    claims: tuple[str, ...] = CLAIMS,
    most_parts: int = _MOST_PARTS,
    **uncertainty: Any,
) -> Certificate:
    """Prove that the properties hold for everything in a box of uncertainty, or that they do not.

    Args:
        scene: as in `palmbots.carry`.
        overrides: scene keys to set.
        claims: of `CLAIMS`, what to prove.
        most_parts: how much work to spend before calling it undecided.
        uncertainty: intervals (low, high) as in `box_of`: com_x_m, com_y_m (or com_polygon_m, a
            list of points), friction, friction_right, common (True: both palms have the same
            coefficient), shallow_deg, steep_deg, width_m, length_m, slope, region_m. What is not
            given is as in the scene, exactly.

    Raises:
        SceneError: the scene cannot be read or makes no sense.
        PalmbotsError: an interval is upside down or beyond what a scene allows.
    """
    chosen: Scene = load_scene(scene, overrides)
    return prove(box_of(chosen, **uncertainty), claims, most_parts=most_parts)

"""Verifies a certificate, sharing nothing with what wrote it: exact rational numbers only.

What is verified. Let the palms' angles, the frictions, the COM, the width w, the slope s and the
contacts p be anything in the certificate's box. With t the tangent of a palm's angle, T that of the
object's, and the edges of a friction cone

    up:   lateral t + μ, vertical 1 − μ t        down: lateral t − μ, vertical 1 + μ t

the squeeze at the left edge (a, b) is less than that at the right edge (c, d) iff

    (a d + b c) ((1 − s T) x − (T + s) y) > w (a d − s b d + T (a c − s b c))

(MECHANICS section 3, both sides times dx). A property is a few such comparisons, "the object is
not lifted off" on either side, and "the edge that lets go is not wedged". Each of these forms is
linear in each of t, μ, x, y, T, w and s alone. So it is positive on a whole box if it is positive
at all corners of the box; that is the only theorem used. T belongs to the box as an interval that
holds every T the palms' angles and contacts can give. Where corners do not suffice, the
certificate says at which value of which quantity to halve the box; the check follows it and
trusts nothing else in it.
"""

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

from palmbots.enclosures import Ends, cosine_of_degrees, down, root, sine_of_degrees, up
from palmbots.errors import PalmbotsError, show

__all__ = ["Checked", "check"]

F = Fraction
LEFT, RIGHT = 0, 1
FORMAT = "palmbots certificate 1"
_MOST_BYTES = 50_000_000
_NUMBER = re.compile(r"-?[0-9]+(\.[0-9]+|/[0-9]+)?")


@dataclass(frozen=True)
class Checked:
    """The verdict on a certificate."""

    valid: bool
    claim: str
    why: str
    """Where it is not valid, the first reason."""

    def summary(self) -> dict[str, Any]:
        """What ``palmbots check --json`` prints."""
        return {"valid": self.valid, "claim": self.claim, "why": self.why}


class _Wrong(Exception):
    """The certificate does not prove what it claims."""


# ---- the box -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Box:
    angles: tuple[Ends, Ends]  # degrees
    friction: tuple[Ends, Ends]
    width: Ends
    common: bool

    def halves(self, name: str, at: Fraction) -> tuple["_Box", "_Box"]:
        """The two parts of the box below and above a value of one quantity."""

        def cut(ends: Ends) -> tuple[Ends, Ends]:
            if not ends[0] < at < ends[1]:
                raise _Wrong(f"{name} is to be halved at {at}, which is not inside it")
            return (ends[0], at), (at, ends[1])

        if name in ("left", "right"):
            side = LEFT if name == "left" else RIGHT
            low, high = cut(self.angles[side])
            keep = self.angles[1 - side]
            both = [(one, keep) if side == LEFT else (keep, one) for one in (low, high)]
            return replace(self, angles=both[0]), replace(self, angles=both[1])
        if name == "width":
            low, high = cut(self.width)
            return replace(self, width=low), replace(self, width=high)
        if name == "friction" and self.common:
            low, high = cut(self.friction[0])
            return replace(self, friction=(low, low)), replace(self, friction=(high, high))
        raise _Wrong(f"{name!r} is nothing that can be halved")


@dataclass(frozen=True)
class _Given:
    """What every claim shares."""

    com: tuple[tuple[Fraction, Fraction], ...]
    slope: Ends
    offset: tuple[Fraction, Fraction]
    outline: tuple[tuple[Fraction, Fraction, Fraction], ...]


def _object_tangent(box: _Box, given: _Given, contacts: tuple[Ends, Ends]) -> Ends:
    """Every tan ϑ that the angles, the widths and these contacts can give."""
    heights: list[Ends] = []
    for side in (LEFT, RIGHT):
        low, high = box.angles[side]
        sines = (sine_of_degrees(low)[0], sine_of_degrees(high)[1])
        cosines = [c for angle in (low, high) for c in cosine_of_degrees(angle)]
        if low < 0 < high:
            cosines.append(F(1))
        along = [p * s for p in contacts[side] for s in sines]
        across = [given.offset[side] * c for c in cosines]
        heights.append((min(along) + min(across), max(along) + max(across)))
    rise = (heights[RIGHT][0] - heights[LEFT][1], heights[RIGHT][1] - heights[LEFT][0])
    if max(-rise[0], rise[1]) >= box.width[0]:
        raise _Wrong("the object cannot reach from palm to palm everywhere in the box")

    def tangent(z: Fraction, upward: bool) -> Fraction:
        outward = (z > 0) == upward
        w = box.width[0] if outward else box.width[1]
        run = root(w * w - z * z, upward=not outward)
        return z / run

    return down(tangent(rise[0], False)), up(tangent(rise[1], True))


def _palm_tangents(box: _Box) -> tuple[Ends, Ends]:
    """tan θ at both ends of each palm's angle."""
    found: list[Ends] = []
    for low, high in box.angles:
        ends: list[Fraction] = []
        for angle, end in ((low, 0), (high, 1)):
            sine, cosine = sine_of_degrees(angle), cosine_of_degrees(angle)
            ends.append([min, max][end](s / c for s in sine for c in cosine))
        found.append((down(ends[0]), up(ends[1])))
    return found[0], found[1]


# ---- the forms -----------------------------------------------------------------------------------

UP, DOWN = 1, -1

# Per property: (edge of the shallow palm, edge of the steep one, which has the smaller squeeze),
# and the edge that lets go.
_NEEDS: dict[int, tuple[tuple[tuple[int, int, str], ...], tuple[str, int] | None]] = {
    0: (((UP, DOWN, "steep"), (DOWN, UP, "shallow")), None),
    1: (((UP, UP, "shallow"), (UP, DOWN, "steep")), ("shallow", UP)),
    2: (((DOWN, DOWN, "shallow"), (UP, DOWN, "steep")), ("steep", DOWN)),
}


@dataclass(frozen=True)
class _Corner:
    t: tuple[Fraction, Fraction]
    mu: tuple[Fraction, Fraction]
    x: Fraction
    y: Fraction
    turn: Fraction  # T
    w: Fraction
    s: Fraction

    def edge(self, side: int, slide: int) -> tuple[Fraction, Fraction]:
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


def _corners(box: _Box, given: _Given, turn: Ends) -> Iterator[_Corner]:
    # Where both palms have the same friction, all pairs from its interval are more than needed.
    t = _palm_tangents(box)
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
        yield _Corner((t_left, t_right), (mu_left, mu_right), x, y, tan_turn, w, s)


def _property(number: int, shallow: int, corners: list[_Corner]) -> None:
    """Raises where a property is not proved by the corners of a box."""
    steep = 1 - shallow
    side_of = {"shallow": shallow, "steep": steep}

    def everywhere(form: Callable[[_Corner], Fraction]) -> bool:
        return all(form(corner) > 0 for corner in corners)

    needs, lets_go = _NEEDS[number]
    for side in (LEFT, RIGHT):
        if not everywhere(lambda c, side=side: c.pressed(side)):
            raise _Wrong("the object may tip")
    if lets_go is not None:
        side, slide = side_of[lets_go[0]], lets_go[1]
        if not everywhere(lambda c: c.bounded(side, slide)):
            raise _Wrong("the contact that should slide may be wedged")
    for shallow_slide, steep_slide, smaller in needs:
        slides = {shallow: shallow_slide, steep: steep_slide}
        if everywhere(_comparison(slides, side_of[smaller])):
            continue
        wedged = [all(c.bounded(side, slides[side]) < 0 for c in corners) for side in slides]
        if not any(wedged):  # a squeeze without bound is never the first one
            raise _Wrong("the wrong contact may slide")


def _comparison(slides: dict[int, int], smaller: int) -> Callable[[_Corner], Fraction]:
    """The form that is > 0 where the squeeze at this side's edge is the smaller one."""
    sign = 1 if smaller == LEFT else -1
    return lambda corner: sign * corner.left_smaller(slides[LEFT], slides[RIGHT])


def _clear(side: int, given: _Given, corners: list[_Corner]) -> None:
    """Raises where a vertex of the outline may come down to the (endless) line of a palm."""
    for from_left, from_right, height in given.outline:
        for corner in corners:
            t, turn = corner.t[side], corner.turn
            if side == LEFT:
                above = from_left * (t + turn) + height * (1 - t * turn)
            else:
                above = from_right * (t - turn) + height * (1 + t * turn)
            if not above > 0:
                raise _Wrong("the outline may touch a palm")
    for corner in corners:  # the other contact vertex, too
        t, turn = corner.t[side], corner.turn
        if not (t + turn if side == LEFT else t - turn) > 0:
            raise _Wrong("the object may lie flat on a palm")


def _follow(
    tree: Any, box: _Box, given: _Given, contacts: tuple[Ends, Ends], prove: Callable[..., None]
) -> None:
    """Walks down the halvings of a proof to boxes whose corners suffice."""
    pending = [(tree, box)]
    while pending:
        node, part = pending.pop()
        if node == "corners":
            prove(list(_corners(part, given, _object_tangent(part, given, contacts))))
            continue
        if not (isinstance(node, list) and len(node) == 4 and isinstance(node[0], str)):
            raise _Wrong("a proof is neither 'corners' nor [what, at, below, above]")
        low, high = part.halves(node[0], _number(node[1]))
        pending += [(node[3], high), (node[2], low)]


# ---- what has to be proved -----------------------------------------------------------------------


def _clip(
    contacts: tuple[Ends, Ends], number: int, shallow: int, beyond: Fraction
) -> tuple[Ends, Ends]:
    """The contacts for which property 1 or 2 is needed."""
    ends = [list(c) for c in contacts]
    if number == 1:
        ends[shallow][1] = min(ends[shallow][1], beyond)
    if number == 2:
        ends[1 - shallow][0] = max(ends[1 - shallow][0], -beyond)
    return (ends[0][0], ends[0][1]), (ends[1][0], ends[1][1])


def _obligations(
    box: dict[str, Any], claims: list[str]
) -> Iterator[tuple[str, int, int, Any, Any]]:
    """Every (name, property, shallow side, palm angles, contacts) that the claims consist of."""
    shallow, steep = (_sides(box, key) for key in ("shallow_deg", "steep_deg"))
    contacts, beyond = _sides(box, "contacts_m"), _number(box["beyond_m"])
    names = ("left", "right")
    for number in (1, 2):
        if f"property {number}" not in claims:
            continue
        for side in (LEFT, RIGHT):
            angles = (shallow[0], steep[1]) if side == LEFT else (steep[0], shallow[1])
            yield (
                f"{number} {names[side]}",
                number,
                side,
                angles,
                _clip(contacts, number, side, beyond),
            )
    if "property 0" not in claims and "clearance" not in claims:
        return
    yield "0 steep", 0, LEFT, steep, contacts
    yield "0 shallow", 0, LEFT, shallow, contacts
    for side in (LEFT, RIGHT):
        turning = (shallow[side][0], steep[side][1])  # from shallow to steep, all in between
        angles = (turning, steep[1]) if side == LEFT else (steep[0], turning)
        for number in (1, 2):
            yield (
                f"0 {names[side]} {number}",
                0,
                side,
                angles,
                _clip(contacts, number, side, beyond),
            )


def _number(value: Any) -> Fraction:
    # Plain decimals and quotients only: an exponent could ask for a number as long as the memory.
    if not isinstance(value, str) or len(value) > 200 or not _NUMBER.fullmatch(value):
        raise _Wrong(f"{show(value)} is no exact number")
    try:
        return F(value)
    except ZeroDivisionError:
        raise _Wrong(f"{show(value)} is no exact number") from None


def _ends(value: Any) -> Ends:
    low, high = (_number(v) for v in value)
    if low > high:
        raise _Wrong(f"{show(value)} has its ends the wrong way round")
    return low, high


def _just(value: Fraction) -> Ends:
    return value, value


def _sides(box: dict[str, Any], key: str) -> tuple[Ends, Ends]:
    return _ends(box[key]["left"]), _ends(box[key]["right"])


def _read(box: dict[str, Any]) -> tuple[_Given, tuple[Ends, Ends], bool, Ends]:
    com = tuple((_number(x), _number(y)) for x, y in box["com_m"])
    if not com:
        raise _Wrong("there is no COM")
    outline = tuple(
        (_number(left), _number(right), _number(height)) for left, right, height in box["outline_m"]
    )
    offset = (_number(box["offset_m"]["left"]), _number(box["offset_m"]["right"]))
    friction, common = _sides(box, "friction"), box["friction"]["common"]
    width = _ends(box["width_m"])
    if common is not True and common is not False:
        raise _Wrong("friction.common is neither true nor false")
    if common and friction[0] != friction[1]:
        raise _Wrong("a common friction has two intervals")
    if friction[0][0] < 0 or friction[1][0] < 0 or width[0] <= 0:
        raise _Wrong("friction or width is negative")
    for key in ("shallow_deg", "steep_deg"):
        if any(abs(end) >= 80 for ends in _sides(box, key) for end in ends):
            raise _Wrong("a palm angle is not between −80° and 80°")
    for low, high in _sides(box, "contacts_m"):
        if not low <= 0 <= high:
            raise _Wrong("the region of contacts does not hold p = 0")
    return _Given(com, _ends(box["slope"]), offset, outline), friction, common, width


def _check_holds(certificate: dict[str, Any]) -> None:
    box, claims = certificate["box"], certificate["claims"]
    given, friction, common, width = _read(box)
    unknown = set(claims) - {"property 0", "property 1", "property 2", "clearance"}
    if unknown or not claims:
        raise _Wrong("claims what is not known here, or nothing")
    for name, number, shallow, angles, contacts in _obligations(box, claims):
        part = _Box(angles, friction, width, common)

        def prove(corners: list[_Corner], number: int = number, shallow: int = shallow) -> None:
            if number or "property 0" in claims:
                _property(number, shallow, corners)
            if number == 0 and "clearance" in claims:
                for side in (LEFT, RIGHT):
                    _clear(side, given, corners)

        try:
            _follow(certificate["proof"][name], part, given, contacts, prove)
        except KeyError:
            raise _Wrong(f"the proof of {name!r} is missing") from None
        except _Wrong as wrong:
            raise _Wrong(f"{name}: {wrong}") from None


def _check_fails(certificate: dict[str, Any]) -> None:
    """One point of the box at which a property fails for certain."""
    box, witness = certificate["box"], certificate["witness"]
    given, friction, common, width = _read(box)
    name, what = witness["claim"], witness["fails"]
    found = {o[0]: o for o in _obligations(box, certificate["claims"])}
    if name not in found:
        raise _Wrong(f"{show(name)} is not claimed")
    _, number, shallow, angles, contacts = found[name]
    at_angles = tuple(_number(witness["angle_deg"][side]) for side in ("left", "right"))
    mu = tuple(_number(witness["friction"][side]) for side in ("left", "right"))
    p = tuple(_number(witness["contacts_m"][side]) for side in ("left", "right"))
    x, y = (_number(v) for v in witness["com_m"])
    w, s = _number(witness["width_m"]), _number(witness["slope"])
    inside = [
        all(angles[i][0] <= at_angles[i] <= angles[i][1] for i in (0, 1)),
        all(friction[i][0] <= mu[i] <= friction[i][1] for i in (0, 1)),
        all(contacts[i][0] <= p[i] <= contacts[i][1] for i in (0, 1)),
        not common or mu[0] == mu[1],
        width[0] <= w <= width[1],
        given.slope[0] <= s <= given.slope[1],
        (x, y) in given.com,
    ]
    if not all(inside):
        raise _Wrong("the witness is not a point of the box")
    point = _Box(
        (_just(at_angles[0]), _just(at_angles[1])), (_just(mu[0]), _just(mu[1])), _just(w), False
    )
    turn = _object_tangent(point, given, (_just(p[0]), _just(p[1])))
    exact = replace(given, com=((x, y),), slope=_just(s))
    corners = list(_corners(point, exact, turn))
    steep = 1 - shallow
    needs, lets_go = _NEEDS[number]
    forms: dict[str, Callable[[_Corner], Fraction]] = {
        "lift_left": lambda c: c.pressed(LEFT),
        "lift_right": lambda c: c.pressed(RIGHT),
    }
    if lets_go is not None:
        side = shallow if lets_go[0] == "shallow" else steep
        forms["wedged"] = lambda c: c.bounded(side, lets_go[1])
    slides_of: dict[str, dict[int, int]] = {}
    for word, (shallow_slide, steep_slide, smaller) in zip(("first", "second"), needs, strict=True):
        slides_of[word] = {shallow: shallow_slide, steep: steep_slide}
        forms[word] = _comparison(slides_of[word], shallow if smaller == "shallow" else steep)
    if what not in forms:
        raise _Wrong(f"{show(what)} is no condition of this property")
    if not all(forms[what](corner) < 0 for corner in corners):
        raise _Wrong("the property does not certainly fail at the witness")
    for side, slide in slides_of.get(what, {}).items():
        if not all(corner.bounded(side, slide) > 0 for corner in corners):
            raise _Wrong("a wedged edge makes the condition needless at the witness")


def check(path: Any) -> Checked:
    """Verify a certificate file.

    Raises:
        PalmbotsError: the file cannot be read or is no certificate.
    """
    try:
        if Path(path).stat().st_size > _MOST_BYTES:
            raise PalmbotsError(f"{path}: is too large for a certificate")
        certificate = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise PalmbotsError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise PalmbotsError(f"{path}: is no certificate: {error}") from None
    if not isinstance(certificate, dict) or certificate.get("format") != FORMAT:
        raise PalmbotsError(f'{path}: is no certificate; allowed: JSON with "format": "{FORMAT}"')
    verdict = certificate.get("verdict")
    claims = certificate.get("claims")
    if not isinstance(claims, list) or not all(isinstance(c, str) for c in claims):
        return Checked(False, "", "claims is not a list of names")
    claim = f"{verdict}: {', '.join(claims)}"
    try:
        if verdict == "holds":
            _check_holds(certificate)
        elif verdict == "fails":
            _check_fails(certificate)
        else:
            raise _Wrong("the verdict is neither 'holds' nor 'fails'")
    except _Wrong as wrong:
        return Checked(False, claim, str(wrong))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return Checked(False, claim, f"is incomplete or misshapen: {error!r}")
    return Checked(True, claim, "")

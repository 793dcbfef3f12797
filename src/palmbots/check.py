"""Verifies a certificate, sharing nothing with what wrote it: exact rational numbers only.

What has to hold at the corners of a box, and why corners suffice, stands in `exact_forms`. Where
the corners of the whole box do not suffice, the certificate says at which value of which quantity
to halve it; the check follows it and trusts nothing else in it.
"""

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from palmbots.enclosures import Ends
from palmbots.errors import PalmbotsError, show
from palmbots.exact_forms import (
    LEFT,
    NEEDS,
    RIGHT,
    Box,
    Corner,
    Given,
    Wrong,
    comparison,
    corners,
    object_tangent,
    prove_clear,
    prove_property,
)

__all__ = ["Checked", "check"]

F = Fraction
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


def _follow(
    tree: Any, box: Box, given: Given, contacts: tuple[Ends, Ends], prove: Callable[..., None]
) -> None:
    """Walks down the halvings of a proof to boxes whose corners suffice."""
    pending = [(tree, box)]
    while pending:
        node, part = pending.pop()
        if node == "corners":
            prove(list(corners(part, given, object_tangent(part, given, contacts))))
            continue
        if not (isinstance(node, list) and len(node) == 4 and isinstance(node[0], str)):
            raise Wrong("a proof is neither 'corners' nor [what, at, below, above]")
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
        raise Wrong(f"{show(value)} is no exact number")
    try:
        return F(value)
    except ZeroDivisionError:
        raise Wrong(f"{show(value)} is no exact number") from None


def _ends(value: Any) -> Ends:
    low, high = (_number(v) for v in value)
    if low > high:
        raise Wrong(f"{show(value)} has its ends the wrong way round")
    return low, high


def _just(value: Fraction) -> Ends:
    return value, value


def _sides(box: dict[str, Any], key: str) -> tuple[Ends, Ends]:
    return _ends(box[key]["left"]), _ends(box[key]["right"])


def _read(box: dict[str, Any]) -> tuple[Given, tuple[Ends, Ends], bool, Ends]:
    com = tuple((_number(x), _number(y)) for x, y in box["com_m"])
    if not com:
        raise Wrong("there is no COM")
    outline = tuple(
        (_number(left), _number(right), _number(height)) for left, right, height in box["outline_m"]
    )
    offset = (_number(box["offset_m"]["left"]), _number(box["offset_m"]["right"]))
    friction, common = _sides(box, "friction"), box["friction"]["common"]
    width = _ends(box["width_m"])
    if common is not True and common is not False:
        raise Wrong("friction.common is neither true nor false")
    if common and friction[0] != friction[1]:
        raise Wrong("a common friction has two intervals")
    if friction[0][0] < 0 or friction[1][0] < 0 or width[0] <= 0:
        raise Wrong("friction or width is negative")
    for key in ("shallow_deg", "steep_deg"):
        if any(abs(end) >= 80 for ends in _sides(box, key) for end in ends):
            raise Wrong("a palm angle is not between −80° and 80°")
    for low, high in _sides(box, "contacts_m"):
        if not low <= 0 <= high:
            raise Wrong("the region of contacts does not hold p = 0")
    return Given(com, _ends(box["slope"]), offset, outline), friction, common, width


def _check_holds(certificate: dict[str, Any]) -> None:
    box, claims = certificate["box"], certificate["claims"]
    given, friction, common, width = _read(box)
    unknown = set(claims) - {"property 0", "property 1", "property 2", "clearance"}
    if unknown or not claims:
        raise Wrong("claims what is not known here, or nothing")
    for name, number, shallow, angles, contacts in _obligations(box, claims):
        part = Box(angles, friction, width, common)

        def prove(corners: list[Corner], number: int = number, shallow: int = shallow) -> None:
            if number or "property 0" in claims:
                prove_property(number, shallow, corners)
            if number == 0 and "clearance" in claims:
                for side in (LEFT, RIGHT):
                    prove_clear(side, given, corners)

        try:
            _follow(certificate["proof"][name], part, given, contacts, prove)
        except KeyError:
            raise Wrong(f"the proof of {name!r} is missing") from None
        except Wrong as wrong:
            raise Wrong(f"{name}: {wrong}") from None


def _check_fails(certificate: dict[str, Any]) -> None:
    """One point of the box at which a property fails for certain."""
    box, witness = certificate["box"], certificate["witness"]
    given, friction, common, width = _read(box)
    name, what = witness["claim"], witness["fails"]
    found = {o[0]: o for o in _obligations(box, certificate["claims"])}
    if name not in found:
        raise Wrong(f"{show(name)} is not claimed")
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
        raise Wrong("the witness is not a point of the box")
    point = Box(
        (_just(at_angles[0]), _just(at_angles[1])), (_just(mu[0]), _just(mu[1])), _just(w), False
    )
    turn = object_tangent(point, given, (_just(p[0]), _just(p[1])))
    exact = replace(given, com=((x, y),), slope=_just(s))
    at = list(corners(point, exact, turn))
    steep = 1 - shallow
    needs, lets_go = NEEDS[number]
    forms: dict[str, Callable[[Corner], Fraction]] = {
        "lift_left": lambda c: c.pressed(LEFT),
        "lift_right": lambda c: c.pressed(RIGHT),
    }
    if lets_go is not None:
        side = shallow if lets_go[0] == "shallow" else steep
        forms["wedged"] = lambda c: c.bounded(side, lets_go[1])
    slides_of: dict[str, dict[int, int]] = {}
    for word, (shallow_slide, steep_slide, smaller) in zip(("first", "second"), needs, strict=True):
        slides_of[word] = {shallow: shallow_slide, steep: steep_slide}
        forms[word] = comparison(slides_of[word], shallow if smaller == "shallow" else steep)
    if what not in forms:
        raise Wrong(f"{show(what)} is no condition of this property")
    if not all(forms[what](corner) < 0 for corner in at):
        raise Wrong("the property does not certainly fail at the witness")
    for side, slide in slides_of.get(what, {}).items():
        if not all(corner.bounded(side, slide) > 0 for corner in at):
            raise Wrong("a wedged edge makes the condition needless at the witness")


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
            raise Wrong("the verdict is neither 'holds' nor 'fails'")
    except Wrong as wrong:
        return Checked(False, claim, str(wrong))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return Checked(False, claim, f"is incomplete or misshapen: {error!r}")
    return Checked(True, claim, "")

"""Verifies a certificate, sharing nothing with what wrote it: exact rational numbers only.

What has to hold at the corners of a box, and why corners suffice, stands in `exact_forms` for the
properties and in `exact_clearance` for the clearance of the outline. Where
the corners of the whole box do not suffice, the certificate says at which value of which quantity
to halve it; the check follows it and trusts nothing else in it.
"""

import json
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from palmbots.enclosures import Ends
from palmbots.errors import PalmbotsError, show
from palmbots.exact_clearance import Thing, prove_clear, prove_touching
from palmbots.exact_forms import (
    LEFT,
    RIGHT,
    Box,
    Given,
    Wrong,
    corners,
    prove_property,
    refute_property,
)

__all__ = ["Checked", "check"]

F = Fraction
FORMAT = "palmbots certificate 2"
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


def _follow(tree: Any, box: Box, prove: Callable[[Box], None]) -> None:
    """Walks down the halvings of a proof to boxes whose corners suffice."""
    pending = [(tree, box)]
    while pending:
        node, part = pending.pop()
        if node == "corners":
            prove(part)
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


@dataclass(frozen=True)
class _Obligation:
    """Something that has to hold all over a box."""

    claim: str
    number: int  # of the property
    side: int  # the shallow palm; for clearance the palm that is not to be touched
    angles: tuple[Ends, Ends]
    contacts: tuple[Ends, Ends]


def _obligations(box: dict[str, Any], claims: list[str]) -> dict[str, _Obligation]:
    """Everything that the claims consist of, by name."""
    shallow, steep = (_sides(box, key) for key in ("shallow_deg", "steep_deg"))
    contacts, beyond = _sides(box, "contacts_m"), _number(box["beyond_m"])
    names = ("left", "right")
    found: dict[str, _Obligation] = {}
    for number in (1, 2):
        claim = f"property {number}"
        for side in (LEFT, RIGHT) if claim in claims else ():
            angles = (shallow[0], steep[1]) if side == LEFT else (steep[0], shallow[1])
            region = _clip(contacts, number, side, beyond)
            found[f"{number} {names[side]}"] = _Obligation(claim, number, side, angles, region)

    poses = [("steep", LEFT, steep, contacts), ("shallow", LEFT, shallow, contacts)]
    for side in (LEFT, RIGHT):
        turning = (shallow[side][0], steep[side][1])  # from shallow to steep, all in between
        angles = (turning, steep[1]) if side == LEFT else (steep[0], turning)
        for number in (1, 2):
            region = _clip(contacts, number, side, beyond)
            poses.append((f"{names[side]} {number}", side, angles, region))
    for pose, turns, angles, region in poses:
        if "property 0" in claims:
            found[f"0 {pose}"] = _Obligation("property 0", 0, turns, angles, region)
        for side in (LEFT, RIGHT) if "clearance" in claims else ():
            name = f"clear {names[side]} {pose}"
            found[name] = _Obligation("clearance", 0, side, angles, region)
    return found


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


def _sides(box: dict[str, Any], key: str) -> tuple[Ends, Ends]:
    return _ends(box[key]["left"]), _ends(box[key]["right"])


@dataclass(frozen=True)
class _Read:
    """A certificate's box, but for what differs between obligations."""

    given: Given
    thing: Thing
    friction: tuple[Ends, Ends]
    width: Ends
    common: bool


def _read(box: dict[str, Any]) -> _Read:
    com = tuple((_number(x), _number(y)) for x, y in box["com_m"])
    if not com:
        raise Wrong("there is no COM")
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
    for flat, steep in zip(_sides(box, "shallow_deg"), _sides(box, "steep_deg"), strict=True):
        if not flat[1] < steep[0]:
            raise Wrong("a shallow angle is not below the steep one")
    if _number(box["beyond_m"]) < 0:
        raise Wrong("a correction ends before p = 0")
    for low, high in _sides(box, "contacts_m"):
        if not low <= 0 <= high:
            raise Wrong("the region of contacts does not hold p = 0")
    given = Given(com, _ends(box["slope"]), _sides(box, "offset_m"))
    return _Read(given, _thing(box), friction, width, common)


def _thing(box: dict[str, Any]) -> Thing:
    outline = tuple(
        (_number(left), _number(right), _number(height)) for left, right, height in box["outline_m"]
    )
    contact, half = box["right_contact"], _sides(box, "half_length_m")
    if type(contact) is not int or not 0 < contact < len(outline) or len(outline) < 3:
        raise Wrong("the outline has no right contact, or no three vertices")
    if any(low <= 0 for low, _ in half):
        raise Wrong("a palm has no length")
    start, end = outline[0], outline[contact]
    if start[0] or start[2] or end[1] or end[2]:
        raise Wrong("a contact is not where the outline is measured from")
    # The two are written rounded; but they are to be of one and the same object.
    if any(abs(left + right - start[1]) > start[1] / 10**9 for left, right, _ in outline):
        raise Wrong("seen from the two contacts the outline is not the same")
    return Thing(outline, contact, half)


def _check_holds(certificate: dict[str, Any]) -> None:
    box, claims = certificate["box"], certificate["claims"]
    read = _read(box)
    unknown = set(claims) - {"property 0", "property 1", "property 2", "clearance"}
    if unknown or not claims:
        raise Wrong("claims what is not known here, or nothing")
    for name, needed in _obligations(box, claims).items():
        part = Box(needed.angles, read.friction, read.width, needed.contacts, read.common)

        def prove(part: Box, needed: _Obligation = needed) -> None:
            if needed.claim == "clearance":
                prove_clear(needed.side, part, read.given, read.thing)
            else:
                prove_property(needed.number, needed.side, list(corners(part, read.given)))

        try:
            _follow(certificate["proof"][name], part, prove)
        except KeyError:
            raise Wrong(f"the proof of {name!r} is missing") from None
        except Wrong as wrong:
            raise Wrong(f"{name}: {wrong}") from None


def _check_fails(certificate: dict[str, Any]) -> None:
    """One point of the box at which a claim fails for certain."""
    witness = certificate["witness"]
    read = _read(certificate["box"])
    found = _obligations(certificate["box"], certificate["claims"])
    if witness["claim"] not in found:
        raise Wrong(f"{show(witness['claim'])} is not claimed")
    needed = found[witness["claim"]]

    def both(key: str, within: tuple[Ends, Ends]) -> tuple[Ends, Ends]:
        values = [_number(witness[key][side]) for side in ("left", "right")]
        return _inside(values[0], within[0]), _inside(values[1], within[1])

    angles, contacts = both("angle_deg", needed.angles), both("contacts_m", needed.contacts)
    offset = both("offset_m", read.given.offset)
    w = _inside(_number(witness["width_m"]), read.width)
    if needed.claim == "clearance":
        nothing = (F(0), F(0))
        point = Box(angles, (nothing, nothing), w, contacts, False)
        thing = replace(read.thing, half_length=both("half_length_m", read.thing.half_length))
        edge = witness["edge"]
        if type(edge) is not int or not 0 <= edge < len(thing.outline):
            raise Wrong(f"{show(edge)} is no edge of the outline")
        prove_touching(needed.side, edge, point, replace(read.given, offset=offset), thing)
        return
    mu = both("friction", read.friction)
    if read.common and mu[0] != mu[1]:
        raise Wrong("the witness is not a point of the box")
    x, y = (_number(v) for v in witness["com_m"])
    if (x, y) not in read.given.com:
        raise Wrong("the witness is not a point of the box")
    slope = _inside(_number(witness["slope"]), read.given.slope)
    exact = Given(((x, y),), slope, offset)
    point = Box(angles, mu, w, contacts, False)
    refute_property(needed.number, needed.side, witness["fails"], list(corners(point, exact)))


def _inside(value: Fraction, ends: Ends) -> Ends:
    if not ends[0] <= value <= ends[1]:
        raise Wrong("the witness is not a point of the box")
    return value, value


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
    one_of_them = "at least one of " if verdict == "fails" and len(claims) > 1 else ""
    claim = f"{verdict}: {one_of_them}{', '.join(claims)}"
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

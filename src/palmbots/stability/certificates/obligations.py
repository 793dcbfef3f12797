# SPDX-License-Identifier: Apache-2.0
"""The obligations of a certificate's claims, and the bisection of their parts.

An *obligation* is a condition that has to hold for all palm angles, frictions, widths and contacts
of a part of the box. Properties 1 and 2 have one with either palm as the shallow one. Property 0
and the clearance of each palm have one in every pose: both palms steep, both shallow, and either
one turning from shallow to steep with the contacts of property 1 or 2.

The claims "property 0 turning", "clearance turning" and "no jam" are about palms that turn at the
same time: each palm has any angle from shallow to steep. The contacts are anywhere, except for
"clearance turning": both are outward, p ≥ −beyond, or both are inward, p ≤ beyond. "no jam" has
one obligation for closing and one for opening.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from palmbots._types import SIDES
from palmbots.stability.certificates.parameter_box import Ends, ParameterBox

ONE_TURNS = ("property 1", "property 2", "property 0", "clearance")
"""What robots need if only one of them turns its palm at a time."""
BOTH_TURN = ("property 0 turning", "clearance turning", "no jam")
"""What robots need in addition if they turn their palms at the same time."""
CLAIMS = (*ONE_TURNS, *BOTH_TURN)
"""What a certificate can prove."""
FORCE_CLAIMS = tuple(claim for claim in CLAIMS if not claim.startswith("clearance"))
"""The claims about forces: all that can be proved for rounded contact vertices."""

_LEAST = 1e-7  # intervals smaller than this are not bisected


@dataclass(frozen=True)
class Subbox:
    """Palm angles [degrees], frictions, width and contacts, each between two ends."""

    angles: tuple[Ends, Ends]
    friction: tuple[Ends, Ends]
    width: Ends
    contacts: tuple[Ends, Ends]


@dataclass(frozen=True)
class Obligation:
    """A condition to be proved for all of a part."""

    name: str
    claim: str
    number: int
    """Of the property; 0 for clearance; 1 for a jam on closing, 2 on opening."""
    side: int
    """The shallow palm; for clearance the palm that must not be touched; otherwise 0."""
    part: Subbox


def exact(value: Fraction) -> Ends:
    """An interval of one value."""
    return value, value


def _clipped(box: ParameterBox, number: int, shallow: int) -> tuple[Ends, Ends]:
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


def _poses(box: ParameterBox) -> Iterator[tuple[str, int, Subbox]]:
    """Every pose as (name, turning palm, part)."""
    low, high = box.shallow_deg, box.steep_deg
    yield "steep", 0, Subbox(high, box.friction, box.width, box.contacts)
    yield "shallow", 0, Subbox(low, box.friction, box.width, box.contacts)
    for side, word in enumerate(SIDES):
        turning = (low[side][0], high[side][1])
        angles = (turning, high[1]) if side == 0 else (high[0], turning)
        for region in (1, 2):
            contacts = _clipped(box, region, side)
            yield f"{word} {region}", side, Subbox(angles, box.friction, box.width, contacts)


def obligations(box: ParameterBox, claims: tuple[str, ...]) -> Iterator[Obligation]:
    """All obligations of the claims."""
    low, high = box.shallow_deg, box.steep_deg
    for number in (1, 2):
        claim = f"property {number}"
        for side, word in enumerate(SIDES) if claim in claims else ():
            angles = (low[0], high[1]) if side == 0 else (high[0], low[1])
            part = Subbox(angles, box.friction, box.width, _clipped(box, number, side))
            yield Obligation(f"{number} {word}", claim, number, side, part)
    for pose, turning, part in _poses(box):
        if "property 0" in claims:
            yield Obligation(f"0 {pose}", "property 0", 0, turning, part)
        for side, word in enumerate(SIDES) if "clearance" in claims else ():
            yield Obligation(f"clear {word} {pose}", "clearance", 0, side, part)
    yield from _both_turning(box, claims)


def _both_turning(box: ParameterBox, claims: tuple[str, ...]) -> Iterator[Obligation]:
    """The obligations while both palms turn."""
    left, right = ((box.shallow_deg[i][0], box.steep_deg[i][1]) for i in (0, 1))
    anywhere = Subbox((left, right), box.friction, box.width, box.contacts)
    if "property 0 turning" in claims:
        yield Obligation("0 turning", "property 0 turning", 0, 0, anywhere)
    if "clearance turning" in claims:
        for name, contacts in (("outward", _outward(box)), ("inward", _inward(box))):
            part = replace(anywhere, contacts=contacts)
            for side, word in enumerate(SIDES):
                yield Obligation(f"clear {word} turning {name}", "clearance turning", 0, side, part)
    if "no jam" in claims:
        yield Obligation("jam closing", "no jam", 1, 0, anywhere)
        yield Obligation("jam opening", "no jam", 2, 0, anywhere)


def _outward(box: ParameterBox) -> tuple[Ends, Ends]:
    left, right = ((max(low, -box.beyond), high) for low, high in box.contacts)
    return left, right


def _inward(box: ParameterBox) -> tuple[Ends, Ends]:
    left, right = ((low, min(high, box.beyond)) for low, high in box.contacts)
    return left, right


def _extent(ends: Ends) -> float:
    return float(ends[1] - ends[0])


def _sizes(box: ParameterBox, part: Subbox) -> dict[str, float]:
    """Approximate effect of each quantity on the directions of the forces within a part."""
    sizes: dict[str, float] = {
        "left": math.radians(_extent(part.angles[0])),
        "right": math.radians(_extent(part.angles[1])),
    }
    if box.common:
        sizes["friction"] = _extent(part.friction[0])
    for i, word in enumerate(SIDES if box.rounded else ()):
        sizes[f"p {word}"] = _lift(part, i)
    sizes["width"] = _extent(part.width) / float(part.width[0])
    return sizes


def _lift(part: Subbox, i: int) -> float:
    """Approximate height difference of the contacts due to one of them, in widths."""
    steepest = max(abs(math.sin(math.radians(float(a)))) for a in part.angles[i])
    return steepest * _extent(part.contacts[i]) / float(part.width[0])


def _reaches(part: Subbox, side: int) -> dict[str, float]:
    """Approximate motion of the object relative to a palm due to each quantity, in widths."""
    w = float(part.width[0])
    sizes: dict[str, float] = {"width": _extent(part.width) / w}
    for i, word in ((0, "left"), (1, "right")):
        angle = math.radians(_extent(part.angles[i]))
        far = max(abs(float(p)) for p in part.contacts[i]) / w
        sizes[word] = angle if i == side else far * angle
        sizes[f"p {word}"] = _extent(part.contacts[i]) / w if i == side else _lift(part, i)
    return sizes


def bisect(
    box: ParameterBox, part: Subbox, side: int | None = None, *, contacts: bool = False
) -> tuple[str, Fraction, Subbox, Subbox] | None:
    """A part bisected: (quantity, value, part below, part above); None: it is too small.

    The quantity with the largest effect is bisected: left or right (the palm's angle), friction,
    width, p left or p right (the contact).

    Args:
        box: the box of the part.
        part: the part to bisect.
        side: the palm whose clearance is to be proved; None: the forces.
        contacts: whether the contacts may be bisected.
    """
    sizes = _sizes(box, part) if side is None else _reaches(part, side)
    if side is not None and not contacts:
        sizes = {key: size for key, size in sizes.items() if not key.startswith("p ")}
    name = max(sizes, key=lambda key: sizes[key])
    if sizes[name] < _LEAST:
        return None

    def cut(ends: Ends) -> tuple[Fraction, Ends, Ends]:
        at = (ends[0] + ends[1]) / 2
        return at, (ends[0], at), (at, ends[1])

    def with_side(pair: tuple[Ends, Ends], i: int, ends: Ends) -> tuple[Ends, Ends]:
        return (ends, pair[1]) if i == 0 else (pair[0], ends)

    if name == "width":
        at, *ends = cut(part.width)
        low, high = (replace(part, width=one) for one in ends)
    elif name == "friction":
        at, *ends = cut(part.friction[0])
        low, high = (replace(part, friction=(one, one)) for one in ends)
    elif name in SIDES:
        i = SIDES.index(name)
        at, *ends = cut(part.angles[i])
        low, high = (replace(part, angles=with_side(part.angles, i, one)) for one in ends)
    else:
        i = 0 if name == "p left" else 1
        at, *ends = cut(part.contacts[i])
        low, high = (replace(part, contacts=with_side(part.contacts, i, one)) for one in ends)
    return name, at, low, high

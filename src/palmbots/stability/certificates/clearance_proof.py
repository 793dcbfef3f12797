# SPDX-License-Identifier: Apache-2.0
"""Proof or refutation of the clearance from a palm of finite length for a part, in ball arithmetic.

The origin is the contact vertex, x the line of contacts and y up, so the object is at rest. The
palm is the segment from −b d to a d with d = (cos α, −sin α). Here α = θ ± ϑ is the angle between
palm and object, a = ℓ + p the distance of its tip and b = ℓ − p that of its back end. The palm is
clear if it meets the outline in the contact vertex only. This is the case if

- the contact vertex is convex and both its neighbours lie above the palm's line, and
- of every other edge both ends lie above that line, or both below it, or else the whole palm lies
  on the contact vertex's side of the line through the edge.

Two segments that do not touch are always separated by the line through one of them, so only the
size of a part can leave this undecided. Where all vertices lie above the palm's line, palms of any
length are clear. With d = κ (1 − t u, −(t + u)), κ = cos θ cos ϑ > 0, t = tan θ, u = ± tan ϑ, each
of these conditions is linear in each of t, u, w, κ a and κ b alone, so the corners of a part
suffice. Source: docs/theory/stability.md, "Certificates".
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any

from flint import arb

from palmbots._types import SIDES
from palmbots.stability.certificates.ball_arithmetic import ball, most, object_tangents, radians
from palmbots.stability.certificates.obligations import Obligation, Subbox, exact
from palmbots.stability.certificates.parameter_box import ParameterBox, text

Point = tuple[Any, Any]
_INSET = Fraction(1, 1000)  # a contact at the very end of its palm has no palm beyond it


def _cross(a: Point, b: Point) -> Any:
    return a[0] * b[1] - a[1] * b[0]


def _past(a: Point, b: Point, point: Point) -> Any:
    """On which side of the line from a to b a point lies."""
    return _cross((b[0] - a[0], b[1] - a[1]), (point[0] - a[0], point[1] - a[1]))


def _along(heading: Point, far: Any) -> Point:
    return far * heading[0], far * heading[1]


def _own(box: ParameterBox, side: int) -> int:
    return 0 if side == 0 else box.right_contact


def _reach(box: ParameterBox, side: int, part: Subbox, turns: tuple[Any, Any]) -> tuple[Any, Any]:
    """The largest κ a and κ b."""
    angles = part.angles[side]
    cosines = [radians(angle).cos() for angle in angles]
    level = angles[0] < 0 < angles[1]
    flattest = turns[0].max(-turns[1]).max(arb(0))  # the smallest |tan ϑ|
    kappa = (arb(1) if level else most(cosines)) / (1 + flattest * flattest).sqrt()
    longest = ball(box.half_length[side][1])
    low, high = (ball(p) for p in part.contacts[side])
    return kappa * (longest + high), kappa * (longest - low)


def proved(box: ParameterBox, obligation: Obligation, part: Subbox) -> bool:
    """Whether the corners of a part prove that the outline does not touch the palm."""
    turns = object_tangents(box, part)
    if turns is None:
        return False
    side = obligation.side
    inward, outward = _reach(box, side, part, turns)
    signed = turns if side == 0 else (-turns[1], -turns[0])
    tangents = [radians(angle).tan() for angle in dict.fromkeys(part.angles[side])]
    headings = [(1 - t * u, -(t + u)) for t, u in product(tangents, signed)]
    seen = [_seen(box, side, w) for w in dict.fromkeys(part.width)]
    count, own = len(box.outline), _own(box, side)
    above = [[_cross(h, outline[k]) for h in headings for outline in seen] for k in range(count)]
    upper = [all(height > 0 for height in heights) for heights in above]
    lower = [all(height < 0 for height in heights) for heights in above]
    for k in range(count):
        ends = k, (k + 1) % count
        if own in ends:
            if not upper[ends[0] if ends[1] == own else ends[1]]:
                return False
            continue
        if all(upper[end] for end in ends) or all(lower[end] for end in ends):
            continue
        places = [
            _past(outline[ends[0]], outline[ends[1]], place)
            for outline in seen
            for heading in headings
            for place in ((arb(0), arb(0)), _along(heading, inward), _along(heading, -outward))
        ]
        if not (all(place > 0 for place in places) or all(place < 0 for place in places)):
            return False
    return True


def _seen(box: ParameterBox, side: int, w: Fraction) -> list[Point]:
    return [(ball(x), ball(y)) for x, y in box.seen(side, w)]


def _touching(
    outline: Sequence[Point], own: int, heading: Point, inward: Any, outward: Any
) -> dict[int, Any]:
    """The edges that a palm in one state certainly cuts, with the depth; numbers or balls."""
    above = [_cross(heading, vertex) for vertex in outline]
    cuts: dict[int, Any] = {}
    for k in range(len(outline)):
        i, j = k, (k + 1) % len(outline)
        if own in (i, j):
            height = above[i if j == own else j]
            if inward > 0 and outward > 0 and height < 0:
                cuts[k] = -height
            continue
        if not ((above[i] > 0 and above[j] < 0) or (above[i] < 0 and above[j] > 0)):
            continue
        start = _past(outline[i], outline[j], (0, 0))
        for far in (inward, -outward):
            end = _past(outline[i], outline[j], _along(heading, far))
            if (start > 0 and end < 0) or (start < 0 and end > 0):
                cuts[k] = abs(end)
    return cuts


Place = tuple[tuple[Fraction, ...], ...]
"""Angles, contacts, offsets and half lengths of both palms, and the width."""


def _places(box: ParameterBox, part: Subbox) -> list[Place]:
    """The corners of a part with the longest palms; contacts are moved slightly inward."""
    contacts = [
        dict.fromkeys((low + _INSET * (high - low), high - _INSET * (high - low)))
        for low, high in part.contacts
    ]
    return list(
        product(
            product(*(dict.fromkeys(ends) for ends in part.angles)),
            product(*contacts),
            product(*(dict.fromkeys(ends) for ends in box.offset)),
            (tuple(ends[1] for ends in box.half_length),),
            ((w,) for w in dict.fromkeys(part.width)),
        )
    )


def _roughly(
    box: ParameterBox, side: int, place: Place
) -> tuple[list[Point], Point, float, float] | None:
    """The input of `_touching` in floating point; None: the object cannot span the contacts."""
    angles, contacts, offset, half, (w,) = place
    radian = [math.radians(float(angle)) for angle in angles]
    heights = [
        float(p) * math.sin(a) + float(o) * math.cos(a)
        for p, a, o in zip(contacts, radian, offset, strict=True)
    ]
    sine = (heights[1] - heights[0]) / float(w)
    if not abs(sine) < 1:
        return None
    alpha = radian[side] + (math.asin(sine) if side == 0 else -math.asin(sine))
    outline = [(float(x), float(y)) for x, y in box.seen(side, w)]
    heading = (math.cos(alpha), -math.sin(alpha))
    p, reach = float(contacts[side]), float(half[side])
    return outline, heading, reach + p, reach - p


def endless(box: ParameterBox, obligation: Obligation, part: Subbox) -> bool:
    """Whether palms of any length are clear at a part's corners; approximate, guides bisection."""
    own = _own(box, obligation.side)
    for place in _places(box, part):
        seen = _roughly(box, obligation.side, place)
        if seen is None:
            return False
        outline, heading, *_ = seen
        if not all(_cross(heading, v) > 0 for k, v in enumerate(outline) if k != own):
            return False
    return True


def refuted(box: ParameterBox, obligation: Obligation, part: Subbox) -> dict[str, Any] | None:
    """The corner of a part at which the palm certainly cuts deepest into the outline."""
    side = obligation.side
    worst: tuple[float, int, Place] | None = None
    for place in _places(box, part):
        seen = _roughly(box, side, place)
        if seen is None:
            continue
        for edge, depth in _touching(seen[0], _own(box, side), *seen[1:]).items():
            if worst is None or depth > worst[0]:
                worst = depth, edge, place
    return None if worst is None else _certain(box, obligation, worst[1], worst[2])


def _certain(
    box: ParameterBox, obligation: Obligation, edge: int, place: Place
) -> dict[str, Any] | None:
    """The witness of a palm that cuts an edge in a state; None: not certain."""
    angles, contacts, offset, half, (w,) = place
    side = obligation.side
    point = Subbox(
        (exact(angles[0]), exact(angles[1])),
        (exact(Fraction(0)), exact(Fraction(0))),
        exact(w),
        (exact(contacts[0]), exact(contacts[1])),
    )
    exactly = replace(
        box,
        offset=(exact(offset[0]), exact(offset[1])),
        half_length=(exact(half[0]), exact(half[1])),
    )
    turns = object_tangents(exactly, point)
    if turns is None:
        return None
    t, u = radians(angles[side]).tan(), turns[0] if side == 0 else -turns[0]
    heading = (1 - t * u, -(t + u))
    kappa = radians(angles[side]).cos() / (1 + u * u).sqrt()
    reach, p = ball(half[side]), ball(contacts[side])
    seen, own = _seen(box, side, w), _own(box, side)
    certain = _touching(seen, own, heading, kappa * (reach + p), kappa * (reach - p))
    if edge not in certain:
        return None

    def both(pair: tuple[Fraction, ...]) -> dict[str, str]:
        return dict(zip(SIDES, map(text, pair), strict=True))

    return {
        "claim": obligation.name,
        "fails": "clearance",
        "edge": edge,
        "angle_deg": both(angles),
        "contacts_m": both(contacts),
        "half_length_m": both(half),
        "offset_m": both(offset),
        "width_m": text(w),
    }

# SPDX-License-Identifier: Apache-2.0
"""Closed forms for a nose that gets under an object on the floor, and for a palm that leaves it.

Frame and terms: those of `lifting_bodies`. Source: docs/theory/lifting.md.
"""

import math
from dataclasses import dataclass, replace

from palmbots.mechanics.lifting_bodies import Climb, Plate, Standing, lifts, squeeze_of

_TIE = 0.01  # two squeezes are the same if they differ by less than this share


@dataclass(frozen=True)
class Second:
    """One nose gets under while the other palm is under the object already."""

    squeeze: float
    """With which it gets under [N]; infinite: none suffices."""
    held: float
    """The most that the other palm then holds against it [N]: its corner climbs beyond that."""

    by_heel: bool = False
    """Whether a heel holds against it."""

    @property
    def works(self) -> bool:
        """Whether it gets under before the other corner climbs on. If both need the same squeeze,
        the corner that is on its palm climbs on: its load decreases as the object tilts."""
        held = self.held if self.by_heel else self.held / (1 + _TIE)
        return math.isfinite(self.squeeze) and self.squeeze <= held

    @property
    def ties(self) -> bool:
        """Whether both need the same squeeze, so that both may climb at once."""
        return not self.works and self.squeeze <= self.held * (1 + _TIE) < math.inf


_NEVER = Second(math.inf, 0.0)
"""The object tips over, or the squeeze presses the corner at the nose onto the floor."""


@dataclass(frozen=True)
class Docking:
    """One nose gets under its edge."""

    lean: float
    """ψ [rad]."""
    alone: float
    """Its squeeze while the other corner stands on the floor: the most that this can take [N]."""
    just_on: Second
    """The other corner is just on its palm."""
    at_heel: Second
    """The other corner has climbed to the heel, and the contact with the nose has only slipped."""
    rolled: Second
    """The same if that contact has only rolled."""
    has_heel: bool
    """Whether the other palm has a heel: then the jam is no end if both corners need the same
    squeeze."""
    has_stop: bool
    """Whether the heel is at least as high as the arc's centre over the palm. Its face then holds
    against any squeeze; over a lower heel the arc may roll."""

    @property
    def is_possible(self) -> bool:
        """Whether the nose fits under the edge."""
        return math.isfinite(self.alone)

    @property
    def gets_under(self) -> bool:
        """Whether it certainly gets under although the other palm was first."""
        return self.is_possible and (self.just_on.works or (self.has_stop and self.at_heel.works))

    @property
    def may_get_under(self) -> bool:
        """Whether statics permit it for some sequence of slip and roll."""
        return self.is_possible and bool(self._possible)

    @property
    def needs_heel(self) -> bool:
        """Whether only the heel of the other palm can hold against it."""
        return self.is_possible and not self.just_on.works

    @property
    def second(self) -> Second:
        """The state in which it gets under as the second one with the least squeeze; if there is
        none, the one in which it does not."""
        if not self.may_get_under:
            return self.at_heel if self.needs_heel else self.just_on
        return min(self._possible, key=lambda state: state.squeeze)

    @property
    def _possible(self) -> list[Second]:
        states = [one for one in (self.just_on, self.at_heel, self.rolled) if one.works]
        return [*states, self.just_on] if self.has_heel and self.just_on.ties else states

    @property
    def squeeze(self) -> float:
        """The least with which the robots have to push [N]; infinite: no push suffices."""
        return max(self.alone, self.second.squeeze) if self.may_get_under else math.inf


def docking(body: Standing, plates: tuple[Plate, Plate], side: int) -> Docking:
    """How one nose gets under its edge."""
    own, other = plates[side], plates[1 - side]
    r = body.radii
    lean = own.nose_lean(r[side])
    direction = lean + own.friction
    # The other corner stands on the floor and may lean on the nose of its palm as well.
    feet = [body.touching(1 - side, up) for up in (0.0, other.nose_lean(r[1 - side]))]
    alone = max(body.climb(side, lean, direction, foot).squeeze for foot in feet)
    places = (False, False), (True, False), (True, True)
    found = [_second(body, plates, side, *place) for place in places]
    has_stop = other.heel >= r[1 - side] and other.heel > 0
    return Docking(lean, alone, *found, other.heel > 0, has_stop)


def _second(
    body: Standing, plates: tuple[Plate, Plate], side: int, at_heel: bool, rolled: bool
) -> Second:
    """The nose gets under while the other corner is just on its palm, or at its heel. With `rolled`
    its contact has rolled on the nose without slip while the other corner climbed, and leans less
    by the angle through which the object has turned."""
    own, other = plates[side], plates[1 - side]
    raised = raised_by(body, other, 1 - side, at_heel)
    if raised is None:
        return _NEVER
    lean = own.nose_lean(body.radii[side])
    if rolled:
        if not any(_rolls(one, own, other, side) for one in (body, raised)):
            return _NEVER
        lean = max(own.angle, lean - abs(raised.tilt))
    direction = lean + own.friction
    surface, steepest = raised.touching(1 - side, other.angle), other.angle
    climb = raised.climb(side, lean, direction, surface)
    if at_heel:
        heel, steepest = raised.at_heel(1 - side, other)
        touched = [(surface, other.angle), (heel, steepest)]
        edges = ((at, up + edge * other.friction) for at, up in touched for edge in (-1, 1))
        rays = [raised.ray(1 - side, at, up) for at, up in edges]
        push = raised.ray(side, raised.touching(side, lean), direction)
        found = raised.least(push, rays) if lifts(direction) else None
        if found is not None:
            held = squeeze_of(max(0.0, body.weight - found[1]), steepest + other.friction)
            return Second(found[0], max(found[0], held), by_heel=True)
        climb = raised.climb(side, lean, direction, heel)
    if not 0 < climb.load < body.weight:
        return _NEVER
    # On a slope, the weight itself takes or adds a part of the squeeze.
    by_slope = (1, -1)[side] * body.slope * body.weight
    held = squeeze_of(climb.other_load, steepest + other.friction) + by_slope
    return Second(climb.squeeze, held) if not at_heel or held < climb.squeeze else _NEVER


def raised_by(body: Standing, plate: Plate, side: int, at_heel: bool) -> Standing | None:
    """The object with one corner just on its palm, or at its heel, and the other one as low as it
    stands; None: it is too narrow to reach so high."""
    low, r = body.radii[1 - side], body.radii[side]
    raised, wall = body, 0.0
    for _ in range(12):  # the place at the heel depends a little on the tilt that it causes
        # A palm steeper than ψ touches the arc with its surface before its nose is under it.
        high = plate.centre_height(plate.at_heel(r, wall), r) if at_heel else plate.first_height(r)
        if abs(high - low) >= body.width:
            return None
        raised = replace(body, heights=(high, low) if side == 0 else (low, high))
        wall = raised.side_lean(side, plate)
    return raised


def _rolls(body: Standing, own: Plate, other: Plate, side: int) -> bool:
    """Whether the contact with a nose rolls while the other corner climbs its palm, rather than
    slips down: the squeeze of that corner leans by at least ψ − φ at the nose."""
    lean = own.nose_lean(body.radii[side])
    nose = body.touching(side, lean)
    climb = body.climb(1 - side, other.angle, other.angle + other.friction, nose)
    return math.atan2(climb.other_squeeze, climb.other_load) >= lean - own.friction


def _friction_of(climb: Climb) -> float:
    """The friction that the other corner needs; infinite: it does not press on the floor."""
    return abs(climb.other_squeeze) / climb.other_load if climb.other_load > 0 else math.inf


def least_partner_angle(body: Standing, plates: tuple[Plate, Plate], side: int) -> float:
    """The angle of the other palm from which on it holds against this nose without a heel [rad]:
    V_other tan(θ + φ) = H."""
    own, other = plates[side], plates[1 - side]
    lean = own.nose_lean(body.radii[side])
    low, high = 0.0, math.pi / 2 - other.friction
    for _ in range(50):
        angle = 0.5 * (low + high)
        support = body.touching(1 - side, angle)
        climb = body.climb(side, lean, lean + own.friction, support)
        holds = climb.other_squeeze <= squeeze_of(climb.other_load, angle + other.friction)
        low, high = (low, angle) if holds else (angle, high)
    return high


def floor_friction_to_stay(body: Standing, plates: tuple[Plate, Plate], side: int) -> float:
    """The friction of the floor from which on the other corner stays, while this palm drives out
    from below its corner at p = 0 or less: |V tan(θ − φ)| = μ V′, without slope."""
    own = plates[side]
    most = 0.0
    for p in (-own.half, 0.0):
        high = own.centre_height(p, body.radii[side])
        if abs(high - body.radii[1 - side]) >= body.width:
            return math.inf
        heights = (high, body.radii[1]) if side == 0 else (body.radii[0], high)
        raised = replace(body, heights=heights)
        foot = raised.touching(1 - side, 0.0)
        climb = raised.climb(side, own.angle, own.angle - own.friction, foot)
        most = max(most, _friction_of(climb))
    return most

# SPDX-License-Identifier: Apache-2.0
"""Closed forms for an object that two palms pick up from the floor and put down.

Frame: x forward, y up from the floor, metres, newtons. *Inward* is towards the other palm. The
*lean* of a contact is the angle from the vertical, inward, of its normal. A contact that slips
outward on its surface presses along its lean plus the friction angle φ. Everything is quasistatic.
Source: docs/theory/lifting.md.
"""

import itertools
import math
from dataclasses import dataclass, replace

import palmbots._core as _core
from palmbots.scene.spec import contact_radii

Point = tuple[float, float]
Wrench = tuple[float, float, float]

_LEVEL = math.pi / 2
_NONE = 1e-12  # rad; a force that leans by a right angle lifts nothing
_TIE = 0.01  # two squeezes are the same if they differ by less than this share
_FLAT = 1e-12  # the volume of three unit wrenches that count as dependent, in widths


def edge_lean(height: float, radius: float) -> float:
    """Lean ψ of the contact of a step of this height with an arc that stands beside it: a nose on
    the floor, or a heel on its palm. A right angle: the step is as high as the arc's centre."""
    if height <= 0:
        return 0.0
    return math.acos(1 - height / radius) if height < radius else _LEVEL


def _volume(a: Wrench, b: Wrench, c: Wrench) -> float:
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


def squeeze_of(load: float, direction: float) -> float:
    """The horizontal force of a contact that carries a load and leans by this angle: V tan; with a
    load, infinite from a right angle on."""
    return math.inf if direction >= _LEVEL - _NONE else load * math.tan(direction)


@dataclass(frozen=True)
class Climb:
    """A balance in which one corner is about to slip up its surface, or along it."""

    load: float
    """Vertical force on that corner [N]."""
    squeeze: float
    """Horizontal force of its palm on the object, inward [N]; infinite: no force suffices."""
    other_load: float
    """Vertical force of all that carries the other corner [N]."""
    other_squeeze: float
    """Horizontal force there, inward [N]."""


@dataclass(frozen=True)
class Standing:
    """An object whose contact arcs have their centres at given heights; 0 is left and 1 is right.

    The slope is that of the floor, as in a `Spec`: the weight W has the part −W s along x.
    """

    width: float
    com: Point
    """From the left centre: along the line of centres, and above it."""
    radii: tuple[float, float]
    weight: float
    slope: float = 0.0
    heights: tuple[float, float] = (0.0, 0.0)

    @property
    def tilt(self) -> float:
        """Anticlockwise turn [rad]."""
        return math.asin((self.heights[1] - self.heights[0]) / self.width)

    @property
    def centres(self) -> tuple[Point, Point]:
        """Of the arcs; the left one is at x = 0."""
        return (0.0, self.heights[0]), (self.width * math.cos(self.tilt), self.heights[1])

    @property
    def com_at(self) -> Point:
        """The centre of mass."""
        (along, up), c, s = self.com, math.cos(self.tilt), math.sin(self.tilt)
        return along * c - up * s, self.heights[0] + along * s + up * c

    def touching(self, side: int, lean: float) -> Point:
        """The point of an arc that meets a surface whose normal leans by this angle."""
        (x, y), r = self.centres[side], self.radii[side]
        return x - (1, -1)[side] * r * math.sin(lean), y - r * math.cos(lean)

    def side_lean(self, side: int, plate: "Plate") -> float:
        """How far one side of the object leans outward, seen from its palm. It is upright while the
        object stands."""
        return plate.angle - (-1, 1)[side] * self.tilt

    def at_heel(self, side: int, plate: "Plate") -> tuple[Point, float]:
        """Where the heel touches the object that rests on the surface of this palm, and the lean of
        that contact."""
        r, lean = self.radii[side], self.side_lean(side, plate)
        if not plate.meets_side(r, lean):
            return self.touching(side, plate.heel_lean(r)), plate.heel_lean(r)
        out, up = plate.half - plate.at_heel(r, lean), plate.heel - r
        c, s = math.cos(plate.angle), math.sin(plate.angle)
        x, y = self.centres[side]
        at = x + (-1, 1)[side] * (out * c - up * s), y + out * s + up * c
        return at, _LEVEL + plate.angle - lean

    def climb(self, side: int, lean: float, direction: float, support: Point) -> Climb:
        """The balance with a force that leans by `direction` on one arc, and the reaction of all
        other contacts through one point.

        The moments about that point give V ((x_B − x_A) + (y_A − y_B) tan α) = W (x_B − x_G) +
        W s (y_G − y_B), with x towards the other side.
        """
        sense = (1, -1)[side]
        (xa, ya), (xb, yb), (xg, yg) = self.touching(side, lean), support, self.com_at
        slope = sense * self.slope
        if direction >= _LEVEL - _NONE:
            return Climb(0.0, math.inf, self.weight, math.inf)
        tangent = math.tan(direction)
        load = self.weight * (sense * (xb - xg) + slope * (yg - yb))
        load /= sense * (xb - xa) + (ya - yb) * tangent
        squeeze = load * tangent
        return Climb(load, squeeze, self.weight - load, squeeze - slope * self.weight)

    def ray(self, side: int, at: Point, lean: float) -> Wrench:
        """The wrench about the origin of a unit force of one palm that leans by this angle."""
        across, up = (1, -1)[side] * math.sin(lean), math.cos(lean)
        return across, up, at[0] * up - at[1] * across

    def least(self, push: Wrench, rays: list[Wrench]) -> Point | None:
        """The horizontal and the vertical part of the least force `push` that carries the weight
        together with others; None: none does. The least one needs two others at most."""
        (x, y), slope = self.com_at, self.slope
        load = slope * self.weight, self.weight, self.weight * (x - slope * y)
        sizes = [math.inf]
        for one, two in itertools.combinations(rays, 2):
            volume = _volume(push, one, two)
            if abs(volume) < _FLAT * self.width:
                continue
            parts = (_volume(load, one, two), _volume(push, load, two), _volume(push, one, load))
            if min(part / volume for part in parts) >= 0:
                sizes.append(parts[0] / volume)
        size = min(sizes)
        return (size * abs(push[0]), size * push[1]) if math.isfinite(size) else None


def standing(spec: _core.Spec, weight: float) -> Standing:
    """The object of a scene, flat on the floor."""
    radii = contact_radii(spec)
    return Standing(
        spec.width, (spec.com_left, spec.com_height), radii, weight, spec.slope, heights=radii
    )


@dataclass(frozen=True)
class Plate:
    """One palm whose inner end is on the floor, at one angle."""

    angle: float
    friction: float
    """Friction angle φ."""
    nose: float
    """Height of the upper edge of its nose above the floor: t."""
    pivot: float
    """Height of the pivot above the floor."""
    half: float
    offset: float
    heel: float

    def nose_lean(self, radius: float) -> float:
        """Lean of the contact with an arc that stands on the floor: ψ, with cos ψ = 1 − t / r, at
        the upper edge of the nose. A palm steeper than that touches the arc with its surface."""
        return max(edge_lean(self.nose, radius), self.angle)

    def heel_lean(self, radius: float) -> float:
        """Lean of the contact with the heel; without a heel that of the surface."""
        return self.angle + edge_lean(self.heel, radius)

    def meets_side(self, radius: float, lean: float) -> bool:
        """Whether the upper edge of the heel touches the side of the object, not the arc. Seen
        from the palm, that side leans outward by `lean`."""
        return lean > 0 and edge_lean(self.heel, radius) > _LEVEL - lean

    def at_heel(self, radius: float, lean: float = 0.0) -> float:
        """Contact coordinate of an arc on the surface of an object that touches the heel."""
        if not self.meets_side(radius, lean):
            return self.half - radius * math.sin(edge_lean(self.heel, radius))
        return self.half - (radius + (self.heel - radius) * math.sin(lean)) / math.cos(lean)

    def centre_height(self, p: float, radius: float) -> float:
        """Of an arc on the surface at the contact coordinate p."""
        return self.pivot + p * math.sin(self.angle) + (self.offset + radius) * math.cos(self.angle)


def plate_on_floor(palm: _core.PalmSpec, angle: float) -> Plate:
    """A palm of a scene at this angle, its inner end on the floor."""
    pivot = palm.lowest_pivot(angle)
    half = 0.5 * palm.length
    return Plate(
        angle,
        math.atan(palm.friction),
        max(0.0, pivot + palm.offset * math.cos(angle) - half * math.sin(angle)),
        pivot,
        half,
        palm.offset,
        palm.heel,
    )


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
        found = raised.least(push, rays) if direction < _LEVEL - _NONE else None
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
        high = plate.centre_height(plate.at_heel(r, wall) if at_heel else -plate.half, r)
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
    low, high = 0.0, _LEVEL - other.friction
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

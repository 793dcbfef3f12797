# SPDX-License-Identifier: Apache-2.0
"""An object and palms at the floor: where they touch, and balances of the forces between them.

Frame: x forward, y up from the floor, metres, newtons. *Inward* is towards the other palm. The
*lean* of a contact is the angle from the vertical, inward, of its normal. A contact that slips
outward on its surface presses along its lean plus the friction angle φ. Everything is quasistatic.
Source: docs/theory/lifting.md.
"""

import itertools
import math
from dataclasses import dataclass

import palmbots._core as _core
from palmbots.scene.spec import contact_radii

Point = tuple[float, float]
Wrench = tuple[float, float, float]

_LEVEL = math.pi / 2
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


def lifts(direction: float) -> bool:
    """Whether a force that leans by this angle carries any load."""
    return direction < _LEVEL - 1e-12


def squeeze_of(load: float, direction: float) -> float:
    """The horizontal force of a contact that carries a load and leans by this angle: V tan; with a
    load, infinite from a right angle on."""
    return load * math.tan(direction) if lifts(direction) else math.inf


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
        if not lifts(direction):
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

    def balances(self, push: Wrench, rays: list[Wrench]) -> list[float]:
        """The sizes of a force `push` that carries the weight together with two of the others. The
        least and, if it is bounded, the greatest one with any of them are among these."""
        (x, y), slope = self.com_at, self.slope
        load = slope * self.weight, self.weight, self.weight * (x - slope * y)
        sizes = []
        for one, two in itertools.combinations(rays, 2):
            volume = _volume(push, one, two)
            if abs(volume) < _FLAT * self.width:
                continue
            parts = (_volume(load, one, two), _volume(push, load, two), _volume(push, one, load))
            if min(part / volume for part in parts) >= 0:
                sizes.append(parts[0] / volume)
        return sizes

    def least(self, push: Wrench, rays: list[Wrench]) -> Point | None:
        """The horizontal and the vertical part of the least force `push` that carries the weight
        together with others; None: none does."""
        size = min(self.balances(push, rays), default=math.inf)
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

    def first_height(self, radius: float) -> float:
        """The least height of the centre of an arc whose contact has got onto the surface."""
        return max(radius, self.centre_height(-self.half, radius))


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

"""A scene as the stability analysis sees it: numbers, regions and the angles the palms take.

A *pose* is a pair of palm angles with the region of contacts for which a property has to hold in
it. Properties 1 and 2 have one pose for each palm that may be the shallow one; property 0 has
many, since a turning palm passes through all angles between its two.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from palmbots import _core
from palmbots.errors import PalmbotsError, show, two_numbers
from palmbots.lowering import lower
from palmbots.scene import Scene
from palmbots.sections import SIDES, Side
from palmbots.stability.forms import Form, forms

__all__ = ["TURN_STEPS", "Pair", "Pose", "Situation", "situation_of"]

Pair = tuple[float, float]

TURN_STEPS = 8
"""A turning palm is looked at at so many angles (as in the core)."""


@dataclass(frozen=True)
class Pose:
    """Palm angles (left, right) [rad] and the least and greatest height difference z [m]."""

    angles: Pair
    rise: Pair


@dataclass(frozen=True)
class Situation:
    """Everything the analysis needs, in SI units and radians; pairs are (left, right)."""

    spec: _core.Spec
    width: float
    com: Pair
    friction: Pair
    slope: float
    offset: Pair
    half_length: Pair
    angles: tuple[Pair, Pair]
    """(shallow, steep) of the left and of the right palm."""
    contacts: tuple[Pair, Pair]
    """The contact coordinates (low, high) for which everything has to hold."""
    beyond: float = 0.0
    """How far past p = 0 a correction runs on."""

    def palms(self, shallow: Side) -> Pair:
        """The palm angles with one palm shallow, the other one steep."""
        left, right = self.angles
        return (left[0], right[1]) if shallow == "left" else (left[1], right[0])

    def region(self, number: int, shallow: Side) -> tuple[Pair, Pair]:
        """The contacts for which a property is needed; 0: all."""
        left, right = self.contacts
        ends = [left, right]
        side = SIDES.index(shallow)
        if number == 1:
            ends[side] = (ends[side][0], min(ends[side][1], self.beyond))
        if number == 2:
            ends[1 - side] = (max(ends[1 - side][0], -self.beyond), ends[1 - side][1])
        return ends[0], ends[1]

    def rise(self, number: int, shallow: Side, angles: Pair) -> Pair:
        """The extreme height differences over a property's region; 0: over all contacts."""
        return _core.rise_over(
            number, SIDES.index(shallow), self.contacts, self.beyond, angles, self.offset
        )

    def pose(self, number: int, shallow: Side) -> Pose:
        """The pose of property 1 or 2."""
        angles = self.palms(shallow)
        return Pose(angles, self.rise(number, shallow, angles))

    def poses(self, number: int, shallow: Side) -> Iterator[Pose]:
        """All poses of a property; with property 0, `shallow` is the palm that turns."""
        if number:
            yield self.pose(number, shallow)
            return
        (left_shallow, left_steep), (right_shallow, right_steep) = self.angles
        for alike in ((left_steep, right_steep), (left_shallow, right_shallow)):
            yield Pose(alike, self.rise(0, shallow, alike))
        low, high = self.angles[SIDES.index(shallow)]
        for step in range(TURN_STEPS):
            turning = low + (high - low) * step / TURN_STEPS
            angles = (turning, right_steep) if shallow == "left" else (left_steep, turning)
            ends = [self.rise(n, shallow, angles) for n in (1, 2)]
            yield Pose(angles, (min(e[0] for e in ends), max(e[1] for e in ends)))

    def forms(self, number: int, shallow: Side, angles: Pair, **changed: Any) -> list[Form]:
        """The conditions of a property at these angles, with some numbers exchanged."""
        given: dict[str, Any] = {
            "friction": self.friction,
            "com": self.com,
            "slope": self.slope,
        }
        return forms(number, shallow, width=self.width, angles=angles, **(given | changed))

    def envelope(
        self,
        *,
        com_y: Pair | None = None,
        friction: tuple[Pair, Pair] | None = None,
        common: bool = False,
        slope: Pair | None = None,
        contacts: tuple[Pair, Pair] | None = None,
    ) -> _core.Envelope:
        """The core's box of conditions: exactly this situation but for what is given."""
        left, right = self.friction
        return _core.Envelope(
            self.spec,
            com_y or (self.com[1], self.com[1]),
            friction or ((left, left), (right, right)),
            common,
            slope or (self.slope, self.slope),
            contacts or self.contacts,
            self.beyond,
        )

    def with_(self, **changed: Any) -> "Situation":
        """A copy with some numbers exchanged."""
        return replace(self, **changed)


def permitted(
    envelope: _core.Envelope, number: int, shallow: Side, angles: tuple[Pair, Pair]
) -> Pair:
    """The c_x that a property permits everywhere in an envelope; low > high: none."""
    if number == 0:
        return envelope.com_x_held(angles)
    return envelope.com_x_of(number, SIDES.index(shallow), angles)


def situation_of(scene: Scene, region_m: Pair | None = None, beyond_m: float = 0.0) -> Situation:
    """A scene as the analysis sees it.

    Args:
        scene: the scene.
        region_m: contact coordinates (low, high) for which the properties have to hold, on either
            palm; None: the whole palm.
        beyond_m: how far past p = 0 a correction runs on.

    Raises:
        PalmbotsError: the region is not on the palms or does not contain 0, or the object cannot
            reach across it.
    """
    spec = lower(scene)
    half = (0.5 * spec.palms[0].length, 0.5 * spec.palms[1].length)
    if region_m is not None:
        region_m = two_numbers("region_m", region_m)
    contacts = (region_m, region_m) if region_m else ((-half[0], half[0]), (-half[1], half[1]))
    if region_m:
        low, high = region_m
        most = min(half)
        if not (-most <= low <= 0 <= high <= most):
            raise PalmbotsError(
                f"region_m: value is {show(list(region_m))}; allowed: two numbers in m, the first "
                f"from {-most:g} to 0, the second from 0 to {most:g}"
            )
    palms = spec.palms
    found = Situation(
        spec=spec,
        width=spec.width,
        com=(spec.com_left, spec.com_height),
        friction=(palms[0].friction, palms[1].friction),
        slope=spec.slope,
        offset=(palms[0].offset, palms[1].offset),
        half_length=half,
        angles=((palms[0].shallow, palms[0].steep), (palms[1].shallow, palms[1].steep)),
        contacts=contacts,
        beyond=beyond_m,
    )
    for angles in ((found.angles[0][1], found.angles[1][1]), found.palms("left")):
        low, high = found.rise(0, "left", angles)
        if not (math.isfinite(low) and max(-low, high) < spec.width):
            raise PalmbotsError(
                f"palm.length_m: contacts at opposite ends of the palms differ in height by "
                f"{max(-low, high):.3g} m, more than the object is wide; allowed: less than "
                f"{spec.width:g} m (shorter palms, shallower angles, or a region)"
            )
    return found

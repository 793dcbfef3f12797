# SPDX-License-Identifier: Apache-2.0
"""The stability problem of a scene: its numbers, regions of contacts and palm angles.

A *pose* is a pair of palm angles with the region of contacts for which a property has to hold
there. Properties 1 and 2 have one pose for each palm that may be the shallow one. Property 0 has
many, since a turning palm passes through all angles between shallow and steep.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES, Region, Side
from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.scene.object_frame import object_frame
from palmbots.scene.scene import Scene
from palmbots.scene.spec import contact_radii, refuse_low_noses, refuse_pipe, to_spec
from palmbots.stability.linear_conditions import Form, forms
from palmbots.stability.reaction_region import implied_reach_m

Pair = tuple[float, float]

TURN_STEPS = 8
"""Number of angles at which a turning palm is evaluated, as in the core."""


@dataclass(frozen=True)
class Pose:
    """Palm angles (left, right) [rad], and the smallest and largest height difference z [m]."""

    angles: Pair
    rise: Pair


@dataclass(frozen=True)
class StabilityProblem:
    """The input of the analysis, in SI units and radians; pairs are (left, right)."""

    spec: _core.Spec
    width: float
    com: Pair
    """From the left contact: a sharp vertex, or the centre of the arc that rounds it."""
    com_shift: Pair
    """What to add to a COM in order to measure it from the left contact vertex, as users do. A
    rounded vertex is where its straight edges would meet. Zero between sharp vertices."""
    friction: Pair
    slope: float
    offset: Pair
    """Distance of a contact vertex above the pivot, along the normal of its palm: that of the
    palm's surface, plus the radius if the vertex is rounded."""
    radius: Pair
    """Of these arcs; 0: the vertex is sharp."""
    half_length: Pair
    reach: Pair
    """How far from p = 0 a contact may be: half of the usable length."""
    angles: tuple[Pair, Pair]
    """(shallow, steep) of the left and of the right palm."""
    contacts: tuple[Pair, Pair]
    """The contact coordinates (low, high) for which the properties have to hold."""
    beyond: float = 0.0
    """How far a correction continues past p = 0."""

    @property
    def vertex_com(self) -> Pair:
        """The COM from the left contact vertex."""
        return self.com[0] + self.com_shift[0], self.com[1] + self.com_shift[1]

    def palms(self, shallow: Side) -> Pair:
        """The palm angles with one palm shallow and the other one steep."""
        left, right = self.angles
        return (left[0], right[1]) if shallow == "left" else (left[1], right[0])

    def region(self, number: int, shallow: Side) -> tuple[Pair, Pair]:
        """The contacts for which a property has to hold; for property 0 all contacts."""
        left, right = self.contacts
        ends = [left, right]
        side = SIDES.index(shallow)
        if number == 1:
            ends[side] = (ends[side][0], min(ends[side][1], self.beyond))
        if number == 2:
            ends[1 - side] = (max(ends[1 - side][0], -self.beyond), ends[1 - side][1])
        return ends[0], ends[1]

    def rise(self, number: int, shallow: Side, angles: Pair) -> Pair:
        """The extreme height differences over a property's region; for property 0 over all."""
        return _core.rise_over(
            number, SIDES.index(shallow), self.contacts, self.beyond, angles, self.offset
        )

    def pose(self, number: int, shallow: Side) -> Pose:
        """The pose of property 1 or 2."""
        angles = self.palms(shallow)
        return Pose(angles, self.rise(number, shallow, angles))

    def poses(self, number: int, shallow: Side) -> Iterator[Pose]:
        """All poses of a property; for property 0, `shallow` is the palm that turns."""
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
        """The conditions of a property at these angles, with some numbers replaced."""
        given: dict[str, Any] = {
            "friction": self.friction,
            "com": self.com,
            "slope": self.slope,
            "radius": self.radius,
        }
        return forms(number, shallow, width=self.width, angles=angles, **(given | changed))

    def spans(self, rise: Pair) -> Iterator[tuple[float, float, float]]:
        """The vectors (dx, dy) at the extreme height differences, each with the weights of K
        (`Form`) with which a form holds for all height differences between them.

        If 1 / cos ϑ counts as an independent number between its extremes, a form is linear, and the
        worst case is at a corner.
        """
        run = [math.sqrt((self.width - dy) * (self.width + dy)) for dy in rise]
        longest = self.width if rise[0] < 0 < rise[1] else max(run)
        for dx, dy in zip(run, rise, strict=True):
            for other in (longest, min(run)) if any(self.radius) else (dx,):
                yield dx, dy, dx / other

    def touching(self, angles: Pair, rise: float) -> Pair:
        """The vector (dx, dy) between the points that touch the palms, at a height difference."""
        (left, right), radius = angles, self.radius
        return (
            math.sqrt((self.width - rise) * (self.width + rise))
            + radius[0] * math.sin(left)
            + radius[1] * math.sin(right),
            rise + radius[0] * math.cos(left) - radius[1] * math.cos(right),
        )

    def envelope(
        self,
        *,
        com_y: Pair | None = None,
        friction: tuple[Pair, Pair] | None = None,
        common: bool = False,
        slope: Pair | None = None,
        contacts: tuple[Pair, Pair] | None = None,
    ) -> _core.OperatingEnvelope:
        """The core's box of conditions: this problem, with the intervals that are given."""
        left, right = self.friction
        return _core.OperatingEnvelope(
            self.spec,
            com_y or (self.com[1], self.com[1]),
            friction or ((left, left), (right, right)),
            common,
            slope or (self.slope, self.slope),
            contacts or self.contacts,
            self.beyond,
        )

    def with_(self, **changed: Any) -> StabilityProblem:
        """A copy with some numbers replaced."""
        return replace(self, **changed)


def permitted(
    envelope: _core.OperatingEnvelope, number: int, shallow: Side, angles: tuple[Pair, Pair]
) -> Pair:
    """The c_x for which a property holds everywhere in an envelope; low > high: none."""
    if number == 0:
        return envelope.com_x_held(angles)
    return envelope.com_x_of(number, SIDES.index(shallow), angles)


def region_of(scene: Scene, region_m: Region) -> Pair | None:
    """A region as an interval [m]; None: the usable palms.

    Raises:
        PalmbotsError: it is none.
    """
    if isinstance(region_m, str):
        if region_m == "palm":
            return None
        if region_m == "implied":
            reach = implied_reach_m(scene)
            return -reach, reach
    try:
        low, high = map(float, region_m)
    except (TypeError, ValueError):
        raise PalmbotsError(
            f"region_m: value is {show(region_m)}; allowed: implied, palm, or two numbers in m"
        ) from None
    return low, high


def stability_problem(
    scene: Scene, region_m: Region = "palm", beyond_m: float = 0.0
) -> StabilityProblem:
    """The stability problem of a scene.

    Args:
        scene: the scene.
        region_m: the contacts for which the properties have to hold, as of `region_of`.
        beyond_m: how far a correction continues past p = 0.

    Raises:
        PalmbotsError: the region is not on the palms or does not contain 0, or the object cannot
            span it.
    """
    refuse_low_noses(scene)
    refuse_pipe(scene)
    spec = to_spec(scene)
    radius = contact_radii(spec)
    region = region_of(scene, region_m)
    half = (0.5 * spec.palms[0].length, 0.5 * spec.palms[1].length)
    reach = (0.5 * spec.palms[0].usable, 0.5 * spec.palms[1].usable)
    contacts = ((-reach[0], reach[0]), (-reach[1], reach[1]))
    if region is not None:
        low, high = region
        contacts = (region, region)
        most = min(reach)
        if not (-most <= low <= 0 <= high <= most):
            raise PalmbotsError(
                f"region_m: value is {show(list(region))}; allowed: two numbers in m, the first "
                f"from {-most:g} to 0, the second from 0 to {most:g}"
            )
    palms = spec.palms
    body = scene.object
    at = object_frame(body.vertices_m, body.contacts, body.com_m).com
    problem = StabilityProblem(
        spec=spec,
        width=spec.width,
        com=(spec.com_left, spec.com_height),
        com_shift=(at.from_left - spec.com_left, at.height - spec.com_height),
        friction=(palms[0].friction, palms[1].friction),
        slope=spec.slope,
        offset=(palms[0].offset + radius[0], palms[1].offset + radius[1]),
        radius=radius,
        half_length=half,
        reach=reach,
        angles=((palms[0].shallow, palms[0].steep), (palms[1].shallow, palms[1].steep)),
        contacts=contacts,
        beyond=beyond_m,
    )
    if refused := _core.cannot_span(spec, contacts):
        raise PalmbotsError(refused)
    return problem

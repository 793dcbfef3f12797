# SPDX-License-Identifier: Apache-2.0
"""Where palms and object touch in one state, and how several contacts can move.

Besides its two contact vertices the object may have an edge flush on a palm, stand on a further
vertex, or lie on a palm's tip. Points are in the object's frame (`scene.object_frame`): origin
at the left contact vertex, x towards the right one, y up, metres. The motions of a contact have the
names of the paper: ST sticks, SL and SR slide to the left and right on the palm, and BR breaks (the
contact leaves the palm). The core has the mechanics (`mechanics/contact_detection.hpp`,
`mechanics/wrench_cone.hpp`, `mechanics/twist_feasibility.hpp`).
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Literal, cast

import palmbots._core as _core
from palmbots._types import SIDES, Overrides, Side
from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.mechanics.state import PalmState, palm_state
from palmbots.scene.scene import SceneLike
from palmbots.scene.spec import contact_radii

Kind = Literal["vertex", "flush", "tip"]
Motions = tuple[str, ...]
"""How each contact moves, in the order of the contacts."""
MOTION_CODES = ("ST", "SL", "SR", "BR")
"""A contact sticks, slides to the left, slides to the right, or breaks."""

_ST, _SL, _SR, _BR = MOTION_CODES
CODE_OF = ({0: _ST, 1: _SL, -1: _SR, 2: _BR}, {0: _ST, 1: _SR, -1: _SL, 2: _BR})
"""The code of a motion by palm and by the number that the core gives it: 1 slides up the palm."""

_MOST = 8
_PalmMotion = tuple[float, float, float]  # velocity of the pivot [m/s], anticlockwise turn [rad/s]
_CLOSING: tuple[_PalmMotion, _PalmMotion] = ((0.5, 0.0, 0.0), (-0.5, 0.0, 0.0))
_OPENING: tuple[_PalmMotion, _PalmMotion] = ((-0.5, 0.0, 0.0), (0.5, 0.0, 0.0))


@dataclass(frozen=True)
class Contact:
    """One point at which a palm touches the object."""

    side: Side
    kind: Kind
    """``vertex``: a vertex of the object on the palm; ``flush``: one end of an edge that lies on
    the palm; ``tip``: the palm's tip on an edge."""
    place_m: float
    """Coordinate on the palm, from the foot of the pivot, outward."""
    point_m: tuple[float, float]
    """The point in the object's frame."""


_Support = tuple[int, float, float, float, float, float]


@dataclass(frozen=True)
class Touching:
    """All contacts of a state: the left palm's first, each palm's contact vertex first."""

    contacts: tuple[Contact, ...]
    slope: float
    supports: tuple[_Support, ...]
    """The contacts as the core takes them."""
    pivots: tuple[tuple[float, float], tuple[float, float]]
    """Pivots of the palms, relative to the COM, in the world frame [m]."""

    @property
    def several(self) -> bool:
        """Whether there are more contacts than one vertex on each palm."""
        return len(self.contacts) > 2

    @property
    def held(self) -> bool:
        """Whether friction can hold the object with every contact sticking."""
        still = [0] * len(self.supports)
        return _core.imbalance(self.supports, still, self.slope) <= _core.wrench_tolerance

    def closing(self) -> tuple[Motions, ...]:
        """The possible motions when the palms are driven together: all that are kinematically
        feasible and in balance. There may be none, or several."""
        return self._outcomes(_CLOSING)

    def opening(self) -> tuple[Motions, ...]:
        """The same when they are driven apart."""
        return self._outcomes(_OPENING)

    def turning(self, side: Side, up: bool) -> tuple[Motions, ...]:
        """The same when one palm alone turns about its pivot; tilting it up makes it shallow."""
        spin = 1.0 if up == (side == "left") else -1.0
        still, turned = (0.0, 0.0, 0.0), (0.0, 0.0, spin)
        return self._outcomes((turned, still) if side == "left" else (still, turned))

    def _outcomes(self, palms: tuple[_PalmMotion, _PalmMotion]) -> tuple[Motions, ...]:
        velocities = _core.palm_velocities(self.supports, self.pivots, palms)
        return tuple(
            tuple(CODE_OF[s[0]][motion] for s, motion in zip(self.supports, motions, strict=True))
            for motions in _core.outcomes(self.supports, velocities, self.slope)
        )


def touching(state: PalmState) -> Touching:
    """The contacts of a state.

    Raises:
        PalmbotsError: a palm lies in the object, there are more than 8 contacts, or a contact
            vertex is rounded and the object may touch a palm elsewhere.
    """
    if any(contact_radii(state.spec)):
        return _on_arcs(state)
    points, count, sunk, pivots = _core.contacts(state.spec, state.theta_rad, state.p_m)
    near = _core.contact_tolerance * state.spec.width
    for i, side in enumerate(SIDES):
        if sunk[i] > near:
            raise PalmbotsError(
                f"theta_{side}_deg: value is {show(state.theta_deg[i])}, which puts the {side} "
                f"palm {1e3 * sunk[i]:.3g} mm inside the object's outline; allowed: angles and "
                f"contacts at which they overlap by at most {1e3 * near:.2g} mm"
            )
    if count > _MOST:
        raise PalmbotsError(
            f"object.vertices_m: the outline touches the palms in {count} points; allowed: {_MOST}"
        )
    contacts = tuple(
        Contact(SIDES[support[0]], cast(Kind, kind), place, (x, y))
        for kind, place, x, y, support in points
    )
    return Touching(contacts, state.spec.slope, tuple(p[4] for p in points), pivots)


def _on_arcs(state: PalmState) -> Touching:
    """Rounded contact vertices alone; palms count as infinitely long."""
    spec, turn = state.spec, state.object_rad
    points: list[Contact] = []
    for i, side in enumerate(SIDES):
        theta = state.theta_rad[i]
        low, high = _core.clear_cones(spec)[i]
        if not low < math.tan(theta + (turn if i == 0 else -turn)) < high:
            raise PalmbotsError(
                f"theta_{side}_deg: value is {show(state.theta_deg[i])}, at which the object may "
                f"touch the {side} palm elsewhere; allowed, with rounded contact vertices: angles "
                "at which the rest of the object is above the line of the palm"
            )
        down = contact_radii(spec)[i] * cmath.rect(1, (-0.5 * math.pi) + (-1, 1)[i] * theta - turn)
        points.append(
            Contact(side, "vertex", state.p_m[i], (i * spec.width + down.real, down.imag))
        )
    return Touching(tuple(points), spec.slope, (), ((0.0, 0.0), (0.0, 0.0)))


def contacts(
    scene: SceneLike = "paper",
    *,
    p_left_m: float = 0.0,
    p_right_m: float = 0.0,
    theta_left_deg: float | None = None,
    theta_right_deg: float | None = None,
    overrides: Overrides = None,
) -> list[Contact]:
    """Every point at which the palms touch the object in one state of a scene.

    A point closer than 10⁻⁵ of the distance between the contact vertices counts as a contact.
    Contacts on one palm between its outermost ones are left out, because they do not change the
    possible motions.

    Args:
        scene: as in `palmbots.carry`.
        p_left_m: coordinate of the contact vertex, outward from the foot of the pivot.
        p_right_m: the same on the right.
        theta_left_deg: palm angle; None: the scene's steep angle.
        theta_right_deg: the same on the right.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or is invalid.
        PalmbotsError: a coordinate is beyond its palm, an angle is not between -80° and 80°, the
            object cannot span the two contacts, a palm would lie inside it, or a contact vertex is
            rounded and the object may touch a palm elsewhere.
    """
    state = palm_state(scene, p_left_m, p_right_m, theta_left_deg, theta_right_deg, overrides)
    return list(touching(state).contacts)

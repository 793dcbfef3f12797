# SPDX-License-Identifier: Apache-2.0
"""Where palms and object touch in one state, and how several contacts can move.

Besides its two contact vertices the object may have an edge flush on a palm, stand on a further
vertex, or lie on a palm's tip. Points are in the object's frame (`scene.object_frame`): origin
at the left contact vertex, x towards the right one, y up, metres. The motions of a contact have the
names of the paper: ST sticks, SL and SR slide to the left and right on the palm, and BR breaks (the
contact leaves the palm). The core finds the contacts (`world/touching.hpp`) and has their mechanics
(`mechanics/wrench_cone.hpp`, `mechanics/twist_feasibility.hpp`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, cast

import palmbots._core as _core
from palmbots._types import SIDES, Overrides, Side
from palmbots.errors import PalmbotsError
from palmbots.mechanics.consistent_modes import CODE_OF, modes_of
from palmbots.mechanics.mode_forces import ConsistentMode, Support
from palmbots.mechanics.state import PalmState, palm_state
from palmbots.scene.scene import SceneLike

Kind = Literal["vertex", "flush", "tip", "nose", "heel"]
Motions = tuple[str, ...]
"""How each contact moves, in the order of the contacts."""

_PalmMotion = tuple[float, float, float]  # velocity of the pivot [m/s], anticlockwise turn [rad/s]
_CLOSING: tuple[_PalmMotion, _PalmMotion] = ((0.5, 0.0, 0.0), (-0.5, 0.0, 0.0))
_OPENING: tuple[_PalmMotion, _PalmMotion] = ((-0.5, 0.0, 0.0), (0.5, 0.0, 0.0))


@dataclass(frozen=True)
class Contact:
    """One point at which a palm touches the object."""

    side: Side
    kind: Kind
    """``vertex``: a vertex of the object on the palm; ``flush``: one end of an edge that lies on
    the palm; ``tip``: the palm's tip on an edge; ``nose``, ``heel``: a vertex of the object on the
    face of the palm's inner end, or of the stop at its outer end."""
    place_m: float
    """Coordinate on the palm, from the foot of the pivot, outward."""
    point_m: tuple[float, float]
    """The point in the object's frame."""


@dataclass(frozen=True)
class Touching:
    """All contacts of a state: the left palm's first, each palm's contact vertex first."""

    contacts: tuple[Contact, ...]
    slope: float
    supports: tuple[Support, ...]
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
        return _core.balances(self.supports, still, self.slope)

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

    def modes_closing(self) -> tuple[ConsistentMode, ...]:
        """The same as `closing`, with forces and margins."""
        return self._modes(_CLOSING)

    def modes_opening(self) -> tuple[ConsistentMode, ...]:
        """The same as `opening`, with forces and margins."""
        return self._modes(_OPENING)

    def _modes(self, palms: tuple[_PalmMotion, _PalmMotion]) -> tuple[ConsistentMode, ...]:
        velocities = _core.palm_velocities(self.supports, self.pivots, palms)
        return modes_of(self.supports, velocities, self.slope, [c.side for c in self.contacts])

    def _outcomes(self, palms: tuple[_PalmMotion, _PalmMotion]) -> tuple[Motions, ...]:
        velocities = _core.palm_velocities(self.supports, self.pivots, palms)
        return tuple(
            tuple(CODE_OF[s[0]][motion] for s, motion in zip(self.supports, motions, strict=True))
            for motions in _core.outcomes(self.supports, velocities, self.slope)
        )


def touching(state: PalmState) -> Touching:
    """The contacts of a state.

    Raises:
        PalmbotsError: a palm lies in the object, or there are more than 8 contacts.
    """
    points, _, pivots, refusal = _core.contacts(state.spec, state.theta_rad, state.p_m)
    if refusal:
        raise PalmbotsError(refusal)
    contacts = tuple(
        Contact(SIDES[side], cast(Kind, kind), place, (x, y))
        for kind, side, place, x, y, _ in points
    )
    return Touching(contacts, state.spec.slope, tuple(p[5] for p in points), pivots)


def is_clear(state: PalmState) -> bool:
    """Whether no palm lies in the object, up to rounding."""
    _, _, pivots, _ = _core.contacts(state.spec, state.theta_rad, state.p_m)
    world = _core.World(state.spec)
    world.put(pivots, state.theta_rad, (0.0, 0.0), state.object_rad)
    return world.pierced(1e-10 * state.spec.width) is None


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
        p_right_m: the same on the right; of a pipe it follows from the left one.
        theta_left_deg: palm angle; None: the scene's steep angle.
        theta_right_deg: the same on the right.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or is invalid.
        PalmbotsError: a coordinate is beyond its palm, an angle is not between -80° and 80°, the
            object cannot span the two contacts, or a palm would lie inside it.
    """
    state = palm_state(scene, p_left_m, p_right_m, theta_left_deg, theta_right_deg, overrides)
    return list(touching(state).contacts)
